//! The past of requests: whether recipients that were added later see what had left before.

mod offer;

use asi_model::{OrganisationId, RequestKey};
use axum::{Json, extract::State, http::StatusCode};
use connector_state::{
    queries::past_offer,
    use_cases::decide_past::{self, PastDecisionError, PastDecisionRequest},
    writes::PastDecisionRow,
};
use daemon::web::{ApiJson, ApiQuery, Problem};
use ledger::Hash;
use offer::{PastOfferView, added_recipients};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::{
    context::Api,
    problems::Problems,
    roles::{Engineer, Viewer},
    view::Page,
};
use crate::store::StoredPastDecision;

/// Offers in one answer; the others are listed once those are decided.
const OFFERS_MAX: usize = 50;
/// Decisions per page, and most that may be asked for.
const PAGE: u32 = 50;

/// Lists the recipients that were added to requests later and could be shown what had left for
/// others before. Nothing of it is shown unless an engineer decides so.
///
/// A report can be shown where each of its fields is open to the recipient at present, and left
/// under a policy that satisfies the present one; it is shown whole and as it left, or not at all.
/// Reports whose values retention has emptied here are not offered.
#[utoipa::path(
    get,
    path = "/past-offers",
    tag = "past",
    responses((status = 200, body = Page<PastOfferView>), Problems)
)]
pub async fn list_past_offers(
    _: Viewer,
    State(api): State<Api>,
) -> Result<Json<Page<PastOfferView>>, Problem> {
    let mut session = api.store().await?;
    let epochs = session.past_reports().epochs().await?;
    // The coordinator may be busy, which is no reading of this page.
    let added = api.coordinator.read(move |state| added_recipients(state, &epochs));
    let added = session.aside(added).await?;
    let mut offers = Vec::new();
    for added in added {
        let (request, recipient) = (&added.request, &added.recipient);
        let past = session.past_reports().of(request, recipient, added.after).await?;
        let read = api.coordinator.read(move |state| (past_offer(state, &past), past));
        let (Some(offer), past) = session.aside(read).await? else { continue };
        let bodies = session.past_reports().bodies(&offer.newest).await?;
        offers.push(PastOfferView::new(&past, offer, &bodies));
        if offers.len() == OFFERS_MAX {
            break;
        }
    }
    Ok(Json(Page::whole(offers)))
}

/// Decision about the past, with the offer that the person saw.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PastDecisionBody {
    /// The request of the offer.
    request: RequestKey,
    /// The recipient of the offer.
    recipient_id: OrganisationId,
    /// True to show the recipient what is offered; false to leave it hidden.
    is_released: bool,
    /// `root` of the offer.
    root: String,
    /// Reason, for the record.
    reason: Option<String>,
}

impl PastDecisionBody {
    /// Returns the root of the offer that the person saw.
    pub(super) fn root(&self) -> Result<Hash, Problem> {
        let root = hex::decode(&self.root).ok().and_then(|root| root.try_into().ok());
        root.ok_or_else(|| Problem::bad_request("INVALID_ROOT", "The root is that of an offer."))
    }
}

/// A decision about the past that was stored.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct DecidedPast {
    /// True where reports of the past are shown to the recipient.
    is_released: bool,
    /// Number of reports that are shown.
    report_count: u64,
}

impl From<PastDecisionRow> for DecidedPast {
    fn from(row: PastDecisionRow) -> Self {
        Self { is_released: row.is_released, report_count: row.report_count }
    }
}

/// Decides whether a recipient that was added later sees what had left before. It is entered in the
/// recipient's ledger, and the platform is told. What was shown cannot be made unseen; a revocation
/// ends what is current, as for every recipient. Reports that the platform holds no longer do not
/// appear there.
#[utoipa::path(
    post,
    path = "/past-decisions",
    tag = "past",
    request_body = PastDecisionBody,
    responses((status = 201, body = DecidedPast), Problems)
)]
pub async fn decide_past(
    user: Engineer,
    State(api): State<Api>,
    ApiJson(body): ApiJson<PastDecisionBody>,
) -> Result<(StatusCode, Json<DecidedPast>), Problem> {
    let root = body.root()?;
    let (request, recipient) = (body.request, body.recipient_id);
    let key = (request.clone(), recipient.clone());
    let decided = api.coordinator.read(move |state| state.past().decided_through(&key.0, &key.1));
    let after = decided.await?.unwrap_or_default();
    let past = api.store().await?.past_reports().of(&request, &recipient, after).await?;
    let decision = PastDecisionRequest {
        past,
        is_released: body.is_released,
        root,
        reason: body.reason,
        decided_by: user.principal.user_name.clone(),
    };
    let decided = api
        .coordinator
        .execute(move |state, now| decide_past::decide_past(state, decision, now))
        .await?;
    let row = decided.map_err(problem)?;
    Ok((StatusCode::CREATED, Json(row.into())))
}

fn problem(error: PastDecisionError) -> Problem {
    let text = format!("{error}.");
    match error {
        PastDecisionError::NoPast => Problem::conflict("NO_PAST", text),
        PastDecisionError::OfferChanged => Problem::conflict("OFFER_CHANGED", text),
        PastDecisionError::NothingToShow => {
            Problem::unprocessable("NOTHING_TO_SHOW", text, Vec::new())
        }
    }
}

/// Page of decisions.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct PastDecisionsQuery {
    /// `nextCursor` of the page before.
    cursor: Option<i64>,
    /// Decisions per page, at most 50.
    limit: Option<u32>,
}

/// Lists the decisions about the past, newest first: who decided what, when and why.
#[utoipa::path(
    get,
    path = "/past-decisions",
    tag = "past",
    params(PastDecisionsQuery),
    responses((status = 200, body = Page<StoredPastDecision>), Problems)
)]
pub async fn list_past_decisions(
    _: Viewer,
    State(api): State<Api>,
    ApiQuery(query): ApiQuery<PastDecisionsQuery>,
) -> Result<Json<Page<StoredPastDecision>>, Problem> {
    let limit = query.limit.unwrap_or(PAGE).clamp(1, PAGE);
    let before = query.cursor.unwrap_or(i64::MAX);
    let items = api.store().await?.past_decisions().page(before, limit).await?;
    Ok(Json(Page::of(items, limit, |last| last.id.clone())))
}
