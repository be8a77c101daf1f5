//! Accounts and sessions in the platform's store, as the web server reads them.

use std::time::SystemTime;

use asi_model::{DateTime, OrganisationId};
use async_trait::async_trait;
use daemon::web::session::{
    AccountChange, Accounts, AccountsError, PasskeyUse, PasswordHash, SessionId, StoredPasskey,
    StoredSecondFactor, StoredSession,
};

use crate::{
    clock::{Clock, new_opaque_id},
    principal::Principal,
    store::{
        AuditAgent, AuditAgentKind, AuditOutcome, AuditSubject, NewAuditEntry, Role, Store,
        StoreError, User, Work,
    },
};

/// Runs a change in a transaction.
macro_rules! in_transaction {
    ($accounts:ident, $work:ident => $change:expr) => {{
        let done = async {
            let mut $work = $accounts.store.begin().await?;
            let done = $change;
            $work.commit().await?;
            Ok::<_, StoreError>(done)
        };
        done.await.map_err(AccountsError::new)
    }};
}

/// Users and sessions in the platform's store.
#[derive(Debug, Clone)]
pub struct StoredAccounts {
    store: Store,
    clock: Clock,
}

impl StoredAccounts {
    /// Returns accounts over this store.
    #[must_use]
    pub const fn new(store: Store, clock: Clock) -> Self {
        Self { store, clock }
    }

    async fn user(&self, user_name: &str) -> Result<Option<(User, PasswordHash)>, StoreError> {
        self.store.reserved_reader().read().await?.users().lookup(user_name).await
    }

    /// Records what a person did to an account; `part` is what of it was changed.
    async fn record(
        &self,
        work: &mut Work,
        change: AccountChange<'_>,
        user_name: &str,
        part: &str,
    ) -> Result<(), StoreError> {
        let by = work.users().lookup(change.by).await?.map(|(user, _)| user);
        let agent = AuditAgent {
            kind: AuditAgentKind::User,
            name: change.by.to_owned(),
            is_administrator: by.as_ref().is_some_and(|by| by.role == Role::Administrator),
            organisation_id: by.and_then(|by| by.organisation_id),
        };
        let concerned = work.users().lookup(user_name).await?;
        let subject = AuditSubject {
            path: format!("users/{user_name}/{part}"),
            concerned: concerned.and_then(|(user, _)| user.organisation_id),
        };
        let entry = NewAuditEntry {
            entry_id: new_opaque_id(),
            recorded_at: self.clock.now(),
            agent: &agent,
            operation: change.operation,
            subject: &subject,
            outcome: AuditOutcome::Done,
            facts: &[],
        };
        work.audit().add(&entry).await
    }
}

#[async_trait]
impl Accounts for StoredAccounts {
    type Principal = Principal;

    fn organisation(principal: &Principal) -> Option<&str> {
        principal.organisation().map(OrganisationId::as_str)
    }

    async fn password_hash(&self, user_name: &str) -> Result<Option<PasswordHash>, AccountsError> {
        let found = self.user(user_name).await.map_err(AccountsError::new)?;
        Ok(found.map(|(_, hash)| hash))
    }

    async fn principal(&self, user_name: &str) -> Result<Option<Principal>, AccountsError> {
        let found = self.user(user_name).await.map_err(AccountsError::new)?;
        Ok(found.map(|(user, _)| Principal { user }))
    }

    async fn set_password(
        &self,
        user_name: &str,
        password: &PasswordHash,
        kept: &SessionId,
    ) -> Result<(), AccountsError> {
        let change = AccountChange { by: user_name, operation: "changePassword" };
        in_transaction!(self, work => {
            work.users().set_password(user_name, password, kept).await?;
            self.record(&mut work, change, user_name, "password").await?;
        })
    }

    async fn put_session(&self, session: &StoredSession) -> Result<(), AccountsError> {
        let name = &session.user_name;
        let change = AccountChange { by: name, operation: "signIn" };
        in_transaction!(self, work => {
            work.users().put_session(session, self.clock.now()).await?;
            self.record(&mut work, change, name, "session").await?;
        })
    }

    async fn sessions_of(&self, user_name: &str) -> Result<Vec<StoredSession>, AccountsError> {
        let sessions = async {
            self.store.reserved_reader().read().await?.users().sessions_of(user_name).await
        };
        sessions.await.map_err(AccountsError::new)
    }

