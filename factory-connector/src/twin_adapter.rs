//! Adapters of the twin: authentication of its users, writes and decisions of OPC UA clients, and the
//! end of sessions whose users changed.

mod user_watch;

use std::{
    net::{IpAddr, Ipv6Addr},
    sync::{Arc, OnceLock},
};

use asi_model::{
    DataValue, DateTime, FieldKey, StatusCode,
    messages::{MappingState, ValueSource},
};
use async_trait::async_trait;
use connector_state::{
    ConnectorState,
    use_cases::decide::{DecisionCommand, DecisionRequest, decide},
};
use daemon::{
    Confidential,
    web::session::{PasswordFieldError, Sessions, check_password_field},
};
use disclosure::{DecisionBasis, GateOutcome};
use twin::{Authenticator, FieldWriter, SignInRefusal, TwinDecision, TwinUser};
pub use user_watch::UserWatch;

use crate::{
    api::StoredAccounts,
    coordinator::{CoordinatorError, CoordinatorHandle, WriteOutcome},
    store::Role,
};

/// Writes and decisions of OPC UA clients, passed on to the coordinator.
pub struct CoordinatorWriter(pub CoordinatorHandle);

#[async_trait]
impl FieldWriter for CoordinatorWriter {
    async fn write(&self, field: &FieldKey, value: DataValue, user: &TwinUser) -> StatusCode {
        match self.0.write_value(field.clone(), ValueSource::External, value).await {
            Ok(WriteOutcome::Accepted(outcome)) => {
                tracing::info!(%field, user.name = %user.name, "An OPC UA client wrote a field.");
                status_of(outcome)
            }
            Ok(WriteOutcome::Rejected(status)) => status,
            Err(error) => failure(error),
        }
    }

    async fn decide(
        &self,
        field: &FieldKey,
        decision: TwinDecision,
        user: &TwinUser,
    ) -> StatusCode {
        let (key, by) = (field.clone(), user.name.to_string());
        let decided = self.0.execute(move |state, now: DateTime| {
            let Some(request) = decision_request(state, &key, decision, by) else {
                return Err(None);
            };
            decide(state, &key, request, now).map_err(Some)
        });
        match decided.await {
            Ok(Ok(())) => StatusCode::GOOD,
            Ok(Err(_)) => StatusCode::BAD_INVALID_ARGUMENT,
            Err(error) => failure(error),
        }
    }
}

/// Returns the decision that an OPC UA client asks for: it opens a field to OPC UA clients, and the
/// policy stays as it was set on the page. `None` where no consent is in force: a client cannot tell
/// a policy, and that of a former consent was chosen for other recipients, for another purpose, or
/// was taken back. It is a suggestion for the page only.
fn decision_request(
    state: &ConnectorState,
    key: &FieldKey,
    decision: TwinDecision,
    decided_by: String,
) -> Option<DecisionRequest> {
    let present = state.field(key)?.decision();
    let policy_id = present.named_policy().cloned();
    let command = match decision.mapping_state {
        MappingState::Pending => DecisionCommand::LeavePending,
        MappingState::Refused => DecisionCommand::Refuse,
        MappingState::Mapped if !present.is_mapped() => return None,
        MappingState::Mapped => {
            let (value_source, policy) = (ValueSource::External, (*present.policy).clone());
            DecisionCommand::Map { value_source, mapping: None, policy }
        }
    };
    let policy_id = policy_id.filter(|_| decision.mapping_state == MappingState::Mapped);
    let basis = DecisionBasis { policy_id, ..DecisionBasis::default() };
    Some(DecisionRequest { command, reason: decision.reason, decided_by, basis, preview: None })
}

const fn status_of(outcome: GateOutcome) -> StatusCode {
    match outcome {
        // The client learns that partners see less than it wrote.
        GateOutcome::Disclosed { is_coarsened: true }
        | GateOutcome::Unchanged { is_coarsened: true } => StatusCode::GOOD_CLAMPED,
        GateOutcome::Disclosed { .. } | GateOutcome::Unchanged { .. } => StatusCode::GOOD,
        GateOutcome::Withheld { .. } => StatusCode::GOOD_COMPLETES_ASYNCHRONOUSLY,
        // Accepted, but never disclosed: the policy withholds the present state.
        GateOutcome::Suppressed => StatusCode::GOOD_CLAMPED,
    }
}

const fn failure(error: CoordinatorError) -> StatusCode {
    match error {
        CoordinatorError::NotWritten => StatusCode::BAD_RESOURCE_UNAVAILABLE,
        CoordinatorError::Stopped => StatusCode::BAD_SHUTDOWN,
    }
}

/// Authenticates users as the pages do: their passwords and codes, in the same counts of attempts.
#[derive(Clone, Default)]
pub struct StoredUsers {
    /// The sign-in of the pages, which are made after the twin.
    pages: Arc<OnceLock<Sessions<StoredAccounts>>>,
}

impl StoredUsers {
    /// Sets the sign-in of the pages. Before, nobody is let in; later calls change nothing.
    pub fn sign_in_as_on(&self, pages: Sessions<StoredAccounts>) {
        self.pages.get_or_init(|| pages);
    }
}

#[async_trait]
impl Authenticator for StoredUsers {
    async fn authenticate(
        &self,
        user_name: &str,
        password: &str,
        client: Option<IpAddr>,
    ) -> Result<twin::Role, SignInRefusal> {
        let pages = self.pages.get().ok_or(SignInRefusal::NotChecked)?;
        // A connection that the twin opened has no other place to count for.
        let client = client.unwrap_or(IpAddr::V6(Ipv6Addr::UNSPECIFIED));
        let field = Confidential::from(password.to_owned());
        match check_password_field(pages, client, user_name, field).await {
            Ok(principal) => Ok(match principal.role {
                Role::Engineer => twin::Role::Engineer,
                Role::Operator => twin::Role::Operator,
                Role::Viewer => twin::Role::Viewer,
            }),
            Err(PasswordFieldError::Wrong) => Err(SignInRefusal::WrongCredentials),
            Err(PasswordFieldError::PasskeyAlone) => Err(SignInRefusal::SecondFactorImpossible),
            Err(PasswordFieldError::Throttled) => Err(SignInRefusal::TooManyAttempts),
            Err(PasswordFieldError::NotChecked) => Err(SignInRefusal::NotChecked),
        }
    }
}
