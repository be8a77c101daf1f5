//! Sealing of the secrets in the store - passwords, and those of second factors - each for its holder alone.

use anyhow::Context as _;
use async_trait::async_trait;
use daemon::{
    Confidential,
    sealing::{Sealer, SealingError, SecretStore, StoredSecret, remedy},
    web::session::second_factor_purpose,
};

use crate::store::{Enrolment, SecretHolder, SourceRow, StoreSession};

/// Seals the password of a holder for the store.
///
/// # Errors
/// [`SealingError`].
pub fn seal(
    sealer: &Sealer,
    holder: &SecretHolder,
    password: &str,
) -> Result<String, SealingError> {
    sealer.seal(&StoreSession::purpose(holder), password)
}

/// Opens the password at the platform's broker.
///
/// # Errors
/// When no key opens it.
pub fn of_broker(sealer: &Sealer, enrolled: &Enrolment) -> anyhow::Result<Confidential<String>> {
    let sealed = enrolled.sealed_password.as_deref().context(
        "the password at the platform's broker is missing: ask an administrator of the platform for a token and enrol again",
    )?;
    sealer.open(&StoreSession::purpose(&SecretHolder::Broker), sealed).with_context(|| {
        format!("opening the password at the platform's broker; {}", remedy::<StoreSession>())
    })
}

/// Opens the password of a source; none where it has none.
///
/// # Errors
/// When no key opens it.
pub fn of_source(sealer: &Sealer, row: &SourceRow) -> anyhow::Result<Option<Confidential<String>>> {
    let purpose = StoreSession::purpose(&SecretHolder::Source(row.source_id.clone()));
    let opened = row.sealed_password.as_ref().map(|sealed| sealer.open(&purpose, sealed));
    opened.transpose().with_context(|| {
        let remedy = remedy::<StoreSession>();
        format!("opening the password of the source {}; {remedy}", row.source_id)
    })
}

#[async_trait]
impl SecretStore for StoreSession {
    type Holder = SecretHolder;

    const FORGET: &'static str = "factory-connector seal forget";

    fn purpose(holder: &SecretHolder) -> String {
        match holder {
            SecretHolder::Broker => "broker".to_owned(),
            SecretHolder::Source(id) => format!("source/{id}"),
            SecretHolder::SecondFactor(user) => second_factor_purpose(user),
        }
    }

    async fn secrets(&mut self) -> anyhow::Result<Vec<StoredSecret<SecretHolder>>> {
        Ok(self.secret_rows().all().await?)
    }

    async fn replace_secret(
        &mut self,
        former: &StoredSecret<SecretHolder>,
        sealed: Option<&str>,
    ) -> anyhow::Result<bool> {
        Ok(self.secret_rows().replace(former, sealed).await?)
    }

    async fn empty_log(&mut self) -> anyhow::Result<()> {
        Ok(self.secret_rows().empty_log().await?)
    }
}

#[cfg(test)]
mod tests;
