//! Application certificate of the twin: its description, a request to an authority, and the
//! installation of an issued one. The key is generated here and never leaves.

mod check;

use std::{
    fs,
    path::{Path, PathBuf},
};

use asi_model::{DateTime, FactoryId};
use opcua_stack::opcua::crypto::{CertificateStore, KeySize, PrivateKey, X509};
use rcgen::{
    CertificateParams, DnType, ExtendedKeyUsagePurpose, KeyPair, KeyUsagePurpose, SanType,
};
use x509_parser::{certificate::X509Certificate, pem::Pem, prelude::FromDer, time::ASN1Time};

use super::{
    certificate::{
        CERTIFICATE_FILE, KEY_BITS, KEY_FILE, create_if_missing, is_pair, prepare_folders, restrict,
    },
    certificate_files::{files, replace},
    rejected_clients::{fingerprint, thumbprint},
    trust::{faults, refuse, time},
};
use crate::{
    config::TwinConfig,
    error::TwinError,
    host_names::{certified_names, names_in},
    trust_fault::TrustFault,
};

/// The key of the last request, within the folder.
const REQUESTED_KEY_FILE: &str = "private/requested.pem";
/// Longest certificate with its chain, in bytes.
const FILE_BYTES_MAX: usize = 256 * 1024;

/// The certificate that clients see at present.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InstalledCertificate {
    /// SHA-1 over the certificate, in lower-case hexadecimal digits.
    pub thumbprint: String,
    /// SHA-256 over the certificate in lower-case hexadecimal digits, for people to compare.
    pub fingerprint: String,
    /// The subject's distinguished name.
    pub subject: String,
    /// The issuer's distinguished name.
    pub issuer: String,
    /// True when the twin made it and renews it.
    pub is_self_signed: bool,
    /// ApplicationUri in its alternative names.
    pub application_uri: Option<String>,
    /// Host names and addresses in its alternative names.
    pub host_names: Vec<String>,
    /// Beginning of its validity.
    pub not_before: DateTime,
    /// End of its validity.
    pub not_after: DateTime,
    /// Length of its RSA key in bits.
    pub key_bits: usize,
}

/// Subject of a certificate request, beside application and hosts. Authorities may replace it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RequestedSubject {
    /// The common name; the twin's default when absent.
    pub common_name: Option<String>,
    pub organization: Option<String>,
    /// True to generate a new key instead of using the present one.
    pub with_new_key: bool,
}

/// Certificate and key of the twin, as files. A change is used from the next connection on, also by
/// a twin that runs in another process.
#[derive(Debug, Clone)]
pub struct ApplicationCertificate {
    config: TwinConfig,
    application_uri: String,
}

impl ApplicationCertificate {
    /// Creates the access to the files of a factory's twin.
    #[must_use]
    pub fn new(factory_id: &FactoryId, config: TwinConfig) -> Self {
        Self { config, application_uri: application_uri(factory_id) }
    }

    /// Describes the stored certificate. One is made if there is none yet.
    ///
    /// # Errors
    /// [`TwinError`] when it cannot be read or made.
    pub fn show(&self) -> Result<InstalledCertificate, TwinError> {
        self.ensure()?;
        let read = CertificateStore::read_cert(&self.path(CERTIFICATE_FILE));
        describe(&read.map_err(|reason| TwinError::Certificate { reason })?)
    }

    /// Creates a certificate request (PKCS #10, as PEM) for this application and its configured host
    /// names, to be given to an authority. Its key is stored until a certificate for it is
    /// installed.
    ///
    /// # Errors
    /// [`TwinError`] when the key cannot be read, generated or stored, or a certificate cannot
    /// contain a name.
    pub fn request(&self, subject: &RequestedSubject) -> Result<String, TwinError> {
        let failed = |reason: String| TwinError::Certificate { reason };
        self.ensure()?;
        let key = if subject.with_new_key {
            PrivateKey::new(KEY_BITS).map_err(|error| failed(error.to_string()))?
        } else {
            CertificateStore::read_pkey(&self.path(KEY_FILE)).map_err(failed)?
        };
        let der = key.to_der().map_err(|error| failed(error.to_string()))?;
        let key = KeyPair::try_from(der.as_bytes()).map_err(|error| failed(error.to_string()))?;
        let request = self
            .parameters(subject)
            .and_then(|parameters| parameters.serialize_request(&key))
            .and_then(|request| request.pem())
            .map_err(|error| failed(format!("the request cannot be made: {error}")))?;
        self.store_requested_key(key.serialize_pem().as_bytes())?;
        tracing::info!(
            with_new_key = subject.with_new_key,
            "A certificate for the twin was requested."
        );
        Ok(request)
    }

