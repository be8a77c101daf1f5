//! Enrolment: a single-use token becomes a connector's own credential.

use std::path::PathBuf;

use asi_model::{DateTime, FactoryId, ToolId};
use base64::{Engine, engine::general_purpose::URL_SAFE_NO_PAD};
use daemon::{Confidential, certificate_pin::CertificatePin, web::session::random_token};
use message_signature::PublicKey;
use sha2::{Digest, Sha256};

use crate::{
    config::{BrokerPasswordError, PlatformConfig, WebConfig},
    store::{BrokerCredential, Holder, StoreError, Work},
};

/// A token, shown once.
#[derive(Debug)]
pub struct EnrolmentToken {
    /// `<platform's address, base64url>.<pin of its certificate>.<secret>`, without the pin where the
    /// platform does not know its certificate: all a connector needs to enrol.
    pub token: Confidential<String>,
    /// End of its validity.
    pub expires_at: DateTime,
    /// True where it names the certificate of the platform.
    pub is_pinned: bool,
}

/// A credential for the broker, shown once.
#[derive(Debug)]
pub struct NewCredential {
    pub holder: Holder,
    /// The secret: 256 random bits as text.
    pub secret: Confidential<String>,
}

/// Address at which connectors enrol, as a token carries it.
#[derive(Debug, Clone)]
pub struct EnrolmentAddress {
    /// Base URL of the platform for others.
    pub public_url: String,
    /// Certificate that the server shows there, where it is known.
    pub pin: Option<CertificatePin>,
}

impl EnrolmentAddress {
    /// Reads the pin of the configured certificate.
    ///
    /// # Errors
    /// [`CertificateUnreadable`] where its file cannot be read.
    pub fn new(web: &WebConfig, public_url: String) -> Result<Self, CertificateUnreadable> {
        let shown = web.public_certificate.as_ref();
        let own = web.tls.as_ref().map(|files| &files.certificate);
        let file = shown.or(own).filter(|_| public_url.starts_with("https://"));
        let pin = file.map(|path| {
            CertificatePin::of_pem_file(path)
                .map_err(|source| CertificateUnreadable { path: path.clone(), source })
        });
        Ok(Self { public_url, pin: pin.transpose()? })
    }
}

/// The certificate that connectors are shown cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("cannot read the certificate {} for enrolment tokens", path.display())]
pub struct CertificateUnreadable {
    path: PathBuf,
    #[source]
    source: rustls::pki_types::pem::Error,
}

/// Makes a token for a factory.
///
/// # Errors
/// [`StoreError`].
pub async fn make_token(
    work: &mut Work,
    factory: &FactoryId,
    address: &EnrolmentAddress,
    now: DateTime,
    lifetime: std::time::Duration,
) -> Result<EnrolmentToken, StoreError> {
    let secret = random_token();
    let expires_at = now.after(lifetime);
    // The hash alone: a copy of the database enrols nobody.
    work.credentials().add_token(&hash(&secret), factory, now, expires_at).await?;
    let pin = address.pin.map(|pin| format!("{pin}.")).unwrap_or_default();
    let token = format!("{}.{pin}{secret}", URL_SAFE_NO_PAD.encode(&address.public_url));
    Ok(EnrolmentToken { token: token.into(), expires_at, is_pinned: address.pin.is_some() })
}

