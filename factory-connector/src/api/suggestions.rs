//! Suggestions of variables for a field.

use std::{collections::HashMap, time::Duration};

use asi_model::{DateTime, FieldKey, NodeId};
use axum::{Json, extract::State};
use connector_state::queries;
use daemon::web::{ApiPath, ApiQuery, Problem};
use futures::future::join_all;
use mapping_engine::{
    MappingInput, TypeName,
    mapping::LateValues,
    suggestion::{KnownVariable, PastDecision, RequestedField, Suggestion, suggest},
};
use serde::{Deserialize, Serialize};
use shop_floor::{BrowsePath, BrowsedNode, MonitorOptions, SourceId, SourceState};
use utoipa::{IntoParams, ToSchema};

use super::{
    context::Api,
    fields::MappingDraft,
    paths::FieldPath,
    problems::Problems,
    roles::{BeforeGate, Engineer},
    values::ShownValue,
};
use crate::catalog::Listing;

/// Suggestions in an answer without a limit, and at most.
const SUGGESTIONS_DEFAULT: usize = 10;
const SUGGESTIONS_MAX: usize = 100;
/// Number of variables whose server type, unit and value are looked up, once names have been
/// compared.
const DESCRIBED_MAX: usize = 200;
/// Time that a page waits for the lists of servers that were not listed yet.
const LISTING_TIMEOUT: Duration = Duration::from_secs(8);

/// Length of an answer.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct SuggestionsQuery {
    /// At most so many, up to 100; 10 without it.
    limit: Option<usize>,
}

/// Variables that might be meant, best first, and where they were looked for.
#[derive(Serialize, ToSchema)]
pub struct Suggestions {
    /// The variables; none is used before a person decides.
    items: Vec<SuggestedVariable>,
    /// The servers that were looked through.
    sources: Vec<SearchedSource>,
}

/// A variable that might be meant.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SuggestedVariable {
    /// The variable with its score and reasons.
    #[serde(flatten)]
    suggestion: Suggestion,
    /// Description by the server.
    description: Option<String>,
    /// The built-in type of its value.
    value_type: Option<TypeName>,
    /// Its unit, as people see it.
    unit: Option<String>,
    /// Its value at this moment.
    value: Option<ShownValue>,
    /// Mapping to decide with.
    mapping: MappingDraft,
}

/// A server that was looked through.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SearchedSource {
    source_id: SourceId,
    /// Number of its variables.
    variables: usize,
    /// False while the list is being made, or where the server has more than is listed: ask again,
    /// or search by hand.
    is_complete: bool,
    /// Time at which they were listed.
    listed_at: Option<DateTime>,
    /// Reason why they could not be listed.
    problem: Option<String>,
}

/// Suggests variables for a field, each with its reasons.
#[utoipa::path(
    get,
    path = "/suggestions",
    tag = "fields",
    params(FieldPath, SuggestionsQuery),
    responses((status = 200, body = Suggestions), Problems)
)]
pub async fn list_suggestions(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
    ApiQuery(query): ApiQuery<SuggestionsQuery>,
) -> Result<Json<Suggestions>, Problem> {
    let field: FieldKey = path.into_key();
    let known = api
        .coordinator
        .read(move |state| {
            Some((queries::requested_field(state, &field)?, queries::past_decisions(state)))
        })
        .await?;
    let (requested, past) = known.ok_or_else(|| Problem::not_found("such field"))?;
    let most = query.limit.unwrap_or(SUGGESTIONS_DEFAULT).clamp(1, SUGGESTIONS_MAX);
    let states = api.shop_floor.states();
    let searches = states.into_iter().map(|status| {
        let is_connected =
            matches!(status.state, SourceState::Connected | SourceState::Subscribing);
        let before_gate = BeforeGate::from(&user);
        search(&api, status.source_id, is_connected, (&requested, &past), before_gate)
    });
    let (mut sources, mut variables) = (Vec::new(), Vec::new());
    let mut details = HashMap::new();
    for (source, found) in join_all(searches).await {
        sources.push(source);
        for (known, detail) in found {
            details.insert((known.source_id.clone(), known.node_id.clone()), detail);
            variables.push(known);
        }
    }
    let items = suggest(&requested, &variables, &past, most)
        .into_iter()
        .filter_map(|suggestion| {
            let detail =
                details.remove(&(suggestion.source_id.clone(), suggestion.node_id.clone()))?;
            Some(suggested(suggestion, detail))
        })
        .collect();
    Ok(Json(Suggestions { items, sources }))
}

