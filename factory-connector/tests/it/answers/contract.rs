//! Answers against the responses that the description of the API names.

use std::collections::{BTreeMap, BTreeSet};

use reqwest::StatusCode;
use serde_json::{Value, json};
use utoipa::openapi::OpenApi;

/// Responses of each operation, and what they refer to.
pub struct Contract {
    /// Responses by status, by operation id.
    responses: BTreeMap<String, Value>,
    components: Value,
}

impl Contract {
    pub fn new(description: &OpenApi) -> Self {
        let description = serde_json::to_value(description).expect("it serialises");
        let paths = description["paths"].as_object().expect("paths").values();
        let operations = paths.filter_map(Value::as_object).flat_map(|methods| methods.values());
        let responses = operations.map(|operation| {
            let id = operation["operationId"].as_str().expect("an id");
            (id.to_owned(), operation["responses"].clone())
        });
        Self { responses: responses.collect(), components: description["components"].clone() }
    }

    /// Returns the ids of all operations.
    pub fn operations(&self) -> BTreeSet<String> {
        self.responses.keys().cloned().collect()
    }

    /// Returns how an answer differs from those that the operation is described with.
    pub fn faults(&self, operation: &str, status: StatusCode, body: &Value) -> Vec<String> {
        let response = &self.responses[operation][status.as_str()];
        if !response.is_object() {
            return vec![format!("{operation}: {status} is not described: {body:#}")];
        }
        // Problems are references; they have one form, which other tests check.
        let schema = &response["content"]["application/json"]["schema"];
        if !schema.is_object() {
            return Vec::new();
        }
        let schema = json!({ "allOf": [schema], "components": self.components });
        let validator = jsonschema::draft202012::new(&schema).expect("a schema");
        validator
            .iter_errors(body)
            .map(|error| format!("{operation}: {}: {error}", error.instance_path()))
            .collect()
    }
}
