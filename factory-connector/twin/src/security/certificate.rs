//! The certificate that the twin makes for itself at the first start, and renews before it expires.

use std::{
    fs,
    path::{Path, PathBuf},
    time::Duration,
};

use asi_model::DateTime;
use opcua_stack::opcua::{
    crypto::{CertificateStore, PrivateKey, X509, X509Data},
    server::ServerIdentity,
};
use x509_parser::{certificate::X509Certificate, prelude::FromDer};

use super::{
    approvals, rejected_clients,
    trust::{self, faults::application_uri as application_uri_of},
};
use crate::{
    clock,
    config::TwinConfig,
    error::TwinError,
    host_names::{certified_names, names_host},
};

/// Size of a new key; all offered policies accept 2048 to 4096 bits.
pub(crate) const KEY_BITS: u32 = 2048;
/// The certificate within the folder.
pub(crate) const CERTIFICATE_FILE: &str = "own/cert.der";
/// The key within the folder.
pub(crate) const KEY_FILE: &str = "private/private.pem";

/// Flaws with which an issued certificate is still better than a self-signed one.
const EXPIRES_SOON: &str = "it expires soon";
const LACKS_HOST_NAME: &str = "it lacks a configured host name";

/// Ensures a usable certificate: for this application, these host names, and a sufficient time. True
/// when a new one was made.
///
/// # Errors
/// [`TwinError`] when the folder cannot be written or no certificate can be made.
pub(crate) fn ensure(
    config: &TwinConfig,
    application_uri: &str,
    now: DateTime,
) -> Result<bool, TwinError> {
    let folder = &config.pki_directory;
    prepare_folders(folder)?;
    let hosts = certified_names(config);
    let Some(flaw) = flaw(folder, config, application_uri, &hosts, now) else { return Ok(false) };
    if [EXPIRES_SOON, LACKS_HOST_NAME].contains(&flaw) && is_issued(folder) {
        tracing::warn!(
            path = %folder.join(CERTIFICATE_FILE).display(),
            reason = flaw,
            "The twin needs a new certificate. An authority issued the present one, so the twin does not replace it by \
             one of its own: run `factory-connector certificate request`, have the request signed, and install the \
             result with `factory-connector certificate install`. No restart is needed."
        );
        return Ok(false);
    }
    tracing::info!(
        reason = flaw,
        "The twin makes itself a new certificate. Clients have to trust it again."
    );
    create(folder, config, application_uri, &hosts)?;
    Ok(true)
}

/// Makes a certificate if there is none, as before the first start.
///
/// # Errors
/// [`TwinError`] as of [`ensure`].
pub(crate) fn create_if_missing(
    config: &TwinConfig,
    application_uri: &str,
) -> Result<(), TwinError> {
    let exists =
        [CERTIFICATE_FILE, KEY_FILE].iter().all(|file| config.pki_directory.join(file).exists());
    if exists {
        return prepare_folders(&config.pki_directory);
    }
    ensure(config, application_uri, clock::now()).map(drop)
}

/// Reads the stored certificate and key; none while they do not match.
///
/// # Errors
/// [`TwinError::Certificate`] when one of them cannot be read.
pub(crate) fn load(config: &TwinConfig) -> Result<Option<ServerIdentity>, TwinError> {
    let failed = |reason: String| TwinError::Certificate { reason };
    let certificate = CertificateStore::read_cert(&config.pki_directory.join(CERTIFICATE_FILE))
        .map_err(failed)?;
    let private_key =
        CertificateStore::read_pkey(&config.pki_directory.join(KEY_FILE)).map_err(failed)?;
    let is_pair = is_pair(&certificate, &private_key);
    Ok(is_pair.then_some(ServerIdentity {
        certificate: Some(certificate),
        private_key: Some(private_key),
    }))
}

/// Returns the time until the stored certificate is due for renewal; zero when it is.
pub(crate) fn due_in(config: &TwinConfig, now: DateTime) -> Duration {
    let seconds = CertificateStore::read_cert(&config.pki_directory.join(CERTIFICATE_FILE))
        .map_or(0, |certificate| seconds_left(&certificate, config, now));
    Duration::from_secs(u64::try_from(seconds).unwrap_or(0))
}

/// Returns the seconds until a certificate is due for renewal; negative afterwards.
fn seconds_left(certificate: &X509, config: &TwinConfig, now: DateTime) -> i64 {
    let until_end = certificate
        .not_after()
        .map_or(0, |end| end.timestamp() - now.unix_micros().div_euclid(1_000_000));
    until_end - i64::from(config.security.certificate_renewal_days) * 86_400
}

/// Returns whether an authority issued the stored certificate, rather than the twin itself.
fn is_issued(folder: &Path) -> bool {
    let der = fs::read(folder.join(CERTIFICATE_FILE)).unwrap_or_default();
    X509Certificate::from_der(&der)
        .is_ok_and(|(_, certificate)| certificate.issuer() != certificate.subject())
}

pub(crate) fn prepare_folders(folder: &Path) -> Result<(), TwinError> {
    let denied = folder.join(trust::DENIED);
    let waiting = folder.join(trust::WAITING);
    if waiting.exists() && !denied.exists() {
        // Former versions had one folder for both. What an engineer rejected must stay so; which of them were is not known.
        fs::rename(&waiting, &denied)
            .map_err(|source| TwinError::Pki { path: waiting.clone(), source })?;
    }
    for name in [
        "own",
        "private",
        trust::TRUSTED,
        trust::WAITING,
        trust::DENIED,
        trust::ISSUED,
        trust::ISSUERS,
        trust::REVOCATION_LISTS,
        rejected_clients::FOLDER,
        approvals::FOLDER,
    ] {
        let path = folder.join(name);
        fs::create_dir_all(&path)
            .map_err(|source| TwinError::Pki { path: path.clone(), source })?;
    }
    restrict(&folder.join("private"), 0o700)
}

