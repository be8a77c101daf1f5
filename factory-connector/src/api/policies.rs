//! Named policies, and the policies set for recipients.

use asi_model::OrganisationId;
use axum::{Json, extract::State, http::HeaderMap};
use connector_state::{ConnectorState, RecipientPolicy, queries, use_cases::policies};
use daemon::web::{ApiJson, ApiPath, Problem};
use disclosure::{DocumentId, DocumentVersion, NamedPolicy, Statement, StatementPart, Versioned};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{
    context::Api,
    documents,
    problems::Problems,
    roles::{Engineer, Viewer},
    view::Page,
};
use crate::store::DocumentKind;

/// Most fields listed as using a policy.
const USES_MAX: usize = 500;

/// A named policy and its uses.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PolicyView {
    /// The newest version.
    #[serde(flatten)]
    policy: Versioned<NamedPolicy>,
    /// Statement that partners read.
    #[serde(flatten)]
    statement: Statement,
    /// Number of mapped fields that name it.
    field_count: usize,
    /// Recipients that it is set for.
    recipients: Vec<OrganisationId>,
}

fn view(state: &ConnectorState, policy: Versioned<NamedPolicy>) -> PolicyView {
    let is_policy = |id: Option<&DocumentId>| id == Some(&policy.key.id);
    PolicyView {
        statement: Statement::of(&policy.document.disclosure, None),
        field_count: state
            .fields()
            .iter()
            .filter(|field| {
                field.decision().is_mapped() && is_policy(field.decision().basis.policy_id.as_ref())
            })
            .count(),
        recipients: state
            .policies()
            .recipients()
            .filter(|(_, set)| is_policy(set.policy_id.as_ref()))
            .map(|(recipient, _)| recipient.clone())
            .collect(),
        policy,
    }
}

/// Lists the named policies in their newest version, retired ones included.
#[utoipa::path(
    get,
    path = "/policies",
    tag = "policies",
    responses((status = 200, body = Page<PolicyView>), Problems)
)]
pub async fn list_policies(
    _: Viewer,
    State(api): State<Api>,
) -> Result<Json<Page<PolicyView>>, Problem> {
    let items = api
        .coordinator
        .read(|state| state.policies().named().cloned().map(|policy| view(state, policy)).collect())
        .await?;
    Ok(Json(Page::whole(items)))
}

/// Stores a new version of a named policy. Values of fields and recipients with it change at once;
/// each change is a consent in the ledger, and the partner is notified. Refused (`OVER_CAP`) where a
/// cap would be exceeded by that. `If-Match` with the version read (`"0"` for a new one) keeps two
/// engineers from overwriting each other.
#[utoipa::path(
    put,
    path = "/policies/{policyId}",
    tag = "policies",
    params(("policyId" = String, Path), ("If-Match" = Option<String>, Header)),
    request_body = NamedPolicy,
    responses((status = 200, body = DocumentVersion), Problems)
)]
pub async fn put_policy(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<DocumentId>,
    headers: HeaderMap,
    ApiJson(policy): ApiJson<NamedPolicy>,
) -> Result<Json<DocumentVersion>, Problem> {
    let put = move |state: &mut ConnectorState, expected, by: &str, now| {
        policies::put_policy(state, &id, policy, expected, by, now)
    };
    documents::keep(&api, &user.principal.user_name, &headers, put).await.map(Json)
}

/// Lists every version of a named policy, newest first.
#[utoipa::path(
    get,
    path = "/policies/{policyId}/versions",
    tag = "policies",
    params(("policyId" = String, Path)),
    responses((status = 200, body = Page<Versioned<NamedPolicy>>), Problems)
)]
pub async fn list_policy_versions(
    _: Viewer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<DocumentId>,
) -> Result<Json<Page<Versioned<NamedPolicy>>>, Problem> {
    documents::versions(&api, DocumentKind::Policy, &id).await
}

/// Effect of a changed policy on a field.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PolicyUse {
    key: asi_model::FieldKey,
    /// Statement that the partner reads now.
    #[serde(flatten)]
    statement: Statement,
    /// Statement with the draft, in words.
    statement_then: String,
    /// Statement with the draft, as codes with parameters.
    statement_then_parts: Vec<StatementPart>,
}

