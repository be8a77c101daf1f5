//! Answers and live events against the responses that the description of an API names.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value, json};

use crate::event_stream::Event;

/// Media types of bodies that have a schema.
const MEDIA_TYPES: [&str; 2] = ["application/json", "application/problem+json"];
/// Media type of server-sent events, whose schema describes one event.
const EVENT_STREAM: &str = "text/event-stream";

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
        self.differences(schema, body)
            .into_iter()
            .map(|difference| format!("{operation}: {difference}"))
            .collect()
    }

    /// Returns the differences of an event from those that the operation's stream is described
    /// with, as objects of `event` and `data`.
    #[must_use]
    pub fn event_faults(&self, operation: &str, event: &Event) -> Vec<String> {
        let kind = self.kinds(operation).into_iter().find(|kind| name_of(kind) == event.name);
        let Some(kind) = kind else {
            return vec![format!("{operation}: the event {} is not described", event.name)];
        };
        self.differences(kind, &json!({ "event": event.name, "data": event.data }))
            .into_iter()
            .map(|difference| format!("{operation}: {}: {difference}", event.name))
            .collect()
    }

    /// Returns the names of all events that the operation's stream is described with.
    #[must_use]
    pub fn events(&self, operation: &str) -> BTreeSet<String> {
        self.kinds(operation).into_iter().map(|kind| name_of(kind).to_owned()).collect()
    }

    /// Returns the schemas of a stream's events, one of each name.
    fn kinds(&self, operation: &str) -> Vec<&Value> {
        let response = self.resolved(&self.responses[operation]["200"]);
        let reference = response["content"][EVENT_STREAM]["schema"]["$ref"].as_str();
        let schema = reference.and_then(|place| place.rsplit('/').next()).expect("a named schema");
        let kinds = self.components["schemas"][schema]["oneOf"].as_array();
        kinds.expect("the events of the stream").iter().collect()
    }

    /// Returns the differences of a value from a schema.
    fn differences(&self, schema: &Value, value: &Value) -> Vec<String> {
        let schema = json!({ "allOf": [schema], "components": self.components });
        let validator = jsonschema::draft202012::new(&schema).expect("a schema");
        validator
            .iter_errors(value)
            .map(|error| format!("{}: {error}", error.instance_path()))
            .collect()
    }

    /// Returns a response itself where it is given by its name in the components.
    fn resolved<'c>(&'c self, response: &'c Value) -> &'c Value {
        let name = response["$ref"].as_str().and_then(|place| place.rsplit('/').next());
        name.map_or(response, |name| &self.components["responses"][name])
    }
}

/// Returns the name of the events that a schema describes.
fn name_of(kind: &Value) -> &str {
    kind["properties"]["event"]["enum"][0].as_str().expect("the event's name")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contract() -> Contract {
        let body = |media_type: &str, schema: Value| json!({ "content": { media_type: { "schema": schema } } });
        let problem = body("application/problem+json", json!({ "required": ["title"] }));
        let schema = |name: &str| json!({ "$ref": format!("#/components/schemas/{name}") });
        let kind = |name: &str, data: Value| json!({ "properties": { "event": { "enum": [name] }, "data": data } });
        Contract::new(&json!({
            "paths": {
                "/a": { "get": { "operationId": "show", "responses": {
                    "200": body("application/json", schema("Number")), "204": {},
                    "404": { "$ref": "#/components/responses/NotFound" } } } },
                "/live": { "get": { "operationId": "stream", "responses": {
                    "200": body("text/event-stream", schema("LiveEvent")) } } } },
            "components": {
                "schemas": {
                    "Number": { "type": "integer" },
                    "LiveEvent": { "oneOf": [kind("value", schema("Number")), kind("reset", json!({}))] } },
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
        assert_eq!(contract().operations(), BTreeSet::from(["show", "stream"].map(str::to_owned)));
    }

    #[test]
    fn events_are_compared_with_the_schema_of_their_name() {
        for (name, data, expected) in [
            ("value", json!(1), 0),
            ("value", json!("one"), 1),
            ("reset", json!({}), 0),
            ("other", json!({}), 1),
        ] {
            let event = Event { id: None, name: name.to_owned(), data };
            assert_eq!(contract().event_faults("stream", &event).len(), expected, "{event:?}");
        }
        let names = BTreeSet::from(["reset", "value"].map(str::to_owned));
        assert_eq!(contract().events("stream"), names);
    }
}