    /// Replaces the present certificate by an issued one. The content is PEM - the certificate, and
    /// those of the authorities up to the root in any order - or only the certificate in DER, if the
    /// trust list contains its authorities.
    ///
    /// # Errors
    /// [`TwinError::Refused`] with all faults, [`TwinError`] when it cannot be stored.
    pub fn install(&self, content: &[u8], by: &str) -> Result<InstalledCertificate, TwinError> {
        prepare_folders(&self.config.pki_directory)?;
        let certificates = certificates(content)?;
        let keys: Vec<(&str, PrivateKey)> = [KEY_FILE, REQUESTED_KEY_FILE]
            .into_iter()
            .filter_map(|file| Some((file, CertificateStore::read_pkey(&self.path(file)).ok()?)))
            .collect();
        let matching = certificates.iter().find_map(|der| {
            let certificate = X509::from_der(der).ok()?;
            let (file, _) = keys.iter().find(|(_, key)| is_pair(&certificate, key))?;
            Some((der, certificate, *file))
        });
        let Some((der, certificate, key_file)) = matching else {
            return Err(TrustFault::new(
                "WRONG_KEY",
                "No certificate in it was issued for the twin's key, nor for that of the last request. Give the \
                 certificate that the authority made of the last request, or make a new request.",
            )
            .into());
        };
        let expected = check::Expected {
            application_uri: &self.application_uri,
            host_names: &certified_names(&self.config),
            now: ASN1Time::now(),
        };
        let mut authorities = certificates.clone();
        authorities.extend(self.known_authorities()?);
        refuse(check::faults(der, &authorities, &expected))?;

        // The certificate last: the twin uses a pair only when it matches, and after a crash in
        // between the requested key still exists.
        if key_file == REQUESTED_KEY_FILE {
            self.write_key(KEY_FILE, &read_file(&self.path(REQUESTED_KEY_FILE))?)?;
        }
        replace(&self.path(CERTIFICATE_FILE), der)?;
        match fs::remove_file(self.path(REQUESTED_KEY_FILE)) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                tracing::warn!(%error, "The key of the last request could not be removed.");
            }
            _ => {}
        }
        let installed = describe(&certificate)?;
        tracing::info!(
            by,
            certificate.thumbprint = installed.thumbprint,
            "A certificate for the twin was installed."
        );
        Ok(installed)
    }

    fn ensure(&self) -> Result<(), TwinError> {
        create_if_missing(&self.config, &self.application_uri)
    }

    fn parameters(&self, subject: &RequestedSubject) -> Result<CertificateParams, rcgen::Error> {
        let hosts = certified_names(&self.config);
        let mut parameters = CertificateParams::default();
        let own_name =
            || format!("Verbund Twin {}", hosts.first().map_or("localhost", String::as_str));
        parameters.distinguished_name = rcgen::DistinguishedName::new();
        parameters
            .distinguished_name
            .push(DnType::CommonName, subject.common_name.clone().unwrap_or_else(own_name));
        let organization = subject.organization.clone().unwrap_or_else(|| "Verbund".to_owned());
        parameters.distinguished_name.push(DnType::OrganizationName, organization);
        // OPC 10000-6 §6.2.2: the ApplicationUri is the first alternative name; usages as given
        // there.
        parameters.subject_alt_names =
            vec![SanType::URI(self.application_uri.as_str().try_into()?)];
        for host in hosts {
            let name = match host.parse() {
                Ok(address) => SanType::IpAddress(address),
                Err(_) => SanType::DnsName(host.try_into()?),
            };
            parameters.subject_alt_names.push(name);
        }
        parameters.key_usages = vec![
            KeyUsagePurpose::DigitalSignature,
            KeyUsagePurpose::ContentCommitment,
            KeyUsagePurpose::KeyEncipherment,
            KeyUsagePurpose::DataEncipherment,
        ];
        parameters.extended_key_usages =
            vec![ExtendedKeyUsagePurpose::ServerAuth, ExtendedKeyUsagePurpose::ClientAuth];
        Ok(parameters)
    }

    fn store_requested_key(&self, pem: &[u8]) -> Result<(), TwinError> {
        self.write_key(REQUESTED_KEY_FILE, pem)
    }

    /// Writes a key file that only its owner may read, also while it is written.
    fn write_key(&self, file: &str, pem: &[u8]) -> Result<(), TwinError> {
        let (path, new) = (self.path(file), self.path("private/new.pem"));
        let failed = |source| TwinError::Pki { path: path.clone(), source };
        fs::write(&new, b"").map_err(failed)?;
        restrict(&new, 0o600)?;
        fs::write(&new, pem).map_err(failed)?;
        fs::rename(&new, &path).map_err(failed)
    }

    /// Returns the certificates of authorities in the trust list.
    fn known_authorities(&self) -> Result<Vec<Vec<u8>>, TwinError> {
        let mut all = Vec::new();
        for folder in ["trusted", "issuers"] {
            let found = files(&self.config.pki_directory.join(folder), "der")?;
            all.extend(found.into_iter().map(|(_, der)| der));
        }
        Ok(all)
    }

    fn path(&self, file: &str) -> PathBuf {
        self.config.pki_directory.join(file)
    }
}

