//! Sealing of the passwords in the store, each for its holder alone.

use anyhow::Context as _;
use daemon::{
    Confidential,
    sealing::{Sealer, SealingError},
};

use crate::store::{Enrolment, PasswordHolder, SourceRow, StoreSession};

/// Remedy of a password that cannot be opened.
const REMEDY: &str = "restore the key, or remove what no key opens with `factory-connector seal forget` and give those \
                      passwords again";

/// Seals the password of a holder for the store.
///
/// # Errors
/// [`SealingError`].
pub fn seal(
    sealer: &Sealer,
    holder: &PasswordHolder,
    password: &str,
) -> Result<String, SealingError> {
    sealer.seal(&purpose(holder), password)
}

/// Opens the password at the platform's broker.
///
/// # Errors
/// When no key opens it.
pub fn of_broker(sealer: &Sealer, enrolled: &Enrolment) -> anyhow::Result<Confidential<String>> {
    let sealed = enrolled.sealed_password.as_deref().context(
        "the password at the platform's broker is missing: ask an administrator of the platform for a token and enrol again",
    )?;
    sealer
        .open(&purpose(&PasswordHolder::Broker), sealed)
        .with_context(|| format!("opening the password at the platform's broker; {REMEDY}"))
}

/// Opens the password of a source; none where it has none.
///
/// # Errors
/// When no key opens it.
pub fn of_source(sealer: &Sealer, row: &SourceRow) -> anyhow::Result<Option<Confidential<String>>> {
    let holder = PasswordHolder::Source(row.source_id.clone());
    let open = |sealed: &String| sealer.open(&purpose(&holder), sealed);
    row.sealed_password
        .as_ref()
        .map(open)
        .transpose()
        .with_context(|| format!("opening the password of the source {}; {REMEDY}", row.source_id))
}

/// Seals what a store of before holds in plain text, and again what a former key has sealed. Returns the
/// number of passwords that were sealed.
///
/// # Errors
/// When a key or the store fails; what was sealed by then stays so.
pub async fn seal_all(session: &mut StoreSession, sealer: &Sealer) -> anyhow::Result<usize> {
    let mut count = 0;
    let (mut had_plain, stored) = (false, session.passwords().all().await?);
    for password in stored {
        let purpose = purpose(&password.holder);
        let text = match (&password.plain, &password.sealed) {
            (Some(plain), _) => {
                had_plain = true;
                Confidential::from(plain.clone())
            }
            (None, Some(sealed)) if !is_current(sealer, sealed)? => {
                sealer.open(&purpose, sealed).with_context(|| {
                    format!("opening the stored password for {purpose}; {REMEDY}")
                })?
            }
            _ => continue,
        };
        let sealed = sealer.seal(&purpose, text.expose())?;
        // One that was changed meanwhile was sealed by who changed it.
        count += usize::from(session.passwords().replace(&password, Some(&sealed)).await?);
    }
    if had_plain {
        session.passwords().empty_log().await?;
    }
    Ok(count)
}

/// Removes the passwords that no key opens, and returns their holders.
///
/// # Errors
/// When the store fails.
pub async fn forget(
    session: &mut StoreSession,
    sealer: &Sealer,
) -> anyhow::Result<Vec<PasswordHolder>> {
    let mut forgotten = Vec::new();
    for password in session.passwords().all().await? {
        let Some(sealed) = &password.sealed else { continue };
        if sealer.open(&purpose(&password.holder), sealed).is_err()
            && session.passwords().replace(&password, None).await?
        {
            forgotten.push(password.holder);
        }
    }
    Ok(forgotten)
}

/// Makes a new key and seals all passwords with it, also beside a running connector. Returns their number.
///
/// # Errors
/// When a key or the store fails. Whatever was done by then, each password opens.
pub async fn rotate(session: &mut StoreSession, sealer: &Sealer) -> anyhow::Result<usize> {
    // The new key pushes out the one before the last: nothing may rest on that.
    seal_all(session, sealer).await?;
    sealer.renew()?;
    seal_all(session, sealer).await
}

fn is_current(sealer: &Sealer, sealed: &str) -> anyhow::Result<bool> {
    sealer.is_current(sealed).context(REMEDY)
}

fn purpose(holder: &PasswordHolder) -> String {
    match holder {
        PasswordHolder::Broker => "broker".to_owned(),
        PasswordHolder::Source(id) => format!("source/{id}"),
    }
}

#[cfg(test)]
mod tests;
