//! Entries of an access log.

use std::{collections::BTreeSet, fmt, str::FromStr};

use asi_model::{DateTime, FactoryId, OrganisationId, RequestKey};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Way by which values were handed out.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, ToSchema,
)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum AccessKind {
    /// Shown by a page: current values, progress, the newest of the history.
    Looked,
    /// Sent to an open page as they arrived.
    Streamed,
    /// Copied from the history, page after page in the order of arrival.
    Exported,
    /// Sent to a tool.
    Forwarded,
}

impl AccessKind {
    const ALL: [Self; 4] = [Self::Looked, Self::Streamed, Self::Exported, Self::Forwarded];

    /// Returns the name in entries and in the API.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Looked => "LOOKED",
            Self::Streamed => "STREAMED",
            Self::Exported => "EXPORTED",
            Self::Forwarded => "FORWARDED",
        }
    }
}

impl fmt::Display for AccessKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl FromStr for AccessKind {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, &'static str> {
        let known = Self::ALL.into_iter().find(|kind| kind.as_str() == text);
        known.ok_or("an access is LOOKED, STREAMED, EXPORTED or FORWARDED")
    }
}

/// Nature of an agent: a person or a program.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, ToSchema,
)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
#[allow(missing_docs)]
pub enum AgentKind {
    User,
    Tool,
}

impl AgentKind {
    /// Returns the name in entries and in the API.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::User => "USER",
            Self::Tool => "TOOL",
        }
    }
}

/// Person or tool that read for an organisation, under a pseudonym.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Agent {
    #[serde(rename = "agentKind")]
    pub kind: AgentKind,
    /// Random id, the same in all entries of one factory; another at each factory.
    #[serde(rename = "agentId")]
    pub id: String,
    /// Role of a user at the time; absent for tools.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub role: Option<String>,
}

/// Values of one request that one agent got in one way.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Access {
    /// Organisation that got the values.
    pub viewer: OrganisationId,
    #[serde(flatten)]
    pub agent: Agent,
    #[serde(rename = "access")]
    pub kind: AccessKind,
    /// The request that the values answer.
    #[serde(flatten)]
    pub request: RequestKey,
    /// Names of the fields.
    pub fields: BTreeSet<String>,
    /// Earliest time of a value; absent where no value has a time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub values_from: Option<DateTime>,
    /// Latest time of a value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub values_to: Option<DateTime>,
    /// Number of values; one that was read twice counts twice.
    pub value_count: u64,
    /// Time of the first read that the entry counts; the last was at the time of the entry or before.
    pub since: DateTime,
}

/// An entry of a log, whose canonical text is a leaf of the tree.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct AccessEntry {
    pub factory_id: FactoryId,
    /// Number in the log, from 1 without gaps.
    pub number: u64,
    pub recorded_at: DateTime,
    #[serde(flatten)]
    pub access: Access,
}

impl AccessEntry {
    /// Returns the canonical text that is hashed and stored.
    #[must_use]
    pub fn canonical(&self) -> String {
        serde_json::to_string(self).expect("an entry has text keys only")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_of_entries_never_changes() {
        let request = RequestKey {
            operation_network_id: "net".parse().expect("an id"),
            operation_id: "op".parse().expect("an id"),
            dynamic_data_request_id: "req".parse().expect("an id"),
        };
        let mut entry = AccessEntry {
            factory_id: "F".parse().expect("an id"),
            number: 7,
            recorded_at: "2026-11-21T10:01:00Z".parse().expect("a time"),
            access: Access {
                viewer: "acme".parse().expect("an id"),
                agent: Agent {
                    kind: AgentKind::User,
                    id: "00ff".to_owned(),
                    role: Some("PLANNER".to_owned()),
                },
                kind: AccessKind::Looked,
                request,
                fields: ["b".to_owned(), "a".to_owned()].into(),
                values_from: Some("2026-11-21T09:00:00Z".parse().expect("a time")),
                values_to: Some("2026-11-21T09:30:00Z".parse().expect("a time")),
                value_count: 12,
                since: "2026-11-21T10:00:00Z".parse().expect("a time"),
            },
        };
        insta::assert_snapshot!(entry.canonical(), @r#"{"factoryId":"F","number":7,"recordedAt":"2026-11-21T10:01:00Z","viewer":"acme","agentKind":"USER","agentId":"00ff","role":"PLANNER","access":"LOOKED","operationNetworkId":"net","operationId":"op","dynamicDataRequestId":"req","fields":["a","b"],"valuesFrom":"2026-11-21T09:00:00Z","valuesTo":"2026-11-21T09:30:00Z","valueCount":12,"since":"2026-11-21T10:00:00Z"}"#);
        let read: AccessEntry = serde_json::from_str(&entry.canonical()).expect("reads back");
        assert_eq!(read, entry);
        entry.access.agent = Agent { kind: AgentKind::Tool, id: "01".to_owned(), role: None };
        (entry.access.values_from, entry.access.values_to) = (None, None);
        entry.access.kind = AccessKind::Forwarded;
        insta::assert_snapshot!(entry.canonical(), @r#"{"factoryId":"F","number":7,"recordedAt":"2026-11-21T10:01:00Z","viewer":"acme","agentKind":"TOOL","agentId":"01","access":"FORWARDED","operationNetworkId":"net","operationId":"op","dynamicDataRequestId":"req","fields":["a","b"],"valueCount":12,"since":"2026-11-21T10:00:00Z"}"#);
        let read: AccessEntry = serde_json::from_str(&entry.canonical()).expect("reads back");
        assert_eq!(read, entry);
    }

    #[test]
    fn kinds_have_one_name() {
        for kind in AccessKind::ALL {
            assert_eq!(kind.as_str().parse(), Ok(kind));
            assert_eq!(serde_json::to_value(kind).expect("a text"), kind.as_str());
        }
        assert!("looked".parse::<AccessKind>().is_err());
    }
}
