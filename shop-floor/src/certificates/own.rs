//! Certificate of this client, and the next one, which machines learn to trust before it is used.

use std::{
    fs,
    path::{Path, PathBuf},
};

use asi_model::values::DateTime;
use opcua_stack::opcua::crypto::{CertificateStore, X509, X509Data};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    ISSUERS, PkiDirectory, REJECTED, REVOCATION_LISTS, TRUSTED, fingerprint, folder::disk,
    read_limited, validity,
};
use crate::ShopFloorError;

/// Days for which a client certificate is valid.
const VALIDITY_DAYS: u32 = 3650;

/// Files of a certificate and of its key.
struct Pair {
    certificate: &'static str,
    key: &'static str,
}

const CURRENT: Pair = Pair { certificate: "own/cert.der", key: "private/private.pem" };
const NEXT: Pair = Pair { certificate: "own/next-cert.der", key: "private/next-private.pem" };
/// A pair that is being made: half of one is never taken for the next.
const NEW: Pair = Pair { certificate: "own/new-cert.der", key: "private/new-private.pem" };

/// Client certificate, which a server's administrator must trust.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct OwnCertificate {
    /// SHA-1 thumbprint, hex: the certificate's name in OPC UA.
    pub thumbprint: String,
    /// SHA-256 fingerprint, hex, for people to compare.
    pub fingerprint: String,
    /// Distinguished name of the subject.
    pub subject: String,
    /// The application URI it is for.
    pub application_uri: String,
    pub valid_from: DateTime,
    pub valid_to: DateTime,
    /// The certificate itself (DER), to be handed to the server's administrator.
    #[serde(skip)]
    pub der: Vec<u8>,
}

/// Client certificate in use, and the next one where an engineer had it made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OwnCertificates {
    pub current: OwnCertificate,
    pub next: Option<OwnCertificate>,
}

impl PkiDirectory {
    /// Returns the client certificate. Creates it with its key on first use, which takes seconds.
    pub(crate) fn own(&self) -> Result<OwnCertificate, ShopFloorError> {
        let _turn = self.own_files.lock();
        self.current()
    }

    /// Returns the client certificate and the next one.
    pub(crate) fn own_and_next(&self) -> Result<OwnCertificates, ShopFloorError> {
        let _turn = self.own_files.lock();
        self.both()
    }

    fn current(&self) -> Result<OwnCertificate, ShopFloorError> {
        for folder in [TRUSTED, REJECTED, ISSUERS, REVOCATION_LISTS, "own", "private"] {
            fs::create_dir_all(self.directory.join(folder))
                .map_err(|error| disk(&self.directory, &error))?;
        }
        restrict(&self.directory.join("private"), 0o700)?;
        self.finish_change()?;
        if !self.has(&CURRENT) {
            self.create(&CURRENT)?;
            tracing::info!(
                "Created the client certificate for OPC UA servers; their administrators must trust it."
            );
        }
        self.describe_own(&CURRENT)
    }

    fn both(&self) -> Result<OwnCertificates, ShopFloorError> {
        let current = self.current()?;
        let next = self.has(&NEXT).then(|| self.describe_own(&NEXT)).transpose()?;
        Ok(OwnCertificates { current, next })
    }

    /// Makes the next client certificate with a key of its own, unless there is one. It is not used yet.
    pub(crate) fn prepare_next(&self) -> Result<OwnCertificates, ShopFloorError> {
        let _turn = self.own_files.lock();
        self.current()?;
        if !self.has(&NEXT) {
            self.create(&NEW)?;
            // The key first: a certificate without its key is a change that was interrupted.
            self.rename(NEW.key, NEXT.key)?;
            self.rename(NEW.certificate, NEXT.certificate)?;
        }
        self.both()
    }

    /// Uses the next certificate from the next session on.
    pub(crate) fn use_next(&self) -> Result<OwnCertificates, ShopFloorError> {
        let _turn = self.own_files.lock();
        self.current()?;
        if !self.has(&NEXT) {
            return Err(ShopFloorError::Invalid("there is no next certificate".into()));
        }
        self.rename(NEXT.key, CURRENT.key)?;
        self.finish_change()?;
        tracing::info!("Sessions with OPC UA servers use the next client certificate from now on.");
        self.both()
    }

    /// Deletes the next certificate and its key.
    pub(crate) fn discard_next(&self) -> Result<OwnCertificates, ShopFloorError> {
        let _turn = self.own_files.lock();
        self.current()?;
        if self.has(&NEXT) {
            for file in [NEXT.certificate, NEXT.key] {
                let path = self.directory.join(file);
                fs::remove_file(&path).map_err(|error| disk(&path, &error))?;
            }
        }
        self.both()
    }

    /// Ends a change to the next certificate that was interrupted when its key was in use already.
    fn finish_change(&self) -> Result<(), ShopFloorError> {
        let is_begun = self.path(NEXT.certificate).exists() && !self.path(NEXT.key).exists();
        if is_begun { self.rename(NEXT.certificate, CURRENT.certificate) } else { Ok(()) }
    }

