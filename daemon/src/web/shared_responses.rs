//! Sharing of problem responses in an API's description: each is described once, in
//! `components/responses`, and referred to by the operations.

use std::collections::{BTreeMap, btree_map::Entry};

use axum::http::StatusCode;
use utoipa::openapi::{
    OpenApi, Ref, RefOr, Response,
    path::{Operation, PathItem},
};

/// Replaces inline responses of client and server errors by references. The first response of a
/// status becomes the shared one, named after the status (`NotFound`); one that differs from it
/// stays inline.
pub fn share_problem_responses(description: &mut OpenApi) {
    let mut shared: BTreeMap<String, Response> = BTreeMap::new();
    for operation in description.paths.paths.values_mut().flat_map(operations) {
        for (status, response) in &mut operation.responses.responses {
            let (Some(name), RefOr::T(inline)) = (problem_name(status), &*response) else {
                continue;
            };
            let is_shared = match shared.entry(name.clone()) {
                Entry::Vacant(entry) => {
                    entry.insert(inline.clone());
                    true
                }
                Entry::Occupied(entry) => entry.get() == inline,
            };
            if is_shared {
                *response = RefOr::Ref(Ref::from_response_name(name));
            }
        }
    }
    let shared = shared.into_iter().map(|(name, response)| (name, RefOr::T(response)));
    description.components.get_or_insert_default().responses.extend(shared);
}

fn operations(item: &mut PathItem) -> impl Iterator<Item = &mut Operation> {
    let PathItem { get, put, post, delete, patch, .. } = item;
    [get, put, post, delete, patch].into_iter().filter_map(Option::as_mut)
}

/// Returns the name of an error status, for example `NotFound`; none for other statuses.
fn problem_name(status: &str) -> Option<String> {
    let status: StatusCode = status.parse().ok()?;
    let is_error = status.is_client_error() || status.is_server_error();
    is_error.then(|| status.canonical_reason())?.map(|reason| reason.replace(' ', ""))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn equal_problems_are_shared_and_others_stay_inline() {
        let operation = |not_found: &str| {
            let responses = json!({
                "200": { "description": "found" }, "404": { "description": not_found } });
            json!({ "get": { "responses": responses } })
        };
        let mut description: OpenApi = serde_json::from_value(json!({
            "openapi": "3.1.0", "info": { "title": "t", "version": "1" },
            "paths": { "/a": operation("gone"), "/b": operation("gone"), "/c": operation("else") }
        }))
        .expect("a description");
        share_problem_responses(&mut description);
        let shared = serde_json::to_value(&description).expect("it serialises");
        let answers: Vec<_> = ["/a", "/b", "/c"]
            .map(|path| shared["paths"][path]["get"]["responses"]["404"].clone())
            .into();
        let reference = json!({ "$ref": "#/components/responses/NotFound" });
        assert_eq!(answers, [reference.clone(), reference, json!({ "description": "else" })]);
        assert_eq!(
            shared["components"]["responses"],
            json!({ "NotFound": { "description": "gone" } })
        );
        assert_eq!(
            shared["paths"]["/a"]["get"]["responses"]["200"],
            json!({ "description": "found" })
        );
    }
}