/// Details of a variable that suggestions do not depend on.
struct Detail {
    node: BrowsedNode,
    path: BrowsePath,
    value: Option<ShownValue>,
}

/// The variables of one server that might be meant, with type, unit and value.
async fn search(
    api: &Api,
    source_id: SourceId,
    is_connected: bool,
    (requested, past): (&RequestedField, &[PastDecision]),
    before_gate: BeforeGate,
) -> (SearchedSource, Vec<(KnownVariable, Detail)>) {
    let mut searched = SearchedSource {
        source_id: source_id.clone(),
        variables: 0,
        is_complete: false,
        listed_at: None,
        problem: (!is_connected).then(|| "The server is not connected.".to_owned()),
    };
    if !is_connected {
        return (searched, Vec::new());
    }
    let Some(Listing { list, listed_at, problem }) =
        api.catalog.list(&source_id, LISTING_TIMEOUT).await
    else {
        searched.problem = Some("The server's variables are still being listed.".to_owned());
        return (searched, Vec::new());
    };
    searched.variables = list.variables.len();
    searched.is_complete = list.is_complete && problem.is_none();
    searched.listed_at = Some(listed_at);
    searched.problem = problem;
    let (requested, past) = (requested.clone(), past.to_vec());
    let by_name = {
        let source_id = source_id.clone();
        // Comparing the names of a large server takes a while.
        tokio::task::spawn_blocking(move || {
            let variables: Vec<_> = list
                .variables
                .iter()
                .map(|variable| KnownVariable::listed(&source_id, variable))
                .collect();
            let best = suggest(&requested, &variables, &past, DESCRIBED_MAX);
            let positions: HashMap<&NodeId, usize> = variables
                .iter()
                .enumerate()
                .map(|(position, variable)| (&variable.node_id, position))
                .collect();
            best.iter()
                .filter_map(|found| {
                    let position = *positions.get(&found.node_id)?;
                    Some((
                        variables.get(position)?.clone(),
                        list.variables.get(position)?.browse_path.clone(),
                    ))
                })
                .collect::<Vec<_>>()
        })
    };
    let Ok(by_name) = by_name.await else { return (searched, Vec::new()) };
    match look_at(api, &source_id, by_name, before_gate).await {
        Ok(found) => (searched, found),
        Err(error) => {
            searched.problem = Some(format!("{error}."));
            (searched, Vec::new())
        }
    }
}

/// Type, unit and value of variables.
async fn look_at(
    api: &Api,
    source_id: &SourceId,
    variables: Vec<(KnownVariable, BrowsePath)>,
    before_gate: BeforeGate,
) -> Result<Vec<(KnownVariable, Detail)>, shop_floor::ShopFloorError> {
    if variables.is_empty() {
        return Ok(Vec::new());
    }
    let ids: Vec<NodeId> = variables.iter().map(|(variable, _)| variable.node_id.clone()).collect();
    let described = api.shop_floor.describe_many(source_id, &ids).await?;
    let values = api.shop_floor.read(source_id, &ids).await?;
    let mut described: HashMap<NodeId, BrowsedNode> =
        described.into_iter().map(|node| (node.node_id.clone(), node)).collect();
    let found = variables.into_iter().zip(values).filter_map(|((variable, path), value)| {
        let node = described.remove(&variable.node_id)?;
        let number = value.value.as_f64().filter(|_| !value.status.is_bad());
        let variable = KnownVariable { value: number, ..variable.described(&node) };
        Some((
            variable,
            Detail { node, path, value: Some(ShownValue::before_gate(&value, before_gate)) },
        ))
    });
    Ok(found.collect())
}

fn suggested(suggestion: Suggestion, detail: Detail) -> SuggestedVariable {
    let Detail { node, path, value } = detail;
    let value_type = node.built_in_type.map(TypeName);
    let input = MappingInput {
        name: "input".to_owned(),
        source_id: suggestion.source_id.clone(),
        node_id: suggestion.node_id.clone(),
        value_type,
        unit: node.unit.as_ref().and_then(|unit| unit.code.clone()),
        triggers: true,
        monitor: MonitorOptions { browse_path: Some(path), ..MonitorOptions::default() },
    };
    SuggestedVariable {
        mapping: MappingDraft {
            inputs: vec![input],
            steps: suggestion.steps.clone(),
            late_values: LateValues::default(),
        },
        description: node.description,
        value_type,
        unit: node.unit.map(|unit| unit.display_name),
        value,
        suggestion,
    }
}
