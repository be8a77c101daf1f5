//! Profiles of servers that plants have: limits, what to expect, and what to set at the machine, each with its evidence.
//! What a server grants always beats them.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

static PROFILES: LazyLock<Vec<ServerProfile>> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../profiles.json")).expect("the profiles are valid")
});

/// Profile of a family of servers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct ServerProfile {
    /// Name of the family for programs, as `s7-1500`.
    pub family: String,
    /// Name of the family for people.
    pub name: String,
    /// Texts of which one occurs in what a server says of itself.
    pub recognised_by: Vec<String>,
    pub advised: AdvisedIntervals,
    pub figures: Vec<ProfileFigure>,
    /// Behaviour that is normal for the family.
    pub expected: Vec<ProfileNote>,
    /// Steps that are taken at the machine.
    pub settings: Vec<ProfileNote>,
}

/// Intervals that fit a family, by judgement, in milliseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
#[allow(missing_docs)]
pub struct AdvisedIntervals {
    pub publishing_interval_ms: u32,
    pub sampling_interval_ms: u32,
}

/// A limit of a family, with its evidence.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct ProfileFigure {
    pub limit: ProfileLimit,
    pub value: u32,
    pub kind: EvidenceKind,
    /// Document, thread or project that says so.
    pub source: String,
}

/// Limits that a family may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum ProfileLimit {
    /// Least publishing interval that is granted, in milliseconds.
    PublishingIntervalMsMin,
    /// Least sampling interval that is granted, in milliseconds.
    SamplingIntervalMsMin,
    /// Most sessions at a time.
    SessionsMax,
    /// Most subscriptions of a session.
    SubscriptionsPerSessionMax,
    /// Most changes in the queue of an item.
    QueueSizeMax,
    /// Most nodes or items in one request.
    NodesPerCallMax,
    /// Most nodes in one browse request.
    NodesPerBrowseMax,
    /// Most publishing intervals between two signs of life.
    KeepAliveCountMax,
    /// Most publishing intervals without a request before a subscription ends.
    LifetimeCountMax,
}

/// A sentence about a family in both languages, with its evidence.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct ProfileNote {
    /// The sentence in English.
    pub en: String,
    /// The same in German.
    pub de: String,
    pub kind: EvidenceKind,
    /// Document, thread or project that says so.
    pub source: String,
}

/// Kinds of evidence, the strongest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum EvidenceKind {
    /// Manual or help of the maker.
    Manual,
    /// Code of the server, as it was read.
    Source,
    /// Thread about an issue.
    Issue,
    /// Notes of a public project, or an article.
    Project,
    /// Knowledge that was not checked against a document.
    General,
}

impl ServerProfile {
    /// Returns all profiles.
    #[must_use]
    pub fn all() -> &'static [Self] {
        &PROFILES
    }

    /// Returns the profile of a family.
    #[must_use]
    pub fn of_family(family: &str) -> Option<&'static Self> {
        Self::all().iter().find(|profile| profile.family == family)
    }

    /// Returns the profile behind texts that a server says of itself, as its application URI and that of its product.
    #[must_use]
    pub fn recognised<'t>(texts: impl IntoIterator<Item = &'t str>) -> Option<&'static Self> {
        let said: Vec<String> = texts.into_iter().map(str::to_lowercase).collect();
        let is_said = |mark: &String| said.iter().any(|text| text.contains(&mark.to_lowercase()));
        Self::all().iter().find(|profile| profile.recognised_by.iter().any(is_said))
    }

    /// Returns the value of a limit, where it is known.
    #[must_use]
    pub fn limit(&self, limit: ProfileLimit) -> Option<u32> {
        let found = self.figures.iter().find(|figure| figure.limit == limit)?;
        Some(found.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn servers_are_recognised_by_what_they_say_of_themselves() {
        for (text, family) in [
            ("urn:SIMATIC.S7-1500.OPC-UA.Application:PLC_1", Some("s7-1500")),
            ("https://www.siemens.com/s7-1500", Some("s7-1500")),
            ("urn:SIMATIC.S7-1200.OPC-UA.Application:PLC_1", Some("s7-1200")),
            ("urn:CX-19788E:BeckhoffAutomation:TcOpcUaServer:1", Some("beckhoff")),
            ("urn:127.0.0.1/BR/UA/EmbeddedServer", Some("br")),
            (
                "urn:PC:3S - Smart Software Solutions GmbH:CODESYS Control Win V3:OPCUA:Server",
                Some("codesys"),
            ),
            ("urn:PC:Kepware.KEPServerEX.V6:UA Server", Some("kepware")),
            ("urn:inductiveautomation:ignition:opcua:server:20bd682b", Some("ignition")),
            ("urn:pc:OPCUA:SimulationServer", Some("prosys")),
            ("urn:verbund:simulator:server:Mill1", None),
            ("", None),
        ] {
            let found = ServerProfile::recognised([text]).map(|profile| profile.family.as_str());
            assert_eq!(found, family, "{text}");
        }
    }

    #[test]
    fn each_profile_says_where_it_knows_it_from() {
        for profile in ServerProfile::all() {
            let of_figures = profile.figures.iter().map(|figure| &figure.source);
            let notes = || profile.expected.iter().chain(&profile.settings);
            let sources = of_figures.chain(notes().map(|note| &note.source));
            assert!(sources.into_iter().all(|source| source.len() > 5), "{}", profile.family);
            assert!(notes().all(|note| !note.en.is_empty() && !note.de.is_empty()));
            let limits: Vec<_> = profile.figures.iter().map(|figure| figure.limit).collect();
            for (index, limit) in limits.iter().enumerate() {
                assert!(!limits[..index].contains(limit), "{}: {limit:?} twice", profile.family);
            }
            assert_eq!(ServerProfile::of_family(&profile.family), Some(profile));
        }
    }
}
