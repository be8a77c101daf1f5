//! Entries about operations, which pages keep while they are offline and deliver later.

use asi_model::{DateTime, FieldKey, OperationId, OperationNetworkId};
use axum::{Json, extract::State};
use connector_state::{
    operator::{Action, EntryId, OperationKey, OperatorEntry},
    use_cases::enter::{EntryOutcome, enter_all},
};
use daemon::web::{ApiJson, ApiQuery, Problem};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use crate::{
    api::{context::Api, fields::Entered, problems::Problems, roles::Operator, view::Page},
    clock::now,
};

/// Most entries delivered at once.
const ENTRIES_MAX: usize = 500;
/// Entries listed of an operation.
const LISTED_MAX: usize = 200;

/// Operation whose entries are listed.
#[derive(Deserialize, IntoParams)]
#[serde(rename_all = "camelCase")]
#[into_params(parameter_in = Query)]
pub struct EntriesQuery {
    operation_network_id: OperationNetworkId,
    operation_id: OperationId,
}

/// Lists the last 200 entries about an operation, newest first.
#[utoipa::path(
    get,
    path = "/operator/entries",
    tag = "operator",
    params(EntriesQuery),
    responses((status = 200, body = Page<OperatorEntry>), Problems)
)]
pub async fn list_operator_entries(
    _: Operator,
    State(api): State<Api>,
    ApiQuery(query): ApiQuery<EntriesQuery>,
) -> Result<Json<Page<OperatorEntry>>, Problem> {
    let key = OperationKey {
        operation_network_id: query.operation_network_id,
        operation_id: query.operation_id,
    };
    let items = api
        .coordinator
        .read(move |state| {
            state.operation(&key)?;
            let newest = state
                .journal(&key)
                .map(|journal| journal.newest().take(LISTED_MAX).cloned().collect());
            Some(newest.unwrap_or_default())
        })
        .await?;
    items.map(|items| Json(Page::whole(items))).ok_or_else(|| Problem::not_found("such operation"))
}

/// Entries that a page has collected.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct EntryDelivery {
    /// Page's clock at the delivery. The entries' times are corrected by its difference to ours.
    sent_at: Option<DateTime>,
    /// Up to 500, in any order.
    #[schema(value_type = Vec<NewEntry>)]
    entries: Vec<serde_json::Value>,
}

/// Entries of a delivery that can be read, with the results of all.
pub(in crate::api) struct ReadDelivery {
    pub entries: Vec<OperatorEntry>,
    /// Position of each in the delivery.
    positions: Vec<usize>,
    results: Vec<EntryResult>,
}

impl EntryDelivery {
    /// Reads the entries.
    pub(in crate::api) fn read(
        self,
        made_by: &str,
        now: DateTime,
    ) -> Result<ReadDelivery, Problem> {
        if self.entries.len() > ENTRIES_MAX {
            return Err(Problem::bad_request(
                "TOO_MANY",
                "At most 500 entries are taken at once; deliver them in parts.",
            ));
        }
        let mut results = Vec::with_capacity(self.entries.len());
        let (mut positions, mut entries) = (Vec::new(), Vec::new());
        for json in self.entries {
            let entry_id = json["entryId"].as_str().unwrap_or_default().to_owned();
            match serde_json::from_value::<NewEntry>(json) {
                Ok(entry) => {
                    positions.push(results.len());
                    results.push(result(entry_id, EntryOutcome::Repeated));
                    entries.push(OperatorEntry {
                        entry_id: entry.entry_id,
                        operation: entry.operation,
                        made_at: corrected(entry.made_at, self.sent_at, now),
                        received_at: now,
                        made_by: made_by.to_owned(),
                        action: entry.action,
                    });
                }
                // One entry that cannot be read must not keep the others from ever being delivered.
                Err(error) => results.push(unreadable(entry_id, &error)),
            }
        }
        Ok(ReadDelivery { entries, positions, results })
    }
}

/// An entry of a page.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct NewEntry {
    /// Id made by the page: 1 to 64 letters, digits, `-` or `_`. An entry that comes again has no
    /// further effect.
    entry_id: EntryId,
    #[serde(flatten)]
    operation: OperationKey,
    /// Time of the entry by the page's clock.
    made_at: DateTime,
    #[serde(flatten)]
    action: Action,
}

/// Answer to one delivered entry: taken, known, or refused with the reason.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct EntryResult {
    entry_id: String,
    result: Acceptance,
    /// Code of the reason for `REFUSED`.
    code: Option<&'static str>,
    /// Reason for `REFUSED` in words, and what to do.
    message: Option<String>,
    /// Fields that got a value from it.
    fields: Vec<FieldResult>,
}

/// Acceptance of an entry; in each case the page must not deliver it again.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum Acceptance {
    /// Stored with this delivery.
    Taken,
    /// Stored with an earlier delivery.
    Repeated,
    /// Refused for good: it is never stored.
    Refused,
}

/// Result of an entry for one field.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct FieldResult {
    key: FieldKey,
    #[serde(flatten)]
    entered: Entered,
}

/// Accepts entries. They are stored together before the answer is sent; a page without an answer
/// delivers them again.
#[utoipa::path(
    post,
    path = "/operator/entries",
    tag = "operator",
    request_body = EntryDelivery,
    responses((status = 200, body = Page<EntryResult>), Problems)
)]
pub async fn deliver_operator_entries(
    user: Operator,
    State(api): State<Api>,
    ApiJson(delivery): ApiJson<EntryDelivery>,
) -> Result<Json<Page<EntryResult>>, Problem> {
    let now = DateTime::from_unix_micros(now().unix_micros());
    let ReadDelivery { entries, positions, mut results } =
        delivery.read(&user.principal.user_name, now)?;
    let outcomes = api.coordinator.execute(|state, now| enter_all(state, entries, now)).await?;
    for (position, outcome) in positions.into_iter().zip(outcomes) {
        let entry_id = std::mem::take(&mut results[position].entry_id);
        results[position] = result(entry_id, outcome);
    }
    Ok(Json(Page::whole(results)))
}

fn unreadable(entry_id: String, error: &serde_json::Error) -> EntryResult {
    EntryResult {
        entry_id,
        result: Acceptance::Refused,
        code: Some("UNREADABLE"),
        message: Some(format!("The entry cannot be read: {error}.")),
        fields: Vec::new(),
    }
}

/// Converts a time of the page's clock to ours: whole microseconds, never in the future.
fn corrected(made_at: DateTime, sent_at: Option<DateTime>, now: DateTime) -> DateTime {
    let sent_at = sent_at.unwrap_or(now);
    let age = sent_at.since(made_at);
    let micros = i64::try_from(age.as_micros()).unwrap_or(i64::MAX);
    DateTime::from_unix_micros(now.unix_micros().saturating_sub(micros))
}

fn result(entry_id: String, outcome: EntryOutcome) -> EntryResult {
    let (result, code, message, fields) = match outcome {
        EntryOutcome::Taken(fields) => (Acceptance::Taken, None, None, fields),
        EntryOutcome::Repeated => (Acceptance::Repeated, None, None, Vec::new()),
        EntryOutcome::Refused(fault) => {
            let mut message = format!("{fault}.");
            if let Some(first) = message.get_mut(..1) {
                first.make_ascii_uppercase();
            }
            (Acceptance::Refused, Some(fault.code()), Some(message), Vec::new())
        }
    };
    let fields = fields
        .into_iter()
        .map(|(key, outcome)| FieldResult { key, entered: outcome.into() })
        .collect();
    EntryResult { entry_id, result, code, message, fields }
}
