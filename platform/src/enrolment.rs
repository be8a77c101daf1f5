//! Enrolment: a single-use token becomes a connector's own credential.

use asi_model::{DateTime, FactoryId, ToolId};
use base64::{Engine, engine::general_purpose::URL_SAFE_NO_PAD};
use daemon::{Confidential, web::session::random_token};
use sha2::{Digest, Sha256};

use crate::{
    config::PlatformConfig,
    store::{BrokerCredential, Holder, StoreError, Work},
};

/// A token, shown once.
#[derive(Debug)]
pub struct EnrolmentToken {
    /// `<platform's address, base64url>.<secret>`: all a connector needs to enrol.
    pub token: Confidential<String>,
    /// End of its validity.
    pub expires_at: DateTime,
}

/// A credential for the broker, shown once.
#[derive(Debug)]
pub struct NewCredential {
    pub holder: Holder,
    /// The secret: 256 random bits as text.
    pub secret: Confidential<String>,
}

/// Makes a token for a factory.
///
/// # Errors
/// [`StoreError`].
pub async fn make_token(
    work: &mut Work,
    factory: &FactoryId,
    public_url: &str,
    now: DateTime,
    lifetime: std::time::Duration,
) -> Result<EnrolmentToken, StoreError> {
    let secret = random_token();
    let expires_at = now.after(lifetime);
    // The hash alone: a copy of the database enrols nobody.
    work.credentials().add_token(&hash(&secret), factory, now, expires_at).await?;
    let token = format!("{}.{secret}", URL_SAFE_NO_PAD.encode(public_url));
    Ok(EnrolmentToken { token: token.into(), expires_at })
}

/// Failure to issue a credential.
#[derive(Debug, thiserror::Error)]
pub enum EnrolmentError {
    /// The token is unknown, used or too old.
    #[error("the token is unknown, used or too old")]
    TokenRefused,
    /// Another broker is in use and its administration has made no account.
    #[error("broker.external.accounts has no account {user_name}")]
    NoAccount { user_name: String },
    #[error("the store failed")]
    Store(#[from] StoreError),
}

/// Turns a token into a credential. Of a factory's credentials the newest two are alive, so that
/// enrolling again rotates without an interruption. With another broker the configured account is
/// handed out.
///
/// # Errors
/// [`EnrolmentError`]; the token is as unused as before where the work is dropped.
pub async fn enrol(
    work: &mut Work,
    config: &PlatformConfig,
    token: &Confidential<String>,
    now: DateTime,
) -> Result<(FactoryId, NewCredential), EnrolmentError> {
    let secret = token.expose().rsplit('.').next().unwrap_or_default();
    let factory = work
        .credentials()
        .use_token(&hash(secret), now)
        .await?
        .ok_or(EnrolmentError::TokenRefused)?;
    let credential = credential(work, config, Holder::Factory(factory.clone()), now).await?;
    work.factories().enrolled(&factory, now).await?;
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
    if config.broker.external.is_some() {
        let user_name = holder.user_name();
        let password =
            config.external_password(&user_name).ok_or(EnrolmentError::NoAccount { user_name })?;
        return Ok(NewCredential { holder, secret: password.clone() });
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