    async fn touch_session(&self, id: &SessionId, at: SystemTime) -> Result<(), AccountsError> {
        in_transaction!(self, work => work.users().touch_session(id, DateTime::from(at)).await?)
    }

    async fn session(&self, id: &SessionId) -> Result<Option<StoredSession>, AccountsError> {
        let session =
            async { self.store.reserved_reader().read().await?.users().session(id).await };
        session.await.map_err(AccountsError::new)
    }

    async fn delete_session(
        &self,
        id: &SessionId,
        change: Option<AccountChange<'_>>,
    ) -> Result<(), AccountsError> {
        in_transaction!(self, work => {
            if let Some(session) = work.users().session(id).await? {
                work.users().delete_session(id).await?;
                if let Some(change) = change {
                    self.record(&mut work, change, &session.user_name, "session").await?;
                }
            }
        })
    }

    async fn second_factor(
        &self,
        user_name: &str,
    ) -> Result<Option<StoredSecondFactor>, AccountsError> {
        let factor = async {
            self.store.reserved_reader().read().await?.second_factors().lookup(user_name).await
        };
        factor.await.map_err(AccountsError::new)
    }

    async fn put_second_factor(
        &self,
        user_name: &str,
        factor: &StoredSecondFactor,
        change: AccountChange<'_>,
    ) -> Result<(), AccountsError> {
        in_transaction!(self, work => {
            work.second_factors().put(user_name, factor).await?;
            self.record(&mut work, change, user_name, "second-factor").await?;
        })
    }

    async fn delete_second_factor(
        &self,
        user_name: &str,
        change: AccountChange<'_>,
    ) -> Result<bool, AccountsError> {
        in_transaction!(self, work => {
            let had_passkeys = work.passkeys().remove_all(user_name).await?;
            let is_removed = work.second_factors().remove(user_name).await? || had_passkeys;
            if is_removed {
                self.record(&mut work, change, user_name, "second-factor").await?;
            }
            is_removed
        })
    }

    async fn use_time_step(&self, user_name: &str, step: u64) -> Result<bool, AccountsError> {
        in_transaction!(self, work => work.second_factors().use_time_step(user_name, step).await?)
    }

    async fn use_recovery_code(
        &self,
        user_name: &str,
        digest: &str,
    ) -> Result<bool, AccountsError> {
        in_transaction!(self, work => {
            let is_used = work.second_factors().use_recovery_code(user_name, digest).await?;
            if is_used {
                let change = AccountChange { by: user_name, operation: "signIn" };
                self.record(&mut work, change, user_name, "recovery-codes").await?;
            }
            is_used
        })
    }

    async fn passkeys(&self, user_name: &str) -> Result<Vec<StoredPasskey>, AccountsError> {
        let passkeys =
            async { self.store.reserved_reader().read().await?.passkeys().of(user_name).await };
        passkeys.await.map_err(AccountsError::new)
    }

    async fn add_passkey(
        &self,
        user_name: &str,
        passkey: &StoredPasskey,
        recovery_digests: Option<&[String]>,
        change: AccountChange<'_>,
    ) -> Result<bool, AccountsError> {
        in_transaction!(self, work => {
            let is_new = work.passkeys().add(user_name, passkey).await?;
            if is_new {
                if let Some(digests) = recovery_digests {
                    work.second_factors().put_recovery_digests(user_name, digests).await?;
                }
                let part = format!("passkeys/{}", passkey.passkey_id);
                self.record(&mut work, change, user_name, &part).await?;
            }
            is_new
        })
    }

    async fn use_passkey(&self, user_name: &str, used: &PasskeyUse) -> Result<bool, AccountsError> {
        in_transaction!(self, work => work.passkeys().note_use(user_name, used).await?)
    }

    async fn delete_passkey(
        &self,
        user_name: &str,
        passkey_id: &str,
        change: AccountChange<'_>,
    ) -> Result<bool, AccountsError> {
        in_transaction!(self, work => {
            let is_removed = work.passkeys().remove(user_name, passkey_id).await?;
            if is_removed {
                work.second_factors().remove_unused(user_name).await?;
                let part = format!("passkeys/{passkey_id}");
                self.record(&mut work, change, user_name, &part).await?;
            }
            is_removed
        })
    }
}
