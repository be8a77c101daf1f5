//! Revocation lists of authorities.

use std::{fs, path::PathBuf};

use asi_model::DateTime;
use opcua_stack::opcua::crypto::CertificateStore;
use x509_parser::{
    certificate::X509Certificate, prelude::FromDer, revocation_list::CertificateRevocationList,
    time::ASN1Time,
};

use super::{DENIED, ISSUERS, REVOCATION_LISTS, TRUSTED, TrustList, faults, read, refuse, time};
use crate::{
    error::TwinError,
    security::{
        certificate_files,
        issuance::{
            ItemsIn, KnownCertificate, KnownList, certificates_in, is_revoked, is_signed_by,
            lists_in,
        },
        rejected_clients::{fingerprint, thumbprint},
    },
};

/// A file with what it holds, as DER.
type ItemsOfFile = (PathBuf, Vec<Vec<u8>>);

/// An authority's list of certificates that it revoked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RevocationList {
    /// Name of its file; identifies it in the trust list.
    pub id: String,
    /// The distinguished name of the authority.
    pub issuer: String,
    /// Time at which it was issued.
    pub this_update: DateTime,
    /// Time at which the next one is due, if it says so.
    pub next_update: Option<DateTime>,
    /// Number of revoked certificates.
    pub revoked: usize,
    /// True when an authority of the trust list signed it; otherwise it lets nobody in, and what it names is refused.
    pub is_signed_by_known_authority: bool,
}

impl TrustList {
    /// Returns the revocation lists, ordered by authority.
    ///
    /// # Errors
    /// [`TwinError::Pki`] when a folder cannot be read.
    pub fn revocation_lists(&self) -> Result<Vec<RevocationList>, TwinError> {
        let authorities = self.authority_files()?;
        let authorities = parsed(&authorities);
        let mut all: Vec<_> = self
            .known_lists()?
            .iter()
            .filter_map(|(path, der)| {
                let (_, list) = CertificateRevocationList::from_der(der).ok()?;
                Some(RevocationList {
                    id: path.file_stem()?.to_str()?.to_owned(),
                    issuer: list.issuer().to_string(),
                    this_update: time(list.last_update()),
                    next_update: list.next_update().map(time),
                    revoked: list.iter_revoked_certificates().count(),
                    is_signed_by_known_authority: signer(&list, &authorities).is_some(),
                })
            })
            .collect();
        all.sort_by(|a, b| (&a.issuer, a.this_update).cmp(&(&b.issuer, b.this_update)));
        Ok(all)
    }

    /// Stores an authority's revocation list (DER) in place of its older ones. Certificates of an
    /// authority are accepted only with a current list; open sessions of those that it names end.
    ///
    /// # Errors
    /// [`TwinError::Refused`] with all its faults, [`TwinError::Pki`] when it cannot be stored.
    pub fn put_revocation_list(&self, der: &[u8], by: &str) -> Result<(), TwinError> {
        let list = faults::revocation_list(der)?;
        let authorities = self.authority_files()?;
        let authorities = parsed(&authorities);
        let known = self.known_lists()?;
        let known_lists: Vec<_> = known
            .iter()
            .filter_map(|(_, der)| Some(CertificateRevocationList::from_der(der).ok()?.1))
            .collect();
        refuse(faults::of_revocation_list(&list, &authorities, &known_lists, ASN1Time::now()))?;
        let authority =
            signer(&list, &authorities).expect("a list without a known signer was refused");
        let name = format!("{}.crl", thumbprint(&read(authority.as_raw())?));
        self.write(REVOCATION_LISTS, &name, der)?;
        // Older lists may have other file names if they were copied by hand.
        for (path, der) in known
            .iter()
            .filter(|(path, _)| path.file_name().is_none_or(|found| found != name.as_str()))
        {
            let is_older = CertificateRevocationList::from_der(der).is_ok_and(|(_, old)| {
                old.issuer().as_raw() == list.issuer().as_raw() && is_signed_by(&old, authority)
            });
            // A file with lists of other authorities, too, stays.
            if is_older && known.iter().filter(|(other, _)| other == path).count() == 1 {
                fs::remove_file(path)
                    .map_err(|source| TwinError::Pki { path: path.clone(), source })?;
            }
        }
        self.changed(by, format!("The revocation list of {} was replaced.", list.issuer()));
        Ok(())
    }

