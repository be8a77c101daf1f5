//! Leak budgets of partners, and consent offers for fields.

use asi_model::OrganisationId;
use axum::{Json, extract::State};
use connector_state::queries;
use daemon::web::{ApiPath, ApiQuery, Problem};
use disclosure::{
    DisclosurePolicy, LeakBudget, LeakSummary, Measured, OpenField, Statement, leak_budget,
    leak_summary,
};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::{
    context::Api,
    paths::FieldPath,
    problems::Problems,
    roles::{Engineer, Viewer},
    view::{Page, RuleReference},
};
use crate::clock::now;

/// Leak budget of one partner over all its open fields.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PartnerLeaks {
    /// The organisation: a requester or a recipient.
    partner: OrganisationId,
    /// Fields, rates, precision and warnings.
    #[serde(flatten)]
    budget: LeakBudget,
}

/// Selection of a partner.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct LeakQuery {
    /// One organisation only.
    partner: Option<String>,
}

impl LeakQuery {
    fn means(&self, partner: &OrganisationId) -> bool {
        self.partner.as_ref().is_none_or(|wanted| partner.as_str() == wanted)
    }
}

/// Lists the leak budget of each partner: the sum over its open fields, and the conclusions that
/// they permit together.
#[utoipa::path(
    get,
    path = "/leak-budgets",
    tag = "policies",
    params(LeakQuery),
    responses((status = 200, body = Page<PartnerLeaks>), Problems)
)]
pub async fn list_leak_budgets(
    _: Viewer,
    State(api): State<Api>,
    ApiQuery(query): ApiQuery<LeakQuery>,
) -> Result<Json<Page<PartnerLeaks>>, Problem> {
    each(&api, query, |partner, fields| PartnerLeaks { partner, budget: leak_budget(fields) }).await
}

/// Evaluates the open fields of each partner.
async fn each<T: Send + 'static>(
    api: &Api,
    query: LeakQuery,
    view: impl Fn(OrganisationId, &[OpenField<'_>]) -> T + Send + 'static,
) -> Result<Json<Page<T>>, Problem> {
    let now = now();
    let read = api.coordinator.read(move |state| {
        let open = queries::open_fields(state, now, None).into_iter();
        open.filter(|(partner, _)| query.means(partner))
            .map(|(partner, fields)| view(partner.clone(), &fields))
            .collect()
    });
    Ok(Json(Page::whole(read.await?)))
}

/// Leak budget of one partner, in short.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PartnerSummary {
    /// The organisation: a requester or a recipient.
    partner: OrganisationId,
    /// Sums and numbers.
    #[serde(flatten)]
    summary: LeakSummary,
}

/// Summarises the leak budget of each partner: number of fields, most values and bits per hour, time
/// resolution, and number of conclusions.
#[utoipa::path(
    get,
    path = "/leak-budgets/summary",
    tag = "policies",
    params(LeakQuery),
    responses((status = 200, body = Page<PartnerSummary>), Problems)
)]
pub async fn summarise_leak_budgets(
    _: Viewer,
    State(api): State<Api>,
    ApiQuery(query): ApiQuery<LeakQuery>,
) -> Result<Json<Page<PartnerSummary>>, Problem> {
    each(&api, query, |partner, fields| PartnerSummary { partner, summary: leak_summary(fields) })
        .await
}

/// Disclosure that the consent for a field begins with.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ConsentOffer {
    /// Coarsening to begin with: that of the standing rules, and a minimum interval as long as the
    /// requested period.
    disclosure: DisclosurePolicy,
    /// Coarsening in words and as codes.
    #[serde(flatten)]
    statement: Statement,
    /// The rules behind it.
    rules: Vec<RuleReference>,
    /// The period that the partner asked for, in milliseconds.
    requested_interval_ms: Option<u64>,
    /// Values per hour at that period.
    values_per_hour: Option<f64>,
    /// Measured candidates and released values, while values flow.
    measured: Option<Measured>,
    /// Values per hour that "every change" would add to that, as far as it was measured.
    every_change_adds_per_hour: Option<f64>,
}

/// Shows the disclosure that a consent begins with, and what "every change" instead of the partner's
/// period would add.
#[utoipa::path(
    get,
    path = "/consent-offer",
    tag = "fields",
    params(FieldPath),
    responses((status = 200, body = ConsentOffer), Problems)
)]
pub async fn show_consent_offer(
    _: Engineer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
) -> Result<Json<ConsentOffer>, Problem> {
    let (key, now) = (path.into_key(), now());
    let offer = api
        .coordinator
        .read(move |state| {
            let field = state.field(&key)?;
            let (_, request) = state.request(&key.request)?;
            let requested_interval_ms = request
                .update_interval()
                .map(|interval| u64::try_from(interval.as_millis()).unwrap_or(u64::MAX));
            let asked = DisclosurePolicy {
                minimum_interval_ms: requested_interval_ms,
                ..DisclosurePolicy::default()
            };
            let ruled = queries::rule_offer(state, &key, now);
            let disclosure = ruled
                .as_ref()
                .map_or_else(|| asked.clone(), |ruled| ruled.disclosure.strictest(&asked));
            #[allow(clippy::cast_precision_loss)]
            let values_per_hour = requested_interval_ms.map(|ms| 3_600_000.0 / ms.max(1) as f64);
            let measured =
                Some(field.rate().measured(now)).filter(|_| field.decision().is_mapped());
            let every_change = measured.and_then(Measured::candidates_per_hour);
            Some(ConsentOffer {
                statement: Statement::of(&disclosure, field.definition().unit.as_deref()),
                rules: ruled
                    .map(|ruled| {
                        ruled
                            .rules
                            .into_iter()
                            .map(|(key, name)| RuleReference { key, name })
                            .collect()
                    })
                    .unwrap_or_default(),
                every_change_adds_per_hour: every_change
                    .map(|every| (every - values_per_hour.unwrap_or(every)).max(0.0)),
                disclosure,
                requested_interval_ms,
                values_per_hour,
                measured,
            })
        })
        .await?;
    offer.map(Json).ok_or_else(|| Problem::not_found("such field"))
}
