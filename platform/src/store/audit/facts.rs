//! Facts of entries: the ids, roles and numbers that operation and subject do not say.

use std::fmt;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::store::{
    error::StoreError,
    row::{Columns, DatabaseRow, document},
};

/// Most facts of an entry. Of further ones it has the number.
const FACTS_MAX: usize = 20;
/// Longest id, role or name of a fact.
const FACT_CHARS_MAX: usize = 200;

/// Thing of which a fact says how it was and is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum AuditFactKind {
    /// Role of a person.
    Role,
    /// Organisation of a person, factory or tool; for administrators.
    Organisation,
    /// Password of a person, `SET`.
    Password,
    /// Second factors of a person, `REMOVED`.
    SecondFactor,
    /// Person whose account ended, or as a factory names it the author of a comment.
    Person,
    /// Member of a collaboration.
    Member,
    /// Factory of a collaboration, or that a comment is for.
    Factory,
    /// Dynamic data request that a comment is about.
    Request,
    /// Revision of a network.
    Revision,
    /// State of a field, or answer to a revision.
    State,
    /// Organisation to which something was released.
    Recipient,
    /// Reports that were released: writer, epoch, and sequence numbers.
    Reports,
    /// Host of a connector.
    Host,
    /// Number of credentials that ended.
    Credentials,
    /// Key with which a connector signs, `SET`.
    SigningKey,
    /// Queue from which a message came.
    Address,
    /// Number of further facts.
    Further,
}

/// Fact of an entry. Never a secret, and never a value of a plant.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct AuditFact {
    pub kind: AuditFactKind,
    /// Name, id or number before; absent where there was none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub former: Option<String>,
    /// Name, id or number since; absent where there is none any more.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub present: Option<String>,
}

impl AuditFact {
    /// Makes the fact of what is there since.
    #[must_use]
    pub fn new(kind: AuditFactKind, present: impl fmt::Display) -> Self {
        Self { kind, former: None, present: Some(bounded(present)) }
    }

    /// Makes the fact of what is there no more.
    #[must_use]
    pub fn ended(kind: AuditFactKind, former: impl fmt::Display) -> Self {
        Self { kind, former: Some(bounded(former)), present: None }
    }

    /// Makes the fact of what was before and is since; none where there is neither.
    #[must_use]
    pub fn changed<T: fmt::Display>(
        kind: AuditFactKind,
        former: Option<T>,
        present: Option<T>,
    ) -> Option<Self> {
        let (former, present) = (former.map(bounded), present.map(bounded));
        let says_something = former.is_some() || present.is_some();
        says_something.then_some(Self { kind, former, present })
    }
}

fn bounded(text: impl fmt::Display) -> String {
    text.to_string().chars().take(FACT_CHARS_MAX).collect()
}

/// Returns facts as they are stored.
pub(super) fn stored(facts: &[AuditFact]) -> String {
    if facts.len() <= FACTS_MAX {
        return document(facts);
    }
    let (kept, further) = facts.split_at(FACTS_MAX);
    let further = AuditFact::new(AuditFactKind::Further, further.len());
    document(&kept.iter().chain([&further]).collect::<Vec<_>>())
}

/// Returns the facts that a viewer may know. What administrators do to others says nothing of those to their own
/// organisation, and from where a person came is not said to its next one.
pub(super) fn shown(row: &DatabaseRow, viewer: Option<&str>) -> Result<Vec<AuditFact>, StoreError> {
    let facts: Vec<AuditFact> = row.json("detail")?;
    if viewer.is_none() {
        return Ok(facts);
    }
    let (share, concerned): (Option<&str>, Option<&str>) =
        (row.column("share")?, row.column("concerned_id")?);
    if share != viewer && concerned != viewer {
        return Ok(Vec::new());
    }
    Ok(facts.into_iter().filter(|fact| fact.kind != AuditFactKind::Organisation).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_has_a_bounded_size_whatever_was_changed() {
        let long = "\u{1F600}".repeat(100_000);
        let facts = vec![AuditFact::new(AuditFactKind::Member, long); 5_000];
        let text = stored(&facts);
        assert!(text.len() < 20_000, "{} bytes", text.len());
        let read: Vec<AuditFact> = serde_json::from_str(&text).expect("facts");
        assert_eq!(read.len(), FACTS_MAX + 1);
        assert_eq!(read[FACTS_MAX], AuditFact::new(AuditFactKind::Further, 4_980));
        let few: Vec<AuditFact> = serde_json::from_str(&stored(&facts[..2])).expect("facts");
        assert_eq!(few, facts[..2]);
    }

    #[test]
    fn a_fact_says_what_was_and_what_is() {
        let fact = |former, present| AuditFact::changed(AuditFactKind::Role, former, present);
        assert_eq!(fact(None::<&str>, None), None);
        let promoted = fact(Some("VIEWER"), Some("PLANNER")).expect("a fact");
        let expected = r#"{"kind":"ROLE","former":"VIEWER","present":"PLANNER"}"#;
        assert_eq!(serde_json::to_string(&promoted).expect("a text"), expected);
        let ended = AuditFact::ended(AuditFactKind::Credentials, 2);
        let expected = r#"{"kind":"CREDENTIALS","former":"2"}"#;
        assert_eq!(serde_json::to_string(&ended).expect("a text"), expected);
    }
}
