//! Secrets in the rows of a store: sealed at its start, and again with another key.

use anyhow::Context as _;
use async_trait::async_trait;

use super::Sealer;
use crate::Confidential;

/// A secret as a store has it.
pub struct StoredSecret<H> {
    /// The row that it belongs to.
    pub holder: H,
    /// Plain text, in a store of before.
    pub plain: Option<Confidential<String>>,
    /// Text of [`Sealer::seal`].
    pub sealed: Option<String>,
}

/// Store with secrets.
#[async_trait]
pub trait SecretStore: Send {
    /// Row that has a secret.
    type Holder: Send + Sync;

    /// Command that removes what no key opens, as a person enters it.
    const FORGET: &'static str;

    /// Returns the purpose for which the secret of a row is sealed.
    fn purpose(holder: &Self::Holder) -> String;

    /// Reads all secrets, sealed or not.
    ///
    /// # Errors
    /// When the store fails.
    async fn secrets(&mut self) -> anyhow::Result<Vec<StoredSecret<Self::Holder>>>;

    /// Puts a sealed text, or none, in place of a secret, and overwrites what was there. False where
    /// the secret was changed meanwhile.
    ///
    /// # Errors
    /// When the store fails.
    async fn replace_secret(
        &mut self,
        former: &StoredSecret<Self::Holder>,
        sealed: Option<&str>,
    ) -> anyhow::Result<bool>;

    /// Empties the write-ahead log, which has the pages of before, as far as nobody else reads them.
    ///
    /// # Errors
    /// When the store fails.
    async fn empty_log(&mut self) -> anyhow::Result<()>;
}

/// Returns what to do about a secret that no key opens.
#[must_use]
pub fn remedy<S: SecretStore + ?Sized>() -> String {
    format!(
        "restore the key, or remove what no key opens with `{}` and give those secrets again",
        S::FORGET
    )
}

/// Seals what a store of before holds in plain text, and again what a former key has sealed. Returns the
/// number of secrets that were sealed.
///
/// # Errors
/// When a key or the store fails; what was sealed by then stays so.
pub async fn seal_all<S: SecretStore>(store: &mut S, sealer: &Sealer) -> anyhow::Result<usize> {
    let mut count = 0;
    let (mut had_plain, stored) = (false, store.secrets().await?);
    for secret in stored {
        let purpose = S::purpose(&secret.holder);
        let text = match (&secret.plain, &secret.sealed) {
            (Some(plain), _) => {
                had_plain = true;
                plain.clone()
            }
            (None, Some(sealed)) if !sealer.is_current(sealed).with_context(remedy::<S>)? => {
                sealer.open(&purpose, sealed).with_context(|| {
                    format!("opening the stored secret for {purpose}; {}", remedy::<S>())
                })?
            }
            _ => continue,
        };
        let sealed = sealer.seal(&purpose, text.expose())?;
        // One that was changed meanwhile was sealed by who changed it.
        count += usize::from(store.replace_secret(&secret, Some(&sealed)).await?);
    }
    if had_plain {
        store.empty_log().await?;
    }
    Ok(count)
}

/// Removes the secrets that no key opens, and returns their rows.
///
/// # Errors
/// When the store fails.
pub async fn forget<S: SecretStore>(
    store: &mut S,
    sealer: &Sealer,
) -> anyhow::Result<Vec<S::Holder>> {
    let mut forgotten = Vec::new();
    for secret in store.secrets().await? {
        let Some(sealed) = &secret.sealed else { continue };
        if sealer.open(&S::purpose(&secret.holder), sealed).is_err()
            && store.replace_secret(&secret, None).await?
        {
            forgotten.push(secret.holder);
        }
    }
    Ok(forgotten)
}

/// Makes a new key and seals all secrets with it, also beside a running daemon. Returns their number.
///
/// # Errors
/// When a key or the store fails. Whatever was done by then, each secret opens.
pub async fn rotate<S: SecretStore>(store: &mut S, sealer: &Sealer) -> anyhow::Result<usize> {
    // The new key pushes out the one before the last: nothing may rest on that.
    seal_all(store, sealer).await?;
    sealer.renew()?;
    seal_all(store, sealer).await
}
