//! The connector's answers to the twin's two questions: who is this, and may this value become the
//! field's? And the end of OPC UA sessions whose users changed.

mod user_watch;

pub use user_watch::UserWatch;

use asi_model::{
    DataValue, FieldKey, StatusCode,
    messages::{MappingState, ValueSource},
};
use async_trait::async_trait;
use daemon::{
    Confidential,
    web::session::{PasswordHash, verify_password},
};
use disclosure::DecisionBasis;
use twin::{Authenticator, FieldDecision, FieldWriter, TwinUser};

use crate::{
    books::Verdict,
    desk::{DeskError, DeskHandle, Taken},
    store::{Readers, Role, StoreError, User},
};
use disclosure::GateOutcome;

/// Takes what OPC UA clients write and decide to the desk.
pub struct DeskWriter(pub DeskHandle);

#[async_trait]
impl FieldWriter for DeskWriter {
    async fn write(&self, field: &FieldKey, value: DataValue, user: &TwinUser) -> StatusCode {
        tracing::info!(%field, user.name = %user.name, "An OPC UA client wrote a field.");
        match self.0.value(field.clone(), ValueSource::External, value).await {
            Ok(Taken::Through(outcome)) => status_of(outcome),
            Ok(Taken::Not(status)) => status,
            Err(error) => failure(&error),
        }
    }

    async fn decide(
        &self,
        field: &FieldKey,
        decision: FieldDecision,
        user: &TwinUser,
    ) -> StatusCode {
        let (key, by) = (field.clone(), user.name.to_string());
        let decided = self.0.change(move |books, now| {
            let kept = books
                .field(&key)
                .map(|field| ((*field.decision.policy).clone(), field.decision.grounds.clone()));
            let (policy, grounds) = kept.unwrap_or_default();
            let verdict = match decision.mapping_state {
                MappingState::Pending => Verdict::LeavePending,
                MappingState::Refused => Verdict::Refuse,
                // An OPC UA client opens a field to OPC UA clients; the policy stays as the page
                // set it.
                MappingState::Mapped => {
                    Verdict::Map { value_source: ValueSource::External, mapping: None, policy }
                }
            };
            let grounds =
                DecisionBasis { policy_id: grounds.policy_id, ..DecisionBasis::default() };
            books.decide_on(&key, verdict, decision.reason, &by, grounds, now)
        });
        match decided.await.and_then(|decided| decided.map_err(DeskError::from)) {
            Ok(()) => StatusCode::GOOD,
            Err(error) => failure(&error),
        }
    }
}

const fn status_of(outcome: GateOutcome) -> StatusCode {
    match outcome {
        GateOutcome::Disclosed { is_coarsened: true }
        | GateOutcome::Unchanged { is_coarsened: true } => StatusCode::GOOD_CLAMPED,
        GateOutcome::Disclosed { .. } | GateOutcome::Unchanged { .. } => StatusCode::GOOD,
        GateOutcome::Withheld { .. } => StatusCode::GOOD_COMPLETES_ASYNCHRONOUSLY,
        // It was taken, but nothing of it will ever be seen: the policy withholds the present
        // state.
        GateOutcome::Suppressed => StatusCode::GOOD_CLAMPED,
    }
}

const fn failure(error: &DeskError) -> StatusCode {
    match error {
        DeskError::Decision(_) => StatusCode::BAD_INVALID_ARGUMENT,
        DeskError::NotWritten => StatusCode::BAD_RESOURCE_UNAVAILABLE,
        DeskError::Stopped => StatusCode::BAD_SHUTDOWN,
    }
}

/// Knows the users of the store.
pub struct StoredUsers(pub Readers);

impl StoredUsers {
    async fn user(&self, user_name: &str) -> Result<Option<User>, StoreError> {
        self.0.session().await?.users().lookup(user_name).await
    }
}

#[async_trait]
impl Authenticator for StoredUsers {
    async fn authenticate(&self, user_name: &str, password: &str) -> Option<twin::Role> {
        let user = match self.user(user_name).await {
            Ok(user) => user,
            Err(error) => {
                tracing::error!(
                    error = &error as &dyn std::error::Error,
                    "A user could not be looked up."
                );
                return None;
            }
        };
        let role = user.as_ref().map(|user| user.role);
        let hash = user.map(|user| PasswordHash::from_stored(user.password_hash));
        let is_right = verify_password(hash, Confidential::from(password.to_owned())).await;
        is_right.then_some(role).flatten().map(|role| match role {
            Role::Engineer => twin::Role::Engineer,
            Role::Operator => twin::Role::Operator,
            Role::Viewer => twin::Role::Viewer,
        })
    }
}
