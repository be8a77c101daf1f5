//! Refusals: what is hidden from its author is refused as what never existed.
//!
//! An id that a document would take is refused where something hidden has it, and one that never
//! existed would be taken. Such attempts are made once more with a fault of their own, so that both
//! are refused: they differ in nothing but that the id cannot be used.

use serde_json::{Value, json};

use super::Member;
use crate::{chain::ids, harness::Answer};

/// Ids that `author` may not know of.
pub struct Refusals<'m> {
    author: &'m Member,
    hidden: Vec<String>,
}

/// Ids of operations, requests and relations of a document.
fn ids_of(document: &Value) -> Vec<String> {
    let mut found = ids(&document["operationList"], "operationId");
    found.extend(ids(&document["operationRelationList"], "operationRelationId"));
    for operation in document["operationList"].as_array().into_iter().flatten() {
        found.extend(ids(&operation["dynamicDataRequestList"], "dynamicDataRequestId"));
    }
    found
}

impl<'m> Refusals<'m> {
    /// Collects what is the owner's alone, and what the author does not see of the chain.
    pub fn new(author: &'m Member, owner: &Member, chain: &Value, shown: &Value) -> Self {
        let seen = ids_of(shown);
        let mut hidden: Vec<String> =
            ids_of(chain).into_iter().filter(|id| !seen.contains(id)).collect();
        hidden.extend([owner.network(), owner.tool(), format!("Req-{}", owner.id)]);
        Self { author, hidden }
    }

    /// Puts ids that never existed in the place of hidden ones.
    fn never_existing(&self, text: &str) -> String {
        let ids = self.hidden.iter().enumerate();
        ids.fold(text.to_owned(), |text, (index, id)| text.replace(id, &format!("Never{index}")))
    }

    /// Compares the refusal of an attempt with that of the same attempt on ids that never existed.
    /// Returns 0 where the attempt names nothing hidden.
    pub async fn assert_as_never_existed(
        &self,
        operation: &str,
        (path, body): (&str, Option<&Value>),
        answer: &Answer,
    ) -> usize {
        if answer.status == 200 {
            assert_eq!(answer.body["sentTo"], Value::Array(Vec::new()), "{operation}: {answer:?}");
            return 0;
        }
        let never_path = self.never_existing(path);
        let never_body = body.map(|body| self.never_value(body));
        if never_path == path && never_body.as_ref() == body {
            return 0;
        }
        if answer.status == 409 {
            self.assert_network_is_taken(operation, path, answer);
            return 1;
        }
        let takes_id = operation.starts_with("PUT /operation-networks/")
            || (operation.ends_with("/requests") && never_path == path);
        if takes_id {
            let bodies = (body.expect("a document"), never_body.expect("a document"));
            return self.assert_only_ids_are_taken(operation, (path, &never_path), bodies).await;
        }
        let never = self.call(operation, &never_path, never_body).await;
        assert_eq!(
            (answer.status, self.never_existing(&answer.body.to_string())),
            (never.status, never.body.to_string()),
            "{}: {operation} {path}",
            self.author.id
        );
        1
    }

    fn never_value(&self, body: &Value) -> Value {
        serde_json::from_str(&self.never_existing(&body.to_string())).expect("JSON")
    }

    async fn call(&self, operation: &str, path: &str, body: Option<Value>) -> Answer {
        let (method, _) = operation.split_once(' ').expect("a method");
        self.author.api.call(method.parse().expect("a method"), path, body).await
    }

    /// Asserts that the refusal of a hidden network's id says that it is taken, and nothing else.
    fn assert_network_is_taken(&self, operation: &str, path: &str, answer: &Answer) {
        assert!(operation.starts_with("PUT /operation-networks/"), "{operation}: {answer:?}");
        let mut body = answer.body.clone();
        let members = body.as_object_mut().expect("a problem");
        let detail = members.remove("detail").expect("a detail");
        let code = members.remove("code").expect("a code");
        assert_eq!(
            (detail, code),
            (json!("There is a network with this id already."), json!("ALREADY_EXISTS")),
            "{}: {path}",
            self.author.id
        );
        // What is left is the same for every conflict.
        let names: Vec<&str> = members.keys().map(String::as_str).collect();
        assert_eq!(names, ["type", "title", "status"], "{}: {path}: {answer:?}", self.author.id);
    }

    /// Asserts that a document with hidden ids is refused as the same one with ids that never existed, but
    /// for hidden ids being taken where the document gives them.
    async fn assert_only_ids_are_taken(
        &self,
        operation: &str,
        (path, never_path): (&str, &str),
        (body, never_body): (&Value, Value),
    ) -> usize {
        let body = spoiled(body.clone());
        let answer = self.call(operation, path, Some(body.clone())).await;
        let never = self.call(operation, never_path, Some(spoiled(never_body))).await;
        let what = || format!("{}: {operation} {path}: {answer:?} {never:?}", self.author.id);
        assert_eq!((answer.status, never.status), (422, 422), "{}", what());
        let is_taken = |fault: &&Value| fault["code"] == "ID_TAKEN";
        let faults = |answer: &Answer| answer.body["faults"].as_array().expect("faults").clone();
        let (of_hidden, of_never) = (faults(&answer), faults(&never));
        for taken in of_hidden.iter().filter(is_taken) {
            let place = taken["pointer"].as_str().expect("a pointer");
            let id = body.pointer(place).and_then(Value::as_str);
            assert!(id.is_some_and(|id| self.hidden.iter().any(|one| one == id)), "{}", what());
            assert_eq!(
                taken["message"],
                "This id cannot be used here; take another one.",
                "{}",
                what()
            );
        }
        let others = of_hidden.iter().filter(|fault| !is_taken(fault));
        let others: Vec<Value> = others.map(|fault| self.never_value(fault)).collect();
        assert_eq!(others, of_never, "{}", what());
        1
    }
}

/// A document with a fault that has to do with nobody: a place or a recipient that nobody knows.
fn spoiled(mut body: Value) -> Value {
    let operations = body.pointer_mut("/operationNetwork/operationList");
    if let Some(operations) = operations.and_then(Value::as_array_mut) {
        operations.push(json!({ "operationId": "Spoiled", "operationType": "PRODUCTION",
            "owningFactoryId": "NOWHERE" }));
    } else {
        body["recipientList"].as_array_mut().expect("recipients").push(json!("nowhere"));
    }
    body
}
