//! Responses in an API's description: each has a text, as OpenAPI requires, and problems are
//! described once, in `components/responses`.

use std::collections::{BTreeMap, btree_map::Entry};

use axum::http::StatusCode;
use utoipa::openapi::{
    ContentBuilder, OpenApi, Ref, RefOr, Response, ResponseBuilder, Schema,
    path::{Operation, PathItem},
};

/// Describes responses that have no text by the text of their body's schema or, where there is
/// none, by the reason phrase of their status (`OK`).
pub fn describe_responses(description: &mut OpenApi) {
    let OpenApi { paths, components, .. } = description;
    let schemas = components.get_or_insert_default();
    for operation in paths.paths.values_mut().flat_map(operations_of) {
        for (status, response) in &mut operation.responses.responses {
            let RefOr::T(response) = response else { continue };
            if response.description.is_empty() {
                let text = body_text(response, &schemas.schemas).or_else(|| reason(status));
                response.description = text.unwrap_or_default();
            }
        }
    }
}

/// Returns the description of the schema that a response's body refers to.
fn body_text(response: &Response, schemas: &BTreeMap<String, RefOr<Schema>>) -> Option<String> {
    let RefOr::T(body) = response.content.values().next()? else { return None };
    let Some(RefOr::Ref(reference)) = &body.schema else { return None };
    let name = reference.ref_location.rsplit('/').next()?;
    // Each kind of schema has its own member for the text; their JSON has one.
    let schema = serde_json::to_value(schemas.get(name)?).ok()?;
    schema["description"].as_str().map(str::to_owned)
}

/// Adds to operations behind a session the refusal of those whose share is used up, unless they
/// describe that status themselves.
pub fn add_share_refusals(description: &mut OpenApi) {
    let schema = Ref::from_schema_name("Problem");
    let content = ContentBuilder::new().schema(Some(schema)).build();
    let refusal = ResponseBuilder::new()
        .description("Too many requests, downloads or live streams at once.")
        .content("application/problem+json", content)
        .build();
    for operation in description.paths.paths.values_mut().flat_map(operations_of) {
        let status = StatusCode::TOO_MANY_REQUESTS.as_str().to_owned();
        let responses = &mut operation.responses.responses;
        responses.entry(status).or_insert_with(|| RefOr::T(refusal.clone()));
    }
}

/// Replaces inline responses of client and server errors by references. The first response of a
/// status becomes the shared one, named after the status (`NotFound`); one that differs from it
/// stays inline.
pub fn share_problem_responses(description: &mut OpenApi) {
    let mut shared: BTreeMap<String, Response> = BTreeMap::new();
    for operation in description.paths.paths.values_mut().flat_map(operations_of) {
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

/// The operations of one path.
pub(super) fn operations_of(item: &mut PathItem) -> impl Iterator<Item = &mut Operation> {
    let PathItem { get, put, post, delete, patch, .. } = item;
    [get, put, post, delete, patch].into_iter().filter_map(Option::as_mut)
}

/// Returns the name of an error status, for example `NotFound`; none for other statuses.
fn problem_name(status: &str) -> Option<String> {
    let is_error = status.starts_with(['4', '5']);
    is_error.then(|| reason(status))?.map(|reason| reason.replace(' ', ""))
}

/// Returns the reason phrase of a status, for example `Not Found`.
fn reason(status: &str) -> Option<String> {
    let status: StatusCode = status.parse().ok()?;
    status.canonical_reason().map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn responses_have_the_text_of_their_body_or_of_their_status() {
        let body = |name: &str| {
            let schema = json!({ "$ref": format!("#/components/schemas/{name}") });
            json!({ "description": "", "content": { "application/json": { "schema": schema } } })
        };
        let responses = json!({
            "200": body("Policy"), "201": body("Unknown"), "202": { "description": "" },
            "204": { "description": "Removed" }
        });
        let mut description: OpenApi = serde_json::from_value(json!({
            "openapi": "3.1.0", "info": { "title": "t", "version": "1" },
            "paths": { "/a": { "get": { "responses": responses } } },
            "components": { "schemas": { "Policy": { "type": "object", "description": "A policy." } } }
        }))
        .expect("a description");
        describe_responses(&mut description);
        let described = serde_json::to_value(&description).expect("it serialises");
        let texts = ["200", "201", "202", "204"].map(|status| {
            described["paths"]["/a"]["get"]["responses"][status]["description"].clone()
        });
        assert_eq!(texts, ["A policy.", "Created", "Accepted", "Removed"].map(|text| json!(text)));
    }

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
