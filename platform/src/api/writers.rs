//! Data set writers of a factory, with received sequence numbers.

use asi_model::{DateTime, FactoryId, messages::GapCause};
use axum::{Json, extract::State};
use daemon::web::{ApiPath, ApiQuery, Problem, session::SignedIn};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    page::{Page, PageQuery},
    problems::ReadProblems,
};
use crate::{
    application::Application,
    principal::Principal,
    store::{SeenWriter, StoredGap, WritersWanted},
};

/// Writers of one page: each has up to thousands of numbers.
const WRITERS_PER_PAGE_MAX: u32 = 100;
/// Gaps shown per writer.
const GAPS_SHOWN_MAX: usize = 100;
/// Missing numbers shown per writer.
const MISSING_SHOWN_MAX: usize = 1000;

/// Received sequence numbers of a data set writer within an epoch.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct WriterView {
    data_set_writer_id: u16,
    epoch: u32,
    /// The network that its last report was about.
    operation_network_id: Option<String>,
    /// The request that its last report answered.
    dynamic_data_request_id: Option<String>,
    /// The highest sequence number held.
    through_sequence: Option<u32>,
    /// The lowest numbers below it that are missing, at most 1000.
    missing: Vec<u32>,
    /// Number of missing sequence numbers, listed or not.
    missing_count: u64,
    /// Number up to which some of the missing ones may be held, since there were too many holes to count
    /// each; absent where all are missing.
    coarse_through: Option<u32>,
    /// Numbers that the factory announced will never come: the newest gaps, at most 100.
    gaps: Vec<GapView>,
    /// Number of announced gaps, listed or not.
    gap_count: usize,
    /// Reports that arrived, repeats not counted.
    received: u64,
    /// Repeats that were discarded; for the factory's own organisation and administrators.
    duplicates: Option<u64>,
    /// Arrival of the last report.
    last_report_at: Option<DateTime>,
    /// Arrival of the last keep-alive; for others as long as they are recipients in effect.
    last_keep_alive_at: Option<DateTime>,
}

/// An announced gap.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct GapView {
    first_sequence: u32,
    last_sequence: u32,
    /// `COALESCED`, `EXPIRED`, `WITHDRAWN` or `REVOKED`.
    cause: GapCause,
    /// True where several gaps were merged into one, since they were too many; some of the numbers may be
    /// held.
    is_coarse: bool,
}

impl From<StoredGap> for GapView {
    fn from(gap: StoredGap) -> Self {
        let StoredGap { first_sequence, last_sequence, cause, is_coarse } = gap;
        Self { first_sequence, last_sequence, cause, is_coarse }
    }
}

impl From<SeenWriter> for WriterView {
    fn from(seen: SeenWriter) -> Self {
        let SeenWriter { writer: row, gaps, is_whole } = seen;
        let gap_count = gaps.len();
        let newest = gaps.into_iter().skip(gap_count.saturating_sub(GAPS_SHOWN_MAX));
        Self {
            data_set_writer_id: row.key.data_set_writer_id,
            epoch: row.key.epoch,
            operation_network_id: row.operation_network_id,
            dynamic_data_request_id: row.dynamic_data_request_id,
            through_sequence: row.sequences.through(),
            missing: row.sequences.missing_numbers().take(MISSING_SHOWN_MAX).collect(),
            missing_count: row.sequences.missing_count(),
            coarse_through: row.sequences.coarse_through(),
            gaps: newest.map(GapView::from).collect(),
            gap_count,
            received: row.received,
            duplicates: is_whole.then_some(row.duplicates),
            last_report_at: row.last_report_at,
            last_keep_alive_at: row.last_keep_alive_at,
        }
    }
}

/// Lists a factory's data set writers with received sequence numbers: all for its own organisation
/// and administrators; for recipients those whose reports they get, so that they can tell silence
/// from reports that are missing or were given up. Numbers, times and gaps are those of the reports
/// that were released to the viewer; what others are sent changes nothing in them. A page has at most 100.
#[utoipa::path(get, operation_id = "listWriters", path = "/factories/{factoryId}/writers", tag = "factories", security(("session" = [])),
    params(("factoryId" = String, Path), PageQuery), responses((status = 200, body = Page<WriterView>), ReadProblems))]
pub async fn list(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(id): ApiPath<FactoryId>,
    ApiQuery(page): ApiQuery<PageQuery>,
) -> Result<Json<Page<WriterView>>, Problem> {
    let scope = who.principal.scope();
    let mut work = app.store.read().await?;
    if work.factories().lookup(&scope, &id).await?.is_none() {
        return Err(Problem::not_found(format_args!("factory {id}")));
    }
    let wanted = WritersWanted {
        after: page.cursor.as_deref().and_then(writer_and_epoch),
        limit: page.limit().min(WRITERS_PER_PAGE_MAX),
    };
    let seen = work.writers().of_factory(&scope, &id, wanted).await?;
    let views = seen.into_iter().map(WriterView::from).collect();
    Ok(Json(Page::new(views, wanted.limit, |last: &WriterView| {
        format!("{}.{}", last.data_set_writer_id, last.epoch)
    })))
}

/// Reads a cursor; any other text starts at the first page.
fn writer_and_epoch(cursor: &str) -> Option<(u16, u32)> {
    let (writer, epoch) = cursor.split_once('.')?;
    Some((writer.parse().ok()?, epoch.parse().ok()?))
}
