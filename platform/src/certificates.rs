//! The platform's own certificate authority: signs the embedded broker's certificate, so that
//! connectors can trust it by the one root that enrolment hands them.

use std::{
    io::Write,
    os::unix::fs::OpenOptionsExt,
    path::{Path, PathBuf},
};

use bytes::Bytes;
use rcgen::{
    BasicConstraints, CertificateParams, DistinguishedName, DnType, ExtendedKeyUsagePurpose, IsCa,
    Issuer, KeyPair, KeyUsagePurpose,
};
use time::{Duration, OffsetDateTime};

/// The authority cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum CertificateError {
    /// A file cannot be read or written.
    #[error("cannot access {}", path.display())]
    File { path: PathBuf, source: std::io::Error },
    /// A key or certificate cannot be made or read.
    #[error("cannot {action}")]
    Make {
        /// Imperative phrase for the message, for example "store a part".
        action: &'static str,
        source: rcgen::Error,
    },
}

/// Certificate authority whose root is stored in a folder of the data directory.
pub struct CertificateAuthority {
    root_pem: String,
    issuer: Issuer<'static, KeyPair>,
}

impl std::fmt::Debug for CertificateAuthority {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("CertificateAuthority")
    }
}

/// A certificate with its key, as PEM.
pub struct IssuedCertificate {
    /// The chain, leaf first.
    pub certificates_pem: Bytes,
    pub key_pem: Bytes,
}

/// Long, because every connector has to be given a new root by hand when it ends.
const ROOT_YEARS: i64 = 20;
/// Servers get a new certificate at every start; this is for those that are never restarted.
const SERVER_YEARS: i64 = 2;
/// Clocks of plants may be behind.
const BACKDATED: Duration = Duration::days(2);

impl CertificateAuthority {
    /// Opens the authority in the folder, making it where there is none.
    ///
    /// # Errors
    /// [`CertificateError`].
    pub fn open(folder: &Path, now: OffsetDateTime) -> Result<Self, CertificateError> {
        let (root_path, key_path) = (folder.join("root.pem"), folder.join("root.key"));
        let made = |action| move |source| CertificateError::Make { action, source };
        if !key_path.exists() || !root_path.exists() {
            std::fs::create_dir_all(folder)
                .map_err(|source| CertificateError::File { path: folder.into(), source })?;
            let key = KeyPair::generate().map_err(made("make the authority's key"))?;
            let root =
                root_params(now).self_signed(&key).map_err(made("make the root certificate"))?;
            write(&key_path, key.serialize_pem().as_bytes(), 0o600)?;
            write(&root_path, root.pem().as_bytes(), 0o644)?;
        }
        let read = |path: &Path| {
            std::fs::read_to_string(path)
                .map_err(|source| CertificateError::File { path: path.into(), source })
        };
        let key = KeyPair::from_pem(&read(&key_path)?).map_err(made("read the authority's key"))?;
        // An issuer is its name and key; both are always the same ones.
        Ok(Self { root_pem: read(&root_path)?, issuer: Issuer::new(root_params(now), key) })
    }

    /// Returns the root certificate as PEM.
    #[must_use]
    pub fn root_pem(&self) -> &str {
        &self.root_pem
    }

    /// Issues a server's certificate for these names and addresses.
    ///
    /// # Errors
    /// [`CertificateError::Make`], as for a name that is none.
    pub fn issue(
        &self,
        names: &[String],
        now: OffsetDateTime,
    ) -> Result<IssuedCertificate, CertificateError> {
        let made = |action| move |source| CertificateError::Make { action, source };
        let key = KeyPair::generate().map_err(made("make a server's key"))?;
        let mut params = CertificateParams::new(names).map_err(made("name a server"))?;
        params.distinguished_name = name("Verbund broker");
        params.not_before = now - BACKDATED;
        params.not_after = now + Duration::days(365 * SERVER_YEARS);
        params.key_usages = vec![KeyUsagePurpose::DigitalSignature];
        params.extended_key_usages = vec![ExtendedKeyUsagePurpose::ServerAuth];
        params.use_authority_key_identifier_extension = true;
        let certificate =
            params.signed_by(&key, &self.issuer).map_err(made("sign a server's certificate"))?;
        Ok(IssuedCertificate {
            certificates_pem: certificate.pem().into_bytes().into(),
            key_pem: key.serialize_pem().into_bytes().into(),
        })
    }
}

