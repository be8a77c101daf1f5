//! Requests for monitored variables, and the changes that callers receive.

use std::{fmt, str::FromStr, sync::Arc};

use asi_model::values::{DataValue, Namespace, NodeId, QualifiedName};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use utoipa::ToSchema;

use crate::{EventSelection, SourceId};

/// A caller's own key of one input. The same variable may be monitored under several keys.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, ToSchema,
)]
#[serde(transparent)]
pub struct InputKey(pub u64);

/// A new value of an input, with its quality and times as the source gave them.
#[derive(Debug, Clone, PartialEq)]
pub struct InputChange {
    pub input: InputKey,
    /// The value. `BadNotConnected` without value when the source is lost; another Bad status
    /// without value when the server refuses to monitor the node.
    pub value: DataValue,
}

/// Request to monitor a variable, or the events of a notifier.
#[derive(Debug, Clone, PartialEq)]
pub struct MonitorRequest {
    /// The caller's key.
    pub input: InputKey,
    /// Source of the variable; it need not be known or connected yet.
    pub source: SourceId,
    pub node_id: NodeId,
    pub options: MonitorOptions,
}

/// Options of a monitored variable or notifier.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", default, deny_unknown_fields)]
pub struct MonitorOptions {
    /// Sampling interval of the server, in milliseconds. 0: on every change. Default: the
    /// sampling interval of the source.
    pub sampling_interval_ms: Option<f64>,
    /// Changes that the server queues between two publishings. Default: enough for the sampling and
    /// publishing interval, so that no change is lost.
    pub queue_size: Option<u32>,
    /// Path of the variable from the Objects folder, to find it again when its node id changes.
    /// Without it, the path is looked up while the node is there.
    pub browse_path: Option<BrowsePath>,
    /// Part of an array, as OPC 10000-4 §7.27 writes it: `2` or `1:3`.
    pub index_range: Option<String>,
    /// Events of the node in the place of its value.
    // Boxed, because few inputs have any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub events: Option<Box<EventSelection>>,
}

/// Browse names from the Objects folder down to a node. In JSON a list of texts `nsu=<uri>;<name>`,
/// those of namespace 0 bare.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default, ToSchema)]
#[schema(value_type = Vec<String>)]
pub struct BrowsePath(pub Vec<QualifiedName>);

/// A text is not an element of a browse path.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "an element of a browse path must look like nsu=urn:press;Counter or, in namespace 0, Server, but is {found:?}"
)]
pub struct InvalidBrowsePath {
    /// Text that was found, cut after 120 characters.
    pub found: String,
}

/// Longest browse path, in elements.
pub const PATH_ELEMENTS_MAX: usize = 64;

impl BrowsePath {
    /// The elements as texts.
    #[must_use]
    pub fn to_texts(&self) -> Vec<String> {
        self.0.iter().map(element_text).collect()
    }
}

impl fmt::Display for BrowsePath {
    /// The names alone, as people read them: `DeviceSet/Robot/MotionDevices`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, element) in self.0.iter().enumerate() {
            let slash = if index == 0 { "" } else { "/" };
            write!(f, "{slash}{}", element.name.as_deref().unwrap_or_default())?;
        }
        Ok(())
    }
}

struct Element(QualifiedName);

impl FromStr for Element {
    type Err = InvalidBrowsePath;
    fn from_str(text: &str) -> Result<Self, InvalidBrowsePath> {
        // A node id with the name as its string identifier has the same text form, its escapes
        // included.
        let invalid = || InvalidBrowsePath { found: text.chars().take(120).collect() };
        let (namespace, name) = match text.strip_prefix("nsu=") {
            Some(rest) => {
                let (uri, name) = rest.split_once(';').ok_or_else(invalid)?;
                (Namespace::uri(&uri.replace("%3B", ";").replace("%25", "%")), name)
            }
            None => (Namespace::Ua, text),
        };
        if name.is_empty() {
            return Err(invalid());
        }
        Ok(Self(QualifiedName { namespace, name: Some(Arc::from(name)) }))
    }
}

fn element_text(element: &QualifiedName) -> String {
    let name = element.name.as_deref().unwrap_or_default();
    match &element.namespace {
        Namespace::Ua => name.to_owned(),
        Namespace::Uri(uri) => {
            format!("nsu={};{name}", uri.replace('%', "%25").replace(';', "%3B"))
        }
        // An index means nothing outside its session; the server's own paths never contain one.
        Namespace::Index(index) => format!("ns={index};{name}"),
    }
}

impl Serialize for BrowsePath {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.iter().map(element_text))
    }
}

impl<'de> Deserialize<'de> for BrowsePath {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let texts = Vec::<String>::deserialize(deserializer)?;
        if texts.len() > PATH_ELEMENTS_MAX {
            return Err(serde::de::Error::custom("a browse path has at most 64 elements"));
        }
        let elements = texts
            .iter()
            .map(|text| text.parse().map(|Element(name)| name))
            .collect::<Result<_, _>>();
        elements.map(Self).map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn browse_paths_survive_json() {
        let json = r#"["nsu=urn:a%3Bb%25;DeviceSet","Server","nsu=urn:press;ns=1;odd"]"#;
        let path: BrowsePath = serde_json::from_str(json).expect("valid");
        assert_eq!(path.0[0].namespace, Namespace::Uri("urn:a;b%".into()));
        assert_eq!(path.to_string(), "DeviceSet/Server/ns=1;odd");
        assert_eq!(serde_json::to_string(&path).expect("serialises"), json);
        for wrong in [r#"["nsu=urn:x"]"#, r#"[""]"#, r#"["nsu=urn:x;"]"#] {
            assert!(serde_json::from_str::<BrowsePath>(wrong).is_err(), "{wrong}");
        }
    }
}
