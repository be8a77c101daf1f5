//! Paths of browse names.

use std::{fmt, str::FromStr, sync::Arc};

use asi_model::values::{Namespace, QualifiedName};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use utoipa::ToSchema;

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