/// Failure to issue a credential.
#[derive(Debug, thiserror::Error)]
pub enum EnrolmentError {
    /// The token is unknown, used or too old.
    #[error("the token is unknown, used or too old")]
    TokenRefused,
    /// Another broker is in use and there is no account, or its password cannot be read.
    #[error("there is no account at the broker")]
    NoAccount(#[from] BrokerPasswordError),
    #[error("the store failed")]
    Store(#[from] StoreError),
}

/// Returns true for a token that can be used. Only reads, so that made-up ones keep no writer waiting.
///
/// # Errors
/// [`StoreError`].
pub async fn is_usable(
    work: &mut Work,
    token: &Confidential<String>,
    now: DateTime,
) -> Result<bool, StoreError> {
    work.credentials().is_usable(&hash(secret_of(token)), now).await
}

/// Returns the secret at the end of a token.
fn secret_of(token: &Confidential<String>) -> &str {
    token.expose().rsplit('.').next().unwrap_or_default()
}

/// Turns a token into a credential. Of a factory's credentials the newest two are alive, so that
/// enrolling again rotates without an interruption. With another broker the configured account is
/// handed out. A connector that signs brings its key: of these, too, the newest two count. One that
/// brings none does not sign.
///
/// # Errors
/// [`EnrolmentError`]; the token is as unused as before where the work is dropped.
pub async fn enrol(
    work: &mut Work,
    config: &PlatformConfig,
    token: &Confidential<String>,
    signing_key: Option<&PublicKey>,
    now: DateTime,
) -> Result<(FactoryId, NewCredential), EnrolmentError> {
    let factory = work
        .credentials()
        .use_token(&hash(secret_of(token)), now)
        .await?
        .ok_or(EnrolmentError::TokenRefused)?;
    let holder = Holder::Factory(factory.clone());
    let credential = credential(work, config, holder, now).await?;
    work.factories().enrolled(&factory, now).await?;
    match signing_key {
        Some(key) => work.signing_keys().pin(&factory, key, now).await?,
        None => work.signing_keys().begin_unsigned(&factory).await?,
    }
    Ok((factory, credential))
}

/// Makes a credential for a tool, or hands out its account on another broker.
///
/// # Errors
/// [`EnrolmentError`].
pub async fn make_tool_credential(
    work: &mut Work,
    config: &PlatformConfig,
    tool: ToolId,
    now: DateTime,
) -> Result<NewCredential, EnrolmentError> {
    credential(work, config, Holder::Tool(tool), now).await
}

async fn credential(
    work: &mut Work,
    config: &PlatformConfig,
    holder: Holder,
    now: DateTime,
) -> Result<NewCredential, EnrolmentError> {
    work.revoked_access().admit(&holder).await?;
    if let Some(external) = &config.broker.external {
        let secret = external.password_of(&holder.user_name(), &config.sealer())?;
        return Ok(NewCredential { holder, secret });
    }
    Ok(add_credential(work, holder, now).await?)
}

async fn add_credential(
    work: &mut Work,
    holder: Holder,
    now: DateTime,
) -> Result<NewCredential, StoreError> {
    let secret = random_token();
    let credential = BrokerCredential { holder: holder.clone(), secret_hash: hash(&secret) };
    work.credentials().add(&credential, now).await?;
    Ok(NewCredential { holder, secret: secret.into() })
}

fn hash(secret: &str) -> [u8; 32] {
    Sha256::digest(secret.as_bytes()).into()
}

#[cfg(test)]
mod tests {
    use rcgen::{CertificateParams, KeyPair};

    use super::*;
    use crate::store::Store;

    #[tokio::test]
    async fn a_token_pins_the_certificate_that_connectors_are_shown() {
        let folder = tempfile::tempdir().expect("a folder");
        let key = KeyPair::generate().expect("a key");
        let params = CertificateParams::new(vec!["verbund.example".to_owned()]).expect("a name");
        let shown = params.self_signed(&key).expect("signed");
        let path = folder.path().join("shown.pem");
        std::fs::write(&path, shown.pem()).expect("written");
        let web = WebConfig { public_certificate: Some(path), ..WebConfig::default() };
        let store = Store::open(&folder.path().join("store.sqlite")).await.expect("a store");
        let mut work = store.begin().await.expect("begun");
        let (factory, organisation) = ("F".parse().expect("an id"), "O".parse().expect("an id"));
        let now = crate::clock::Clock::system().now();
        let made = crate::store::Organisation {
            organisation_id: organisation,
            name: "O".to_owned(),
            created_at: now,
        };
        work.organisations().add(&made).await.expect("added");
        work.factories().add(&factory, &made.organisation_id, "F", now).await.expect("added");
        work.commit().await.expect("stored");
        let token = async |public_url: &str| {
            let address = EnrolmentAddress::new(&web, public_url.to_owned()).expect("readable");
            let day = std::time::Duration::from_secs(86_400);
            let mut work = store.begin().await.expect("begun");
            let made = make_token(&mut work, &factory, &address, now, day).await.expect("made");
            work.commit().await.expect("stored");
            assert_eq!(made.is_pinned, made.token.expose().split('.').count() == 3);
            made.token.expose().clone()
        };
        let pinned = token("https://verbund.example").await;
        let parts: Vec<&str> = pinned.split('.').collect();
        assert_eq!(parts.len(), 3, "address, pin and secret");
        assert_eq!(parts[1], CertificatePin::of(shown.der()).to_string());
        assert_eq!(
            token("http://127.0.0.1:8080").await.split('.').count(),
            2,
            "without TLS none is shown"
        );
        let (config, token) = (PlatformConfig::default(), pinned.into());
        let mut work = store.begin().await.expect("begun");
        let (enrolled, _) =
            enrol(&mut work, &config, &token, None, now).await.expect("it is a token all the same");
        assert_eq!(enrolled, factory);
    }
}
