//! Standing rules: kept, looked at before they are enabled, applied, and undone.

use asi_model::FieldKey;
use axum::{Json, extract::State, http::HeaderMap};
use connector_state::{ConnectorState, DocumentError, queries, use_cases::rules};
use daemon::web::{ApiJson, ApiPath, ApiQuery, Problem};
use disclosure::{DocumentId, DocumentVersion, Rule, Versioned};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::{
    context::Api,
    documents,
    problems::{Problems, decision_problem},
    roles::{Engineer, Viewer},
    view::{Page, RuleOfferView},
};
use crate::{
    clock::now,
    store::{DocumentKind, RuleDecision},
};

/// Most fields listed in the preview of a rule.
const MATCHES_MAX: usize = 500;
/// Decisions per page, and most that may be asked for.
const PAGE: u32 = 100;

/// Lists the standing rules in their newest version.
#[utoipa::path(
    get,
    path = "/rules",
    tag = "policies",
    responses((status = 200, body = Page<Versioned<Rule>>), Problems)
)]
pub async fn list_rules(
    _: Viewer,
    State(api): State<Api>,
) -> Result<Json<Page<Versioned<Rule>>>, Problem> {
    Ok(Json(Page::whole(
        api.coordinator.read(|state| state.policies().rules().cloned().collect()).await?,
    )))
}

/// Stores a new version of a rule. Enabled, it decides about requests from now on; requests that are
/// there already are decided by `POST /rules/apply`. `If-Match` as for policies.
#[utoipa::path(
    put,
    path = "/rules/{ruleId}",
    tag = "policies",
    params(("ruleId" = String, Path), ("If-Match" = Option<String>, Header)),
    request_body = Rule,
    responses((status = 200, body = DocumentVersion), Problems)
)]
pub async fn put_rule(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<DocumentId>,
    headers: HeaderMap,
    ApiJson(rule): ApiJson<Rule>,
) -> Result<Json<DocumentVersion>, Problem> {
    let put = move |state: &mut ConnectorState, expected, by: &str, now| {
        rules::put_rule(state, &id, rule, expected, by, now)
    };
    documents::keep(&api, &user.principal.user_name, &headers, put).await.map(Json)
}

/// Lists every version of a rule, newest first.
#[utoipa::path(
    get,
    path = "/rules/{ruleId}/versions",
    tag = "policies",
    params(("ruleId" = String, Path)),
    responses((status = 200, body = Page<Versioned<Rule>>), Problems)
)]
pub async fn list_rule_versions(
    _: Viewer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<DocumentId>,
) -> Result<Json<Page<Versioned<Rule>>>, Problem> {
    documents::versions(&api, DocumentKind::Rule, &id).await
}

/// A field that a rule means.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RuleMatch {
    key: FieldKey,
    /// `PENDING`, `MAPPED` or `REFUSED`: only undecided fields would be decided.
    mapping_state: asi_model::messages::MappingState,
    /// Undecided, and no engineer has left it open: the rule would decide now.
    would_decide: bool,
    /// Decision that the rule offers.
    offer: RuleOfferView,
}

/// Matches of a draft of a rule.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RulePreview {
    /// All fields it means.
    count: usize,
    /// Number of these that it would decide now.
    would_decide_count: usize,
    /// At most 500 of them, those it would decide first.
    items: Vec<RuleMatch>,
}

/// Lists the fields that a draft of a rule matches. Changes nothing.
#[utoipa::path(
    post,
    path = "/rules/preview",
    tag = "policies",
    request_body = Rule,
    responses((status = 200, body = RulePreview), Problems)
)]
pub async fn preview_rule(
    _: Engineer,
    State(api): State<Api>,
    ApiJson(rule): ApiJson<Rule>,
) -> Result<Json<RulePreview>, Problem> {
    let faults = rule.faults();
    if !faults.is_empty() {
        return Err(documents::document_problem(DocumentError::Faults(faults)));
    }
    let preview = api
        .coordinator
        .read(move |state| {
            let mut items: Vec<RuleMatch> = queries::rule_preview(state, &rule, now())
                .into_iter()
                .filter_map(|(key, offer)| {
                    let field = state.field(&key)?;
                    Some(RuleMatch {
                        mapping_state: field.decision().mapping_state,
                        would_decide: field.is_undecided() && offer.decides(),
                        offer: RuleOfferView::new(&offer, field),
                        key,
                    })
                })
                .collect();
            let (count, deciding) =
                (items.len(), items.iter().filter(|item| item.would_decide).count());
            items.sort_by_key(|item| !item.would_decide);
            items.truncate(MATCHES_MAX);
            RulePreview { count, would_decide_count: deciding, items }
        })
        .await?;
    Ok(Json(preview))
}

/// Result of applying the rules.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Applied {
    /// Number of fields that were decided.
    decided_count: usize,
}

/// Applies the enabled rules to all undecided fields; what an engineer left open stays open.
#[utoipa::path(
    post,
    path = "/rules/apply",
    tag = "policies",
    responses((status = 200, body = Applied), Problems)
)]
pub async fn apply_rules(_: Engineer, State(api): State<Api>) -> Result<Json<Applied>, Problem> {
    let decided_count =
        api.coordinator.execute(|state, now| rules::apply_rules(state, None, now)).await?;
    Ok(Json(Applied { decided_count }))
}

/// Page of rule decisions.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct DecisionsQuery {
    /// `nextCursor` of the page before.
    #[param(value_type = Option<String>)]
    cursor: Option<i64>,
    /// Decisions per page, at most 100.
    limit: Option<u32>,
}

/// Lists the decisions that rules made, newest first.
#[utoipa::path(
    get,
    path = "/rule-decisions",
    tag = "policies",
    params(DecisionsQuery),
    responses((status = 200, body = Page<RuleDecision>), Problems)
)]
pub async fn list_rule_decisions(
    _: Viewer,
    State(api): State<Api>,
    ApiQuery(query): ApiQuery<DecisionsQuery>,
) -> Result<Json<Page<RuleDecision>>, Problem> {
    let limit = query.limit.unwrap_or(PAGE).clamp(1, PAGE);
    let items =
        api.store().await?.rule_decisions().page(query.cursor.unwrap_or(i64::MAX), limit).await?;
    Ok(Json(Page::of(items, limit, |last| last.id.clone())))
}

/// Undoes the decision of rules about a field: it is pending again, and left to the engineer. A
/// conflict if something else was decided since.
#[utoipa::path(
    post,
    path = "/rule-decisions/{id}/undo",
    tag = "policies",
    params(("id" = String, Path)),
    responses((status = 204, description = "Undone"), Problems)
)]
pub async fn undo_rule_decision(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<i64>,
) -> Result<axum::http::StatusCode, Problem> {
    let unknown = || Problem::not_found(format_args!("decision {id} of a rule"));
    let decision = api.store().await?.rule_decisions().lookup(id).await?;
    let decision = decision.ok_or_else(unknown)?;
    if decision.undone_at.is_some() {
        return Ok(axum::http::StatusCode::NO_CONTENT);
    }
    let by = user.principal.user_name.clone();
    let undone = api
        .coordinator
        .execute(move |state, now| {
            rules::undo_rule_decision(
                state,
                id,
                &decision.field,
                decision.consent_version,
                &by,
                now,
            )
        })
        .await?;
    undone.map_err(decision_problem)?;
    Ok(axum::http::StatusCode::NO_CONTENT)
}
