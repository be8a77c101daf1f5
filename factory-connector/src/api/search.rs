//! Search for variables of a server by words of their paths.

use std::time::Duration;

use asi_model::{DateTime, NodeId};
use axum::{Json, extract::State};
use daemon::web::{ApiPath, ApiQuery, Problem};
use serde::{Deserialize, Serialize};
use shop_floor::{BrowsedNode, ListedVariable, SourceId};
use utoipa::{IntoParams, ToSchema};

use super::{
    context::Api,
    problems::{Problems, shop_floor},
    roles::Viewer,
};

/// Found variables in an answer without a limit, and at most.
const RESULTS_DEFAULT: usize = 50;
const RESULTS_MAX: usize = 200;
/// Longest text, in bytes. Every listed variable is compared with it.
const TEXT_BYTES_MAX: usize = 256;
/// Time that a page waits for the list of a server that was not listed yet.
const LISTING_TIMEOUT: Duration = Duration::from_secs(8);

/// Search for variables.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct SearchQuery {
    /// Words that all occur in the variable's path, in any order, without regard to case. Or a node id, as other clients
    /// show it: `ns=3;s=Speed` or `nsu=<URI>;s=Speed`.
    text: String,
    /// At most so many, up to 200; 50 without it.
    limit: Option<usize>,
}

/// Variables that were found.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct FoundVariables {
    /// Variables with their browse paths, those whose own name fits first.
    items: Vec<BrowsedNode>,
    /// Number of all variables that fit.
    total: usize,
    /// False while the server's variables are still being listed (ask again), or if there are too
    /// many.
    is_complete: bool,
    /// Time at which the server's variables were listed.
    listed_at: Option<DateTime>,
}

/// Searches the connector's list of a server's variables for words of their paths.
#[utoipa::path(
    get,
    path = "/sources/{sourceId}/search",
    tag = "sources",
    params(("sourceId" = String, Path), SearchQuery),
    responses((status = 200, body = FoundVariables), Problems)
)]
pub async fn search_source(
    user: Viewer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<SourceId>,
    ApiQuery(query): ApiQuery<SearchQuery>,
) -> Result<Json<FoundVariables>, Problem> {
    let words: Vec<String> =
        query.text.to_lowercase().split_whitespace().map(str::to_owned).collect();
    if words.is_empty() || query.text.len() > TEXT_BYTES_MAX {
        return Err(Problem::bad_request(
            "NO_TEXT",
            "Give a text of 1 to 256 characters to look for.",
        ));
    }
    if let Ok(node) = query.text.trim().parse::<NodeId>() {
        let node = api.shop_floor.with_uri(&id, node).map_err(shop_floor)?;
        let _turn = api.machine_turns.take(&id, &user.principal.user_name).await?;
        let items = api.shop_floor.describe_many(&id, &[node]).await.map_err(shop_floor)?;
        let total = items.len();
        return Ok(Json(FoundVariables { items, total, is_complete: true, listed_at: None }));
    }
    let Some(listing) = api.catalog.list(&id, LISTING_TIMEOUT).await else {
        return Ok(Json(FoundVariables {
            items: Vec::new(),
            total: 0,
            is_complete: false,
            listed_at: None,
        }));
    };
    if let Some(problem) = listing.problem {
        return Err(Problem::unprocessable("SOURCE_REFUSED", format!("{problem}."), Vec::new()));
    }
    let most = query.limit.unwrap_or(RESULTS_DEFAULT).clamp(1, RESULTS_MAX);
    let list = std::sync::Arc::clone(&listing.list);
    let found = tokio::task::spawn_blocking(move || find(&list.variables, &words, most)).await;
    let (best, total) = found.map_err(|error| Problem::internal(&error))?;
    let ids: Vec<NodeId> = best.iter().map(|variable| variable.node_id.clone()).collect();
    let _turn = api.machine_turns.take(&id, &user.principal.user_name).await?;
    let mut items = api.shop_floor.describe_many(&id, &ids).await.map_err(shop_floor)?;
    for node in &mut items {
        node.browse_path = best
            .iter()
            .find(|variable| variable.node_id == node.node_id)
            .map(|variable| variable.browse_path.clone());
    }
    let (is_complete, listed_at) = (listing.list.is_complete, Some(listing.listed_at));
    Ok(Json(FoundVariables { items, total, is_complete, listed_at }))
}

/// Returns up to `most` variables in whose paths all words occur, those with all in their own name
/// first, and the number of all.
fn find(
    variables: &[ListedVariable],
    words: &[String],
    most: usize,
) -> (Vec<ListedVariable>, usize) {
    let (mut by_name, mut by_path) = (Vec::new(), Vec::new());
    for variable in variables {
        let name = variable.display_name.to_lowercase();
        if words.iter().all(|word| name.contains(word)) {
            by_name.push(variable);
        } else {
            let path = variable.browse_path.to_string().to_lowercase();
            if words.iter().all(|word| path.contains(word) || name.contains(word)) {
                by_path.push(variable);
            }
        }
    }
    let total = by_name.len() + by_path.len();
    (by_name.into_iter().chain(by_path).take(most).cloned().collect(), total)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_found_anywhere_in_a_path_and_names_come_first() {
        let variable = |path: &str| {
            let browse_path: shop_floor::BrowsePath =
                serde_json::from_value(path.split('/').collect::<Vec<_>>().into()).expect("a path");
            let display_name = path.rsplit('/').next().unwrap_or_default().to_owned();
            ListedVariable {
                node_id: NodeId::string("urn:x", path),
                display_name,
                browse_path,
                type_names: Vec::new(),
            }
        };
        let plant: Vec<_> =
            ["Press2/Axis/Speed", "Press1/Speed", "Press2/SpeedOfPress2"].map(variable).into();
        let found = |text: &str| {
            let words: Vec<String> = text.split(' ').map(str::to_owned).collect();
            let (found, total) = find(&plant, &words, 2);
            (
                found.iter().map(|variable| variable.browse_path.to_string()).collect::<Vec<_>>(),
                total,
            )
        };
        assert_eq!(found("speed press2").0, ["Press2/SpeedOfPress2", "Press2/Axis/Speed"]);
        assert_eq!(found("speed").1, 3);
        assert_eq!(found("speed torque").1, 0);
    }
}
