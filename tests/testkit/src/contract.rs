//! Answers against the responses that the description of an API names.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value, json};

/// Media types of bodies that have a schema.
const MEDIA_TYPES: [&str; 2] = ["application/json", "application/problem+json"];

/// Responses of each operation of an API, and what they refer to.
pub struct Contract {
    /// Responses by status, by operation id.
    responses: BTreeMap<String, Value>,
    components: Value,
}

impl Contract {
    /// Reads an OpenAPI document; each of its operations has an id.
    #[must_use]
    pub fn new(description: &Value) -> Self {
        let paths = description["paths"].as_object().expect("paths").values();
        let operations = paths.filter_map(Value::as_object).flat_map(|methods| methods.values());
        let responses = operations.map(|operation| {
            let id = operation["operationId"].as_str().expect("an id");
            (id.to_owned(), operation["responses"].clone())
        });
        Self { responses: responses.collect(), components: description["components"].clone() }
    }

    /// Returns the ids of all operations.
    #[must_use]
    pub fn operations(&self) -> BTreeSet<String> {
        self.responses.keys().cloned().collect()
    }

    /// Returns the differences of an answer from the response that the operation is described with.
    #[must_use]
    pub fn faults(&self, operation: &str, status: u16, body: &Value) -> Vec<String> {
        let response = self.resolved(&self.responses[operation][status.to_string()]);
        if !response.is_object() {
            return vec![format!("{operation}: {status} is not described: {body:#}")];
        }
        let schemas =
            MEDIA_TYPES.iter().map(|media_type| &response["content"][media_type]["schema"]);
        let Some(schema) = schemas.into_iter().find(|schema| schema.is_object()) else {
            return Vec::new();
        };
        let schema = json!({ "allOf": [schema], "components": self.components });
        let validator = jsonschema::draft202012::new(&schema).expect("a schema");
        validator
            .iter_errors(body)
            .map(|error| format!("{operation}: {}: {error}", error.instance_path()))
            .collect()
    }

    /// Returns a response itself where it is given by its name in the components.
    fn resolved<'c>(&'c self, response: &'c Value) -> &'c Value {
        let name = response["$ref"].as_str().and_then(|place| place.rsplit('/').next());
        name.map_or(response, |name| &self.components["responses"][name])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contract() -> Contract {
        let body = |media_type: &str, schema: Value| json!({ "content": { media_type: { "schema": schema } } });
        let problem = body("application/problem+json", json!({ "required": ["title"] }));
        let schema = json!({ "$ref": "#/components/schemas/Number" });
        Contract::new(&json!({
            "paths": { "/a": { "get": { "operationId": "show", "responses": {
                "200": body("application/json", schema), "204": {},
                "404": { "$ref": "#/components/responses/NotFound" } } } } },
            "components": {
                "schemas": { "Number": { "type": "integer" } },
                "responses": { "NotFound": problem }
            }
        }))
    }

    #[test]
    fn answers_are_compared_with_what_they_refer_to() {
        for (status, body, expected) in [
            (200, json!(1), 0),
            (200, json!("one"), 1),
            (204, Value::Null, 0),
            (404, json!({ "title": "Not Found" }), 0),
            (404, json!({}), 1),
            (500, json!({}), 1),
        ] {
            assert_eq!(contract().faults("show", status, &body).len(), expected, "{status} {body}");
        }
        assert_eq!(contract().operations(), BTreeSet::from(["show".to_owned()]));
    }
}
