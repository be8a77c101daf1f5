//! Sealing of the secrets in the store, those of second factors, each for its user alone.

use async_trait::async_trait;
use daemon::{
    sealing::{SecretStore, StoredSecret},
    web::session::second_factor_purpose,
};

use crate::store::Store;

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
        let mut work = self.begin().await?;
        let is_replaced = work.second_factors().replace_secret(former, sealed).await?;
        work.commit().await?;
        Ok(is_replaced)
    }

    async fn empty_log(&mut self) -> anyhow::Result<()> {
        Ok(Self::empty_log(self).await?)
    }
}

#[cfg(test)]
mod tests;
