//! The history of reports.

use access_log::AccessKind;
use asi_model::{DynamicDataRequestId, OperationNetworkId};
use axum::{Json, extract::State};
use daemon::web::{ApiQuery, Problem, session::SignedIn};
use serde::Deserialize;
use utoipa::IntoParams;

use super::{
    page::{Page, limit},
    problems::ReadProblems,
};
use crate::{
    application::Application,
    principal::Principal,
    store::{Report, ReportCursor, ReportQuery},
};

/// Filter and page of the history.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct ReportsQuery {
    /// Restriction to this network.
    network: Option<OperationNetworkId>,
    /// Restriction to this request.
    request: Option<DynamicDataRequestId>,
    /// The report after which those listed arrived; `nextCursor` of the page before.
    #[param(value_type = Option<String>)]
    after: Option<ReportCursor>,
    /// Most entries wanted, 1 to 1000.
    limit: Option<u32>,
    /// The newest entries instead of the oldest; still in the order of their arrival, and without a
    /// next page.
    newest: Option<bool>,
}

/// Most newest entries that count as looked at; a chart shows no more.
const LOOKED_MAX: u32 = 300;

/// Lists the reports that their factories released to the viewer, in the order of their arrival. The
/// factories can see that: as looked at where `newest` is set and at most 300 are wanted, else as
/// exported.
#[utoipa::path(get, operation_id = "listReports", path = "/reports", tag = "reports", security(("session" = [])), params(ReportsQuery),
    responses((status = 200, body = Page<Report>), ReadProblems))]
pub async fn list(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiQuery(query): ApiQuery<ReportsQuery>,
) -> Result<Json<Page<Report>>, Problem> {
    let limit = limit(query.limit);
    let is_newest = query.newest.unwrap_or(false);
    let wanted = ReportQuery {
        network: query.network,
        request: query.request,
        after: query.after,
        limit,
        is_newest,
    };
    let reports = app.store.read().await?.reports().list(&who.principal.scope(), &wanted).await?;
    // Pages show the newest; who reads page after page from the oldest on, or more at once than
    // anybody looks at, takes the history along.
    let is_look = is_newest && limit <= LOOKED_MAX;
    let kind = if is_look { AccessKind::Looked } else { AccessKind::Exported };
    let reader = who.principal.reader();
    let reports = app.accesses.disclose(reader.as_ref(), kind, reports).await?;
    if is_newest {
        return Ok(Json(Page::whole(reports)));
    }
    Ok(Json(Page::new(reports, limit, |report| ReportCursor::from(report).to_string())))
}