/// Lists the mapped fields that a draft of a named policy would change, at most 500. Changes nothing.
#[utoipa::path(
    post,
    path = "/policies/{policyId}/preview",
    tag = "policies",
    params(("policyId" = String, Path)),
    request_body = NamedPolicy,
    responses((status = 200, body = Page<PolicyUse>), Problems)
)]
pub async fn preview_policy(
    _: Engineer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<DocumentId>,
    ApiJson(draft): ApiJson<NamedPolicy>,
) -> Result<Json<Page<PolicyUse>>, Problem> {
    let uses = api
        .coordinator
        .read(move |state| {
            let mut uses: Vec<PolicyUse> = queries::policy_changes(state, &id, &draft.disclosure)
                .into_iter()
                .map(|(key, now, then, unit)| {
                    let Statement { statement, statement_parts } =
                        Statement::of(&then, unit.as_deref());
                    PolicyUse {
                        key,
                        statement: Statement::of(&now, unit.as_deref()),
                        statement_then: statement,
                        statement_then_parts: statement_parts,
                    }
                })
                .collect();
            uses.sort_by(|left, right| left.key.cmp(&right.key));
            uses.truncate(USES_MAX);
            uses
        })
        .await?;
    Ok(Json(Page::whole(uses)))
}

/// A recipient and the policy set for it.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RecipientView {
    recipient: OrganisationId,
    /// Number of mapped fields whose values it gets.
    field_count: usize,
    /// Policy for all of them.
    set: Option<RecipientPolicy>,
}

/// Lists every organisation that may get values, with the policy set for it.
#[utoipa::path(
    get,
    path = "/recipients",
    tag = "policies",
    responses((status = 200, body = Page<RecipientView>), Problems)
)]
pub async fn list_recipients(
    _: Viewer,
    State(api): State<Api>,
) -> Result<Json<Page<RecipientView>>, Problem> {
    let items = api
        .coordinator
        .read(|state| {
            let mut found: std::collections::BTreeMap<OrganisationId, usize> = state
                .policies()
                .recipients()
                .map(|(recipient, _)| (recipient.clone(), 0))
                .collect();
            for message in state.networks().active() {
                for (key, _, request) in message.operation_network.requests() {
                    let count = state
                        .fields_of(&key)
                        .filter(|(_, field)| field.decision().is_mapped())
                        .count();
                    for recipient in &request.recipient_list {
                        *found.entry(recipient.clone()).or_default() += count;
                    }
                }
            }
            let set: std::collections::BTreeMap<_, _> = state.policies().recipients().collect();
            found
                .into_iter()
                .map(|(recipient, field_count)| RecipientView {
                    set: set.get(&recipient).copied().cloned(),
                    recipient,
                    field_count,
                })
                .collect()
        })
        .await?;
    Ok(Json(Page::whole(items)))
}

/// Policy for everything that a recipient gets.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct RecipientBody {
    /// Id of a named policy; null removes the present one.
    pub(super) policy_id: Option<DocumentId>,
}

/// Version of a recipient's policy.
#[derive(Serialize, ToSchema)]
pub struct RecipientVersion {
    /// Number of changes so far.
    version: u32,
}

/// Sets a named policy for everything that a recipient gets. All recipients of a request get the same
/// values, so the strictest of the field's and of all its recipients' policies applies, at once.
/// Refused (`OVER_CAP`) where a cap would be exceeded by that.
#[utoipa::path(
    put,
    path = "/recipients/{recipient}/policy",
    tag = "policies",
    params(("recipient" = String, Path), ("If-Match" = Option<String>, Header)),
    request_body = RecipientBody,
    responses((status = 200, body = RecipientVersion), Problems)
)]
pub async fn put_recipient_policy(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(recipient): ApiPath<OrganisationId>,
    headers: HeaderMap,
    ApiJson(body): ApiJson<RecipientBody>,
) -> Result<Json<RecipientVersion>, Problem> {
    let set = move |state: &mut ConnectorState, expected, by: &str, now| {
        policies::set_recipient_policy(state, &recipient, body.policy_id, expected, by, now)
    };
    let version = documents::keep(&api, &user.principal.user_name, &headers, set).await?;
    Ok(Json(RecipientVersion { version }))
}