    fn path(&self, file: &str) -> PathBuf {
        self.directory.join(file)
    }

    fn has(&self, pair: &Pair) -> bool {
        self.path(pair.certificate).exists() && self.path(pair.key).exists()
    }

    fn rename(&self, from: &str, to: &str) -> Result<(), ShopFloorError> {
        let from = self.path(from);
        fs::rename(&from, self.path(to)).map_err(|error| disk(&from, &error))
    }

    fn describe_own(&self, pair: &Pair) -> Result<OwnCertificate, ShopFloorError> {
        let path = self.path(pair.certificate);
        let der = read_limited(&path).map_err(|error| disk(&path, &error))?;
        let certificate = X509::from_der(&der).map_err(|_| {
            ShopFloorError::Certificates(format!("{} is no certificate", path.display()))
        })?;
        let (valid_from, valid_to) = validity(&certificate);
        Ok(OwnCertificate {
            thumbprint: certificate.thumbprint().as_hex_string(),
            fingerprint: fingerprint(&certificate),
            subject: certificate.subject_name(),
            application_uri: self.application_uri.clone(),
            valid_from: valid_from.unwrap_or(DateTime::MIN),
            valid_to: valid_to.unwrap_or(DateTime::MIN),
            der,
        })
    }

    fn create(&self, pair: &Pair) -> Result<(), ShopFloorError> {
        // Characters with a meaning in distinguished names would break the subject.
        let name: String = self
            .application_name
            .chars()
            .map(
                |letter| {
                    if letter.is_alphanumeric() || " -_.".contains(letter) { letter } else { ' ' }
                },
            )
            .take(60)
            .collect();
        let description = X509Data {
            key_size: 2048,
            common_name: name,
            organization: "Verbund".into(),
            organizational_unit: String::new(),
            country: String::new(),
            state: String::new(),
            alt_host_names: X509Data::alt_host_names(
                &self.application_uri,
                None,
                false,
                true,
                false,
            ),
            certificate_duration_days: VALIDITY_DAYS,
        };
        let (certificate_path, key_path) = (self.path(pair.certificate), self.path(pair.key));
        CertificateStore::create_certificate_and_key(
            &description,
            true,
            &certificate_path,
            &key_path,
        )
        .map_err(ShopFloorError::Certificates)?;
        restrict(&key_path, 0o600)
    }
}

#[cfg(unix)]
fn restrict(path: &Path, mode: u32) -> Result<(), ShopFloorError> {
    use std::os::unix::fs::PermissionsExt as _;
    fs::set_permissions(path, fs::Permissions::from_mode(mode)).map_err(|error| disk(path, &error))
}

#[cfg(not(unix))]
fn restrict(_path: &Path, _mode: u32) -> Result<(), ShopFloorError> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use tempfile::TempDir;

    use super::*;
    use crate::Config;

    fn directory() -> (TempDir, PkiDirectory) {
        let folder = tempfile::tempdir().expect("a folder");
        let pki = PkiDirectory::new(&Config::new(folder.path(), "Press (hall 2)", "urn:test:own"));
        (folder, pki)
    }

    fn key(pki: &PkiDirectory, pair: &Pair) -> Vec<u8> {
        fs::read(pki.path(pair.key)).expect("a key")
    }

    #[test]
    fn the_next_certificate_is_used_only_when_it_is_said() {
        let (_folder, pki) = directory();
        let first = pki.own().expect("made");
        assert_eq!(pki.own_and_next().expect("read").next, None);
        let prepared = pki.prepare_next().expect("made");
        assert_eq!(prepared.current, first, "the old one is in use");
        let next = prepared.next.clone().expect("the next");
        assert_ne!(next.fingerprint, first.fingerprint);
        assert_ne!(key(&pki, &NEXT), key(&pki, &CURRENT), "a key of its own");
        assert_eq!(pki.prepare_next().expect("there already"), prepared);
        let key_of_next = key(&pki, &NEXT);
        let used = pki.use_next().expect("used");
        assert_eq!(used, OwnCertificates { current: next, next: None });
        assert_eq!(key(&pki, &CURRENT), key_of_next);
        assert!(pki.use_next().is_err(), "there is no next one");
    }

    #[test]
    fn a_next_certificate_that_is_discarded_leaves_nothing() {
        let (_folder, pki) = directory();
        let current = pki.prepare_next().expect("made").current;
        assert_eq!(pki.discard_next().expect("gone"), OwnCertificates { current, next: None });
        assert!(!pki.path(NEXT.key).exists());
        pki.discard_next().expect("nothing to discard");
    }

    #[test]
    fn a_change_that_was_interrupted_is_finished() {
        let (_folder, pki) = directory();
        let next = pki.prepare_next().expect("made").next.expect("the next");
        pki.rename(NEXT.key, CURRENT.key).expect("the first half of a change");
        assert_eq!(pki.own().expect("the second half"), next);
    }
}
