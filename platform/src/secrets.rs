//! Sealing of the secrets in the store, those of second factors, each for its user alone.

use async_trait::async_trait;
use daemon::{
    sealing::{SecretStore, StoredSecret},
    web::session::second_factor_purpose,
};

use crate::{
    audit::{MachineUser, RecordingStore},
    clock::Clock,
    store::{AuditOutcome, AuditSubject, Store},
};

#[async_trait]
impl SecretStore for Store {
    /// Name of the user.
    type Holder = String;

    const FORGET: &'static str = "platform seal forget";

    fn purpose(user_name: &String) -> String {
        second_factor_purpose(user_name)
    }

    async fn secrets(&mut self) -> anyhow::Result<Vec<StoredSecret<String>>> {
        Ok(self.read().await?.second_factors().secrets().await?)
    }

    async fn replace_secret(
        &mut self,
        former: &StoredSecret<String>,
        sealed: Option<&str>,
    ) -> anyhow::Result<bool> {
        let Some(sealed) = sealed else { return remove_secret(self, former).await };
        let mut work = self.begin().await?;
        let is_replaced = work.second_factors().replace_secret(former, Some(sealed)).await?;
        work.commit().await?;
        Ok(is_replaced)
    }

    async fn empty_log(&mut self) -> anyhow::Result<()> {
        Ok(Self::empty_log(self).await?)
    }
}

/// Removes a secret that no key opens, with an entry of whose it was. False where it was changed meanwhile.
async fn remove_secret(store: &Store, former: &StoredSecret<String>) -> anyhow::Result<bool> {
    let recording = RecordingStore::new(store.clone(), Clock::system());
    let mut work = recording.begin(MachineUser::of_process(), "forgetSecret").await?;
    if !work.second_factors().replace_secret(former, None).await? {
        return Ok(false);
    }
    let user_name = &former.holder;
    let user = work.users().lookup(user_name).await?;
    let concerned = user.and_then(|(user, _)| user.organisation_id);
    let path = format!("users/{user_name}/second-factor");
    work.commit(AuditSubject { path, concerned }, AuditOutcome::Done).await?;
    Ok(true)
}

#[cfg(test)]
mod tests;