    /// Removes a revocation list: certificates of its authority are rejected until there is a new
    /// one, and what it named is denied from now on. False when there is none.
    ///
    /// # Errors
    /// [`TwinError::Pki`] when it cannot be removed.
    pub fn remove_revocation_list(&self, id: &str, by: &str) -> Result<bool, TwinError> {
        let has_id = |path: &std::path::PathBuf| path.file_stem().is_some_and(|stem| stem == id);
        let Some(path) = self.files(REVOCATION_LISTS, "crl")?.into_iter().find(has_id) else {
            return Ok(false);
        };
        self.deny_revoked(by)?;
        fs::remove_file(&path).map_err(|source| TwinError::Pki { path, source })?;
        self.changed(by, format!("The revocation list {id} was removed."));
        Ok(true)
    }

    /// Denies what is revoked, before a list or an authority goes by which that is known: a revocation ends when a person
    /// trusts the certificate again, and not when one tidies up.
    pub(super) fn deny_revoked(&self, by: &str) -> Result<(), TwinError> {
        let mut files = self.items(TRUSTED, "der", certificates_in)?;
        files.extend(self.items(ISSUERS, "der", certificates_in)?);
        let lists = self.items(REVOCATION_LISTS, "crl", lists_in)?;
        let authorities: Vec<KnownCertificate> = files
            .iter()
            .flat_map(|(_, items)| items)
            .filter_map(|der| KnownCertificate::new(der))
            .collect();
        let lists: Vec<KnownList> = lists
            .iter()
            .flat_map(|(_, items)| items)
            .filter_map(|der| KnownList::new(der, &authorities))
            .collect();
        for (path, items) in &files {
            for der in items {
                let Ok((_, parsed)) = X509Certificate::from_der(der) else { continue };
                let Ok(certificate) = read(der) else { continue };
                if !is_revoked(&parsed, &authorities, &lists) {
                    continue;
                }
                self.write(DENIED, &CertificateStore::cert_file_name(&certificate), der)?;
                // A file with others, too, stays: what is denied is refused, though it is trusted.
                if items.len() == 1 {
                    fs::remove_file(path)
                        .map_err(|source| TwinError::Pki { path: path.clone(), source })?;
                }
                let thumbprint = thumbprint(&certificate);
                self.changed(
                    by,
                    format!("The certificate {thumbprint} was revoked and is denied."),
                );
                self.approvals.forget(&fingerprint(&certificate))?;
            }
        }
        Ok(())
    }

    /// Returns what the files of a folder hold, as DER, without files that cannot be read.
    fn items(
        &self,
        folder: &str,
        extension: &str,
        items_in: ItemsIn,
    ) -> Result<Vec<ItemsOfFile>, TwinError> {
        let read = |path: PathBuf| {
            let items = items_in(&certificate_files::read(&path).ok()?)?;
            Some((path, items))
        };
        Ok(self.files(folder, extension)?.into_iter().filter_map(read).collect())
    }

    /// Returns the revocation lists as DER, each with the path of its file.
    pub(super) fn known_lists(&self) -> Result<Vec<(PathBuf, Vec<u8>)>, TwinError> {
        let files = self.contents(REVOCATION_LISTS, "crl")?.into_iter();
        let lists = files.flat_map(|(path, content)| {
            let lists = lists_in(&content).unwrap_or_default();
            lists.into_iter().map(move |der| (path.clone(), der))
        });
        Ok(lists.collect())
    }

    /// Returns the certificates of all possible issuers, as DER.
    fn authority_files(&self) -> Result<Vec<Vec<u8>>, TwinError> {
        let mut all = Vec::new();
        for folder in [TRUSTED, ISSUERS] {
            all.extend(self.contents(folder, "der")?.into_iter().map(|(_, der)| der));
        }
        Ok(all)
    }
}

fn parsed(files: &[Vec<u8>]) -> Vec<X509Certificate<'_>> {
    files
        .iter()
        .filter_map(|der| Some(X509Certificate::from_der(der).ok()?.1))
        .filter(|certificate| certificate.is_ca())
        .collect()
}

fn signer<'a, 'b>(
    list: &CertificateRevocationList<'_>,
    authorities: &'a [X509Certificate<'b>],
) -> Option<&'a X509Certificate<'b>> {
    authorities
        .iter()
        .find(|one| one.subject().as_raw() == list.issuer().as_raw() && is_signed_by(list, one))
}
