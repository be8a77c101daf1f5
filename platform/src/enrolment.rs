//! Enrolment: a single-use token becomes a connector's own credential.

use asi_model::{DateTime, FactoryId, ToolId};
use base64::{Engine, engine::general_purpose::URL_SAFE_NO_PAD};
use daemon::{Confidential, web::session::random_token};
use sha2::{Digest, Sha256};

use crate::store::{BrokerCredential, Holder, Store, StoreError, Work};

/// A token, shown once.
#[derive(Debug)]
pub struct EnrolmentToken {
    /// `<platform's address, base64url>.<secret>`: all a connector needs to enrol.
    pub token: Confidential<String>,
    /// Until when it can be used.
    pub expires_at: DateTime,
}

/// A credential for the broker, shown once.
#[derive(Debug)]
pub struct NewCredential {
    /// Whose it is.
    pub holder: Holder,
    /// The secret: 256 random bits as text.
    pub secret: Confidential<String>,
}

/// Makes a token for a factory.
///
/// # Errors
/// [`StoreError`].
pub async fn make_token(
    store: &Store,
    factory: &FactoryId,
    public_url: &str,
    now: DateTime,
    lifetime: std::time::Duration,
) -> Result<EnrolmentToken, StoreError> {
    let secret = random_token();
    let expires_at = now.after(lifetime);
    let mut work = store.begin().await?;
    work.credentials().add_token(&hash(&secret), factory, now, expires_at).await?;
    work.commit().await?;
    let token = format!("{}.{secret}", URL_SAFE_NO_PAD.encode(public_url));
    Ok(EnrolmentToken { token: token.into(), expires_at })
}

/// Turns a token into a credential; `None` where the token is unknown, used or too old. Of a factory's credentials the
/// newest two are alive, so that enrolling anew rotates without an interruption.
///
/// # Errors
/// [`StoreError`].
pub async fn enrol(
    store: &Store,
    token: &Confidential<String>,
    now: DateTime,
) -> Result<Option<(FactoryId, NewCredential)>, StoreError> {
    let secret = token.expose().rsplit('.').next().unwrap_or_default();
    let mut work = store.begin().await?;
    let Some(factory) = work.credentials().use_token(&hash(secret), now).await? else { return Ok(None) };
    let credential = add_credential(&mut work, Holder::Factory(factory.clone()), now).await?;
    work.factories().enrolled(&factory, now).await?;
    work.commit().await?;
    Ok(Some((factory, credential)))
}

/// Makes a credential for a tool.
///
/// # Errors
/// [`StoreError`].
pub async fn make_tool_credential(store: &Store, tool: ToolId, now: DateTime) -> Result<NewCredential, StoreError> {
    let mut work = store.begin().await?;
    let credential = add_credential(&mut work, Holder::Tool(tool), now).await?;
    work.commit().await?;
    Ok(credential)
}

async fn add_credential(work: &mut Work, holder: Holder, now: DateTime) -> Result<NewCredential, StoreError> {
    let secret = random_token();
    let credential = BrokerCredential { holder: holder.clone(), secret_hash: hash(&secret) };
    work.credentials().add(&credential, now).await?;
    Ok(NewCredential { holder, secret: secret.into() })
}

fn hash(secret: &str) -> [u8; 32] {
    Sha256::digest(secret.as_bytes()).into()
}
