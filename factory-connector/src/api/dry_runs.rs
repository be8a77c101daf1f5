//! Dry runs of mappings on live or recorded values.

use asi_model::{DataValue, DateTime};
use axum::{Json, extract::State};
use daemon::web::{ApiJson, ApiPath, Problem};
use mapping_engine::{DryRunSample, Mapping, MappingInput, Trace};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{
    context::Api,
    fields::{MappingDraft, mapping_of},
    paths::FieldPath,
    problems::{Problems, engine, shop_floor},
    roles::{BeforeGate, Engineer},
};
use crate::clock::now;

/// Runs in an answer without a limit, and at most.
const RUNS_DEFAULT: usize = 200;
const RUNS_MAX: usize = 2000;

/// Values that a dry run is made on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum DryRunValues {
    /// Present values of its variables; functions go on from the state of the published mapping.
    #[default]
    Live,
    /// Recorded values of its variables; functions begin without state.
    History,
}

/// A dry run to make.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct DryRunBody {
    pub(super) mapping: MappingDraft,
    /// `LIVE` (the default) or `HISTORY`.
    #[serde(default)]
    on: DryRunValues,
    /// Most runs in the answer, the last ones, up to 2000; 200 without it.
    limit: Option<usize>,
}

/// Result of a dry run.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct DryRun {
    /// The last runs with every intermediate value.
    #[serde(flatten)]
    trace: Trace,
    /// Number of all runs.
    runs_total: usize,
    /// Number of values that went in.
    values: usize,
    /// Time of the first value.
    from: Option<DateTime>,
    /// Time of the last value.
    to: Option<DateTime>,
    /// Inputs without recorded values: only variables that a published or shadow mapping uses are
    /// recorded.
    unrecorded: Vec<String>,
}

/// Runs a mapping on live or recorded values and shows every intermediate value. Nothing is changed,
/// and nothing leaves.
#[utoipa::path(
    post,
    path = "/trial",
    tag = "mappings",
    params(FieldPath),
    request_body = DryRunBody,
    responses((status = 200, body = DryRun), Problems)
)]
pub async fn dry_run_mapping(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
    ApiJson(body): ApiJson<DryRunBody>,
) -> Result<Json<DryRun>, Problem> {
    let field = path.into_key();
    let mapping = mapping_of(&api, &field, body.mapping).await?;
    let (samples, state) = match body.on {
        DryRunValues::Live => {
            let draft = mapping.clone();
            let state = api
                .coordinator
                .read(move |state| state.field(&field).and_then(|field| field.state_for(&draft)))
                .await?;
            (live_values(&api, &mapping).await?, state)
        }
        DryRunValues::History => {
            (api.engine.recorded(mapping.inputs.clone()).await.map_err(engine)?, None)
        }
    };
    let names = mapping.inputs.iter().map(|input| &input.name);
    let unrecorded = names
        .filter(|name| !samples.iter().any(|sample| sample.input == **name))
        .cloned()
        .collect::<Vec<_>>();
    let (values, from, to) = (
        samples.len(),
        samples.first().map(|sample| sample.at),
        samples.last().map(|sample| sample.at),
    );
    let trace = api.engine.dry_run(mapping, samples, state).await.map_err(engine)?;
    let mut trace = trace.seen_by(BeforeGate::from(&user));
    let runs_total = trace.runs.len();
    let most = body.limit.unwrap_or(RUNS_DEFAULT).clamp(1, RUNS_MAX);
    trace.runs.drain(..runs_total.saturating_sub(most));
    Ok(Json(DryRun { trace, runs_total, values, from, to, unrecorded }))
}

/// Reads the present values of a mapping's inputs.
async fn live_values(api: &Api, mapping: &Mapping) -> Result<Vec<DryRunSample>, Problem> {
    let at = now();
    let mut samples = Vec::new();
    for input in &mapping.inputs {
        let value = present_value(api, input).await?;
        samples.extend(value.map(|value| DryRunSample { input: input.name.clone(), at, value }));
    }
    Ok(samples)
}

/// Reads the present value of an input. What events make of one cannot be read: it is the newest value that a published or
/// shadow mapping got, if one uses it.
pub(super) async fn present_value(
    api: &Api,
    input: &MappingInput,
) -> Result<Option<DataValue>, Problem> {
    if input.monitor.events.is_some() {
        let heard = api.engine.recorded(vec![input.clone()]).await.map_err(engine)?;
        // What was recorded before this start is not present.
        let newest = heard.into_iter().next_back();
        let present = newest.filter(|sample| sample.at >= api.instance.started_at);
        return Ok(present.map(|sample| sample.value));
    }
    let node = std::slice::from_ref(&input.node_id);
    let read = api.shop_floor.read(&input.source_id, node).await.map_err(shop_floor)?;
    Ok(read.into_iter().next())
}
