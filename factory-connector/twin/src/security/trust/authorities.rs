//! Certificates of authorities: trusted ones, and those that only complete chains.

use std::{fs, io};

use asi_model::DateTime;
use opcua_stack::opcua::crypto::CertificateStore;
use x509_parser::{
    certificate::X509Certificate, prelude::FromDer, revocation_list::CertificateRevocationList,
    time::ASN1Time,
};

use super::{ISSUERS, LISTED_MAX, TRUSTED, TrustList, faults, read, refuse, time};
use crate::{
    error::TwinError,
    security::{
        certificate_files,
        issuance::is_signed_by,
        rejected_clients::{fingerprint, thumbprint},
    },
};

/// State of an authority's revocation list. Without a current list its clients are rejected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RevocationKnowledge {
    /// The list is current.
    Current {
        /// Time at which the next list is due, if the list says so.
        next_update: Option<DateTime>,
    },
    /// The list should have been replaced at `next_update`.
    Outdated { next_update: DateTime },
    /// No list is stored.
    Missing,
}

/// The certificate of an authority.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Authority {
    /// SHA-1 over the certificate in lower-case hexadecimal digits; identifies it in the trust list.
    pub thumbprint: String,
    /// SHA-256 over the certificate in lower-case hexadecimal digits, for people to compare.
    pub fingerprint: String,
    /// The subject's distinguished name.
    pub subject: String,
    /// The issuer's distinguished name; the subject's when it is self-signed.
    pub issuer: String,
    /// Beginning of its validity.
    pub not_before: DateTime,
    /// End of its validity.
    pub not_after: DateTime,
    /// True when clients with its certificates may connect; otherwise it only completes chains.
    pub is_trusted: bool,
    pub revocation: RevocationKnowledge,
}

impl TrustList {
    /// Returns the authorities, the trusted ones first.
    ///
    /// # Errors
    /// [`TwinError::Pki`] when a folder cannot be read.
    pub fn authorities(&self) -> Result<Vec<Authority>, TwinError> {
        let lists = self.known_lists()?;
        let lists: Vec<_> = lists
            .iter()
            .filter_map(|(_, der)| Some(CertificateRevocationList::from_der(der).ok()?.1))
            .collect();
        let mut all = Vec::new();
        for (folder, is_trusted) in [(TRUSTED, true), (ISSUERS, false)] {
            for (_, der) in self.contents(folder, "der")? {
                let Ok((_, parsed)) = X509Certificate::from_der(&der) else { continue };
                if is_trusted && !faults::is_authority(&parsed) {
                    continue;
                }
                let Ok(certificate) = read(&der) else { continue };
                all.push(Authority {
                    thumbprint: thumbprint(&certificate),
                    fingerprint: fingerprint(&certificate),
                    subject: parsed.subject().to_string(),
                    issuer: parsed.issuer().to_string(),
                    not_before: time(parsed.validity().not_before),
                    not_after: time(parsed.validity().not_after),
                    is_trusted,
                    revocation: knowledge(&parsed, &lists, ASN1Time::now()),
                });
            }
        }
        Ok(all)
    }

    /// Adds an authority's certificate (DER) that completes chains without being trusted itself.
    ///
    /// # Errors
    /// [`TwinError::Refused`] with all its faults, [`TwinError::Pki`] when it cannot be stored.
    pub fn add_issuer(&self, der: &[u8], by: &str) -> Result<(), TwinError> {
        let parsed = faults::certificate(der)?;
        refuse(faults::of_authority(&parsed, ASN1Time::now()))?;
        let certificate = read(der)?;
        self.write(ISSUERS, &CertificateStore::cert_file_name(&certificate), der)?;
        self.changed(
            by,
            format!(
                "The certificate {} of an authority in between was added.",
                thumbprint(&certificate)
            ),
        );
        Ok(())
    }

    /// Removes an authority's certificate: its clients are rejected, and their open sessions end. What it revoked is
    /// denied from now on. False when there is none.
    ///
    /// # Errors
    /// [`TwinError::Pki`] when it cannot be removed.
    pub fn remove_authority(&self, thumbprint: &str, by: &str) -> Result<bool, TwinError> {
        let mut paths = Vec::new();
        for folder in [TRUSTED, ISSUERS] {
            let Some(path) = self.find(folder, thumbprint)? else { continue };
            let der =
                fs::read(&path).map_err(|source| TwinError::Pki { path: path.clone(), source })?;
            let is_authority = X509Certificate::from_der(&der)
                .is_ok_and(|(_, parsed)| faults::is_authority(&parsed));
            if is_authority || folder == ISSUERS {
                paths.push(path);
            }
        }
        if paths.is_empty() {
            return Ok(false);
        }
        self.deny_revoked(by)?;
        for path in paths {
            match fs::remove_file(&path) {
                // It was revoked itself, and is among the denied ones.
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                removed => removed.map_err(|source| TwinError::Pki { path, source })?,
            }
        }
        self.changed(by, format!("The authority's certificate {thumbprint} was removed."));
        Ok(true)
    }

    /// Returns the files of a folder with their content, as many as are listed. Files that cannot be read are left out
    /// here; the validation of clients refuses all of them meanwhile.
    pub(super) fn contents(
        &self,
        folder: &str,
        extension: &str,
    ) -> Result<Vec<(std::path::PathBuf, Vec<u8>)>, TwinError> {
        let paths = self.files(folder, extension)?.into_iter().take(LISTED_MAX);
        Ok(paths
            .filter_map(|path| certificate_files::read(&path).ok().map(|content| (path, content)))
            .collect())
    }
}

fn knowledge(
    authority: &X509Certificate<'_>,
    lists: &[CertificateRevocationList<'_>],
    now: ASN1Time,
) -> RevocationKnowledge {
    let own = lists
        .iter()
        .filter(|list| {
            list.issuer().as_raw() == authority.subject().as_raw() && is_signed_by(list, authority)
        })
        .max_by_key(|list| (list.next_update().is_none_or(|next| next >= now), list.last_update()));
    match own.map(CertificateRevocationList::next_update) {
        None => RevocationKnowledge::Missing,
        Some(Some(next)) if next < now => RevocationKnowledge::Outdated { next_update: time(next) },
        Some(next) => RevocationKnowledge::Current { next_update: next.map(time) },
    }
}