#[cfg(unix)]
pub(crate) fn restrict(path: &Path, mode: u32) -> Result<(), TwinError> {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(path, fs::Permissions::from_mode(mode))
        .map_err(|source| TwinError::Pki { path: path.to_owned(), source })
}

#[cfg(not(unix))]
pub(crate) fn restrict(_path: &Path, _mode: u32) -> Result<(), TwinError> {
    Ok(())
}

/// Returns the flaw for which the stored certificate cannot be used; `None` when it can.
fn flaw(
    folder: &Path,
    config: &TwinConfig,
    application_uri: &str,
    hosts: &[String],
    now: DateTime,
) -> Option<&'static str> {
    let Ok(certificate) = CertificateStore::read_cert(&folder.join(CERTIFICATE_FILE)) else {
        return Some("there is none");
    };
    let Ok(key) = CertificateStore::read_pkey(&folder.join(KEY_FILE)) else {
        return Some("its key is missing");
    };
    if !is_pair(&certificate, &key) {
        return Some("it does not belong to its key");
    }
    let der = certificate.as_byte_string();
    let Ok((_, parsed)) = X509Certificate::from_der(der.as_ref()) else {
        return Some("it cannot be read");
    };
    if application_uri_of(&parsed) != Some(application_uri) {
        return Some("it was made for another factory");
    }
    if hosts.iter().any(|host| !names_host(&parsed, host)) {
        return Some(LACKS_HOST_NAME);
    }
    (seconds_left(&certificate, config, now) <= 0).then_some(EXPIRES_SOON)
}

pub(crate) fn is_pair(certificate: &X509, key: &PrivateKey) -> bool {
    use opcua_stack::opcua::crypto::KeySize;
    let (probe, mut signature) = (b"the same pair", vec![0; key.size()]);
    key.sign_sha256(probe, &mut signature).is_ok()
        && certificate
            .public_key()
            .is_ok_and(|public| public.verify_sha256(probe, &signature).unwrap_or(false))
}

fn create(
    folder: &Path,
    config: &TwinConfig,
    application_uri: &str,
    hosts: &[String],
) -> Result<(), TwinError> {
    // OPC 10000-6 §6.2.2: the ApplicationUri is the first alternative name. The loopback names are
    // added if the twin listens there.
    let is_local = config.listen.ip().is_loopback() || config.listen.ip().is_unspecified();
    let names =
        X509Data::alt_host_names(application_uri, Some(hosts.to_vec()), is_local, false, is_local);
    let data = X509Data {
        key_size: KEY_BITS,
        common_name: format!("Verbund Twin {}", hosts.first().map_or("localhost", String::as_str)),
        organization: "Verbund".to_owned(),
        organizational_unit: String::new(),
        country: String::new(),
        state: String::new(),
        alt_host_names: names,
        certificate_duration_days: config.security.certificate_validity_days.max(1),
    };
    // Written under other names first: a crash during the renames leaves a pair that does not match,
    // which the next start detects.
    let new = (folder.join("own/new.der"), folder.join("private/new.pem"));
    CertificateStore::create_certificate_and_key(&data, true, &new.0, &new.1)
        .map_err(|reason| TwinError::Certificate { reason })?;
    restrict(&new.1, 0o600)?;
    rename(&new.1, folder.join(KEY_FILE))?;
    rename(&new.0, folder.join(CERTIFICATE_FILE))
}

fn rename(from: &Path, to: PathBuf) -> Result<(), TwinError> {
    fs::rename(from, &to).map_err(|source| TwinError::Pki { path: to, source })
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that cannot go on should say where")]
mod tests {
    use super::*;

    #[test]
    fn a_certificate_stays_while_it_is_usable() {
        let folder = tempfile::tempdir().unwrap();
        let mut config = TwinConfig {
            pki_directory: folder.path().to_owned(),
            host_names: vec!["press.plant".to_owned()],
            ..TwinConfig::default()
        };
        let now = clock::now();
        let read = || fs::read(folder.path().join(CERTIFICATE_FILE)).unwrap();
        ensure(&config, "urn:verbund:twin:F", now).unwrap();
        let first = read();
        ensure(&config, "urn:verbund:twin:F", now).unwrap();
        assert_eq!(read(), first, "a usable certificate stays");
        let years_later = DateTime::from_ticks(now.ticks() + 5 * 365 * 86_400 * 10_000_000);
        assert_eq!(
            flaw(
                folder.path(),
                &config,
                "urn:verbund:twin:F",
                &certified_names(&config),
                years_later
            ),
            Some(EXPIRES_SOON)
        );
        config.host_names.push("press2.plant".to_owned());
        ensure(&config, "urn:verbund:twin:F", now).unwrap();
        assert_ne!(read(), first, "a new host name needs a new certificate");
        let own = CertificateStore::read_cert(&folder.path().join(CERTIFICATE_FILE)).unwrap();
        assert!(own.is_application_uri_valid("urn:verbund:twin:F").is_ok());
        assert!(own.is_hostname_valid("press2.plant").is_ok());
    }
}