/// Returns the ApplicationUri of a factory's twin.
pub(crate) fn application_uri(factory_id: &FactoryId) -> String {
    format!("urn:verbund:twin:{factory_id}")
}

/// Parses the certificates in a file.
fn certificates(content: &[u8]) -> Result<Vec<Vec<u8>>, TwinError> {
    if content.len() > FILE_BYTES_MAX {
        return Err(TrustFault::new(
            "TOO_LONG",
            "It is longer than any certificate with its chain.",
        )
        .into());
    }
    if !content.windows(10).any(|window| window == b"-----BEGIN") {
        faults::certificate(content)?;
        return Ok(vec![content.to_vec()]);
    }
    let mut found = Vec::new();
    for block in Pem::iter_from_buffer(content) {
        let block = block
            .map_err(|_| TrustFault::new("NOT_A_CERTIFICATE", "The PEM text in it is damaged."))?;
        if block.label.contains("PRIVATE KEY") {
            return Err(TrustFault::new(
                "PRIVATE_KEY",
                "It holds a private key. The twin's key is made here and goes nowhere: have a certificate issued for the \
                 request.",
            )
            .into());
        }
        if block.label.contains("REQUEST") {
            return Err(TrustFault::new(
                "NOT_ISSUED",
                "This is a request. Give what the authority makes of it.",
            )
            .into());
        }
        faults::certificate(&block.contents)?;
        found.push(block.contents);
    }
    Ok(found)
}

fn describe(certificate: &X509) -> Result<InstalledCertificate, TwinError> {
    let der = certificate.as_byte_string();
    let (_, parsed) = X509Certificate::from_der(der.as_ref())
        .map_err(|error| TwinError::Certificate { reason: error.to_string() })?;
    Ok(InstalledCertificate {
        thumbprint: thumbprint(certificate),
        fingerprint: fingerprint(certificate),
        subject: parsed.subject().to_string(),
        issuer: parsed.issuer().to_string(),
        is_self_signed: parsed.issuer().as_raw() == parsed.subject().as_raw(),
        application_uri: faults::application_uri(&parsed).map(str::to_owned),
        host_names: names_in(&parsed),
        not_before: time(parsed.validity().not_before),
        not_after: time(parsed.validity().not_after),
        key_bits: certificate.public_key().map_or(0, |key| key.bit_length()),
    })
}

fn read_file(path: &Path) -> Result<Vec<u8>, TwinError> {
    fs::read(path).map_err(|source| TwinError::Pki { path: path.to_owned(), source })
}
