//! Trying a mapping before it is published.

use asi_model::DateTime;
use axum::{Json, extract::State};
use daemon::web::{ApiJson, ApiPath, Problem};
use mapping_engine::{DryRunSample, Mapping, Trace};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{
    Api,
    fields::{MappingDraft, mapping_of},
    paths::FieldPath,
    problems::{Problems, engine, shop_floor},
    roles::Engineer,
};
use crate::desk::now;

/// Runs without being told how many, and at most.
const RUNS_DEFAULT: usize = 200;
const RUNS_MAX: usize = 2000;

/// What to run a mapping on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum TrialOn {
    /// The values that its variables have now; functions go on from what the published mapping
    /// remembers.
    #[default]
    Live,
    /// The values that its variables had lately, as far as they are recorded; functions start
    /// afresh.
    History,
}

/// A mapping to try.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct TrialBody {
    /// The mapping.
    mapping: MappingDraft,
    /// What to run it on: `LIVE` (the default) or `HISTORY`.
    #[serde(default)]
    on: TrialOn,
    /// The last so many runs are shown, up to 2000; 200 without it.
    limit: Option<usize>,
}

/// What became of a trial.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Trial {
    /// Every run with every intermediate value; the last ones.
    #[serde(flatten)]
    trace: Trace,
    /// How many runs there were.
    runs_total: usize,
    /// How many values went in.
    values: usize,
    /// When the first value came.
    from: Option<DateTime>,
    /// When the last value came.
    to: Option<DateTime>,
    /// Inputs of which nothing is recorded: only variables that a mapping at work (or on trial)
    /// uses are.
    unrecorded: Vec<String>,
}

/// Runs a mapping on live or recorded values and shows every intermediate value; nothing is changed
/// and nothing leaves.
#[utoipa::path(
    post,
    path = "/trial",
    tag = "mappings",
    params(FieldPath),
    request_body = TrialBody,
    responses((status = 200, body = Trial), Problems)
)]
pub async fn dry_run_mapping(
    _: Engineer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
    ApiJson(body): ApiJson<TrialBody>,
) -> Result<Json<Trial>, Problem> {
    let field = path.into_key();
    let mapping = mapping_of(&api, &field, body.mapping).await?;
    let (samples, state) = match body.on {
        TrialOn::Live => {
            let draft = mapping.clone();
            let state = api
                .desk
                .read(move |books| books.field(&field).and_then(|field| field.state_for(&draft)))
                .await?;
            (live_values(&api, &mapping).await?, state)
        }
        TrialOn::History => {
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
    let mut trace = api.engine.dry_run(mapping, samples, state).await.map_err(engine)?;
    let runs_total = trace.runs.len();
    let most = body.limit.unwrap_or(RUNS_DEFAULT).clamp(1, RUNS_MAX);
    trace.runs.drain(..runs_total.saturating_sub(most));
    Ok(Json(Trial { trace, runs_total, values, from, to, unrecorded }))
}

/// The present values of a mapping's inputs.
async fn live_values(api: &Api, mapping: &Mapping) -> Result<Vec<DryRunSample>, Problem> {
    let at = now();
    let mut samples = Vec::new();
    for input in &mapping.inputs {
        let node = std::slice::from_ref(&input.node_id);
        let read = api.shop_floor.read(&input.source_id, node).await.map_err(shop_floor)?;
        samples.extend(read.into_iter().map(|value| DryRunSample {
            input: input.name.clone(),
            at,
            value,
        }));
    }
    Ok(samples)
}
