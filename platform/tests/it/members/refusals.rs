//! Refusals: what is hidden from its author is refused as what never existed.
//!
//! The exception are ids that a document would take: one that something hidden has is refused, where
//! one that never existed would be taken.

use serde_json::Value;

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
        let takes_id = operation.starts_with("PUT /operation-networks/")
            || (operation.ends_with("/requests") && never_path == path);
        let never_body = body.map(|body| self.never_existing(&body.to_string()));
        let never_body = never_body.map(|text| serde_json::from_str::<Value>(&text).expect("JSON"));
        if takes_id || (never_path == path && never_body.as_ref() == body) {
            return 0;
        }
        let (method, _) = operation.split_once(' ').expect("a method");
        let method = method.parse().expect("a method");
        let never = self.author.api.call(method, &never_path, never_body).await;
        assert_eq!(
            (answer.status, self.never_existing(&answer.body.to_string())),
            (never.status, never.body.to_string()),
            "{}: {operation} {path}",
            self.author.id
        );
        1
    }
}