fn root_params(now: OffsetDateTime) -> CertificateParams {
    let mut params = CertificateParams::default();
    params.distinguished_name = name("Verbund platform authority");
    params.not_before = now - BACKDATED;
    params.not_after = now + Duration::days(365 * ROOT_YEARS);
    params.is_ca = IsCa::Ca(BasicConstraints::Constrained(0));
    params.key_usages = vec![KeyUsagePurpose::KeyCertSign, KeyUsagePurpose::CrlSign];
    params
}

fn name(common_name: &str) -> DistinguishedName {
    let mut name = DistinguishedName::new();
    name.push(DnType::CommonName, common_name);
    name
}

/// Writes a new file with these permissions from its first byte on.
pub(crate) fn write(path: &Path, content: &[u8], mode: u32) -> Result<(), CertificateError> {
    let failed = |source| CertificateError::File { path: path.into(), source };
    let mut file = std::fs::OpenOptions::new()
        .write(true)
        .create(true)
        .truncate(true)
        .mode(mode)
        .open(path)
        .map_err(failed)?;
    file.write_all(content).and_then(|()| file.sync_all()).map_err(failed)
}

#[cfg(test)]
#[allow(
    clippy::disallowed_methods,
    reason = "the verifier of rustls reads the machine's clock, too"
)]
mod tests {
    use std::sync::Arc;

    use rustls::{
        RootCertStore,
        client::WebPkiServerVerifier,
        client::danger::ServerCertVerifier,
        pki_types::{CertificateDer, ServerName, UnixTime, pem::PemObject},
    };

    use super::*;

    #[test]
    fn a_reopened_authority_vouches_with_the_same_root() {
        let folder = tempfile::tempdir().expect("a folder");
        let now = OffsetDateTime::now_utc();
        let root =
            CertificateAuthority::open(folder.path(), now).expect("made").root_pem().to_owned();
        let authority =
            CertificateAuthority::open(folder.path(), now + Duration::days(1)).expect("reopened");
        assert_eq!(authority.root_pem(), root);

        let issued =
            authority.issue(&["localhost".into(), "127.0.0.1".into()], now).expect("issued");
        let mut roots = RootCertStore::empty();
        roots
            .add(CertificateDer::from_pem_slice(root.as_bytes()).expect("a certificate"))
            .expect("a root");
        let provider = Arc::new(rustls::crypto::ring::default_provider());
        let verifier = WebPkiServerVerifier::builder_with_provider(Arc::new(roots), provider)
            .build()
            .expect("a verifier");
        let leaf = CertificateDer::from_pem_slice(&issued.certificates_pem).expect("a certificate");
        for (name, is_right) in
            [("localhost", true), ("127.0.0.1", true), ("elsewhere.example", false)]
        {
            let name = ServerName::try_from(name).expect("a name");
            let verified = verifier.verify_server_cert(&leaf, &[], &name, &[], UnixTime::now());
            assert_eq!(verified.is_ok(), is_right, "{name:?}");
        }
    }

    #[test]
    fn the_key_is_for_the_owner_only() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("a folder");
        CertificateAuthority::open(folder.path(), OffsetDateTime::now_utc()).expect("made");
        let mode = std::fs::metadata(folder.path().join("root.key"))
            .expect("it exists")
            .permissions()
            .mode();
        assert_eq!(mode & 0o777, 0o600);
    }
}
