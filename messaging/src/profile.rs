//! Names of logical addresses on each kind of broker. No broker's prefix appears anywhere else.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use crate::address::LogicalAddress;

/// Naming scheme of one kind of broker for the addresses to receive from and send to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BrokerProfile {
    name: String,
    consume: Template,
    produce: Template,
    capability: Option<String>,
}

/// An address on a concrete broker: an AMQP terminus.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Terminus {
    pub address: String,
    /// A terminus capability that the broker needs to tell queues from topics.
    pub capability: Option<String>,
}

/// A text with the placeholder `{address}` (as it is), `{address:percent}` (percent-encoded, RFC
/// 3986) or `{address:path}` (slashes for dots).
#[derive(Debug, Clone, PartialEq, Eq)]
struct Template(String);

/// Fault of a profile's name or template.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum InvalidTemplate {
    /// All logical addresses would have the same name.
    #[error(
        "the template {template:?} contains none of {{address}}, {{address:percent}} and {{address:path}}"
    )]
    NoPlaceholder { template: String },
    /// No profile has that name.
    #[error(
        "there is no broker profile {name:?}; choose embedded, rabbitmq-3 or mqtt, rabbitmq-4 or activemq (both untested), or give templates"
    )]
    UnknownName { name: String },
}

impl BrokerProfile {
    /// The broker embedded in the platform: addresses are queues of the same name.
    #[must_use]
    pub fn embedded() -> Self {
        Self::built_in("embedded", "{address}", "{address}", None)
    }

    /// RabbitMQ 3.x with its AMQP 1.0 plugin. Reads `/amq/queue/<address>`; writes through the
    /// topic exchange `verbund`, whose routing keys per user keep factories apart.
    #[must_use]
    pub fn rabbitmq_3() -> Self {
        Self::built_in("rabbitmq-3", "/amq/queue/{address}", "/exchange/verbund/{address}", None)
    }

    /// RabbitMQ 4.x with native AMQP 1.0 and its second address format.
    #[must_use]
    pub fn rabbitmq_4() -> Self {
        Self::built_in(
            "rabbitmq-4",
            "/queues/{address:percent}",
            "/exchanges/verbund/{address:percent}",
            None,
        )
    }

    /// ActiveMQ Classic and Artemis (anycast): queues of the same name, asked for by capability.
    #[must_use]
    pub fn activemq() -> Self {
        Self::built_in("activemq", "{address}", "{address}", Some("queue"))
    }

    /// MQTT 5 brokers: topics `verbund/v1/factory/<factoryId>/requests` and the like.
    #[must_use]
    pub fn mqtt() -> Self {
        Self::built_in("mqtt", "verbund/v1/{address:path}", "verbund/v1/{address:path}", None)
    }

    /// Returns whether the daemons' tests play everything with a broker of this profile: Mosquitto for `mqtt`.
    #[must_use]
    pub fn is_tested(&self) -> bool {
        [Self::embedded(), Self::rabbitmq_3(), Self::mqtt()].contains(self)
    }

    /// Creates a profile from templates.
    ///
    /// # Errors
    /// [`InvalidTemplate::NoPlaceholder`] when a template does not contain the address.
    pub fn custom(
        name: impl Into<String>,
        consume: impl Into<String>,
        produce: impl Into<String>,
        capability: Option<String>,
    ) -> Result<Self, InvalidTemplate> {
        Ok(Self {
            name: name.into(),
            consume: Template::parse(consume.into())?,
            produce: Template::parse(produce.into())?,
            capability,
        })
    }

    /// Returns the built-in profile of that name.
    ///
    /// # Errors
    /// [`InvalidTemplate::UnknownName`] for any other name.
    pub fn named(name: &str) -> Result<Self, InvalidTemplate> {
        match name {
            "embedded" => Ok(Self::embedded()),
            "rabbitmq-3" => Ok(Self::rabbitmq_3()),
            "rabbitmq-4" => Ok(Self::rabbitmq_4()),
            "activemq" => Ok(Self::activemq()),
            "mqtt" => Ok(Self::mqtt()),
            _ => Err(InvalidTemplate::UnknownName { name: name.to_owned() }),
        }
    }

    /// The profile's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the terminus to receive the messages of an address from.
    #[must_use]
    pub fn consume(&self, address: &LogicalAddress) -> Terminus {
        Terminus { address: self.consume.fill(address), capability: self.capability.clone() }
    }

    /// Returns the terminus to send messages for an address to.
    #[must_use]
    pub fn produce(&self, address: &LogicalAddress) -> Terminus {
        Terminus { address: self.produce.fill(address), capability: self.capability.clone() }
    }

    fn built_in(name: &str, consume: &str, produce: &str, capability: Option<&str>) -> Self {
        Self {
            name: name.to_owned(),
            consume: Template(consume.to_owned()),
            produce: Template(produce.to_owned()),
            capability: capability.map(str::to_owned),
        }
    }
}

impl Default for BrokerProfile {
    fn default() -> Self {
        Self::embedded()
    }
}

impl Template {
    fn parse(text: String) -> Result<Self, InvalidTemplate> {
        if ["{address}", "{address:percent}", "{address:path}"].iter().any(|p| text.contains(p)) {
            Ok(Self(text))
        } else {
            Err(InvalidTemplate::NoPlaceholder { template: text })
        }
    }

    fn fill(&self, address: &LogicalAddress) -> String {
        let plain = address.to_string();
        self.0
            .replace("{address:percent}", &Percent(&plain).to_string())
            .replace("{address:path}", &plain.replace('.', "/"))
            .replace("{address}", &plain)
    }
}

/// Writes all but the unreserved characters of RFC 3986 §2.3 as percent triplets.
struct Percent<'a>(&'a str);

impl fmt::Display for Percent<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for byte in self.0.bytes() {
            if byte.is_ascii_alphanumeric() || b"-._~".contains(&byte) {
                write!(f, "{}", byte as char)?;
            } else {
                write!(f, "%{byte:02X}")?;
            }
        }
        Ok(())
    }
}

/// Profile in a configuration: a name, or a table of templates.
#[derive(Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(untagged)]
enum Written {
    Name(String),
    Table(Table),
}

/// Templates of a profile; each contains `{address}`, `{address:percent}` or `{address:path}`.
#[derive(Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = BrokerTemplates))]
#[serde(deny_unknown_fields)]
struct Table {
    name: String,
    consume: String,
    produce: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    capability: Option<String>,
}

impl<'de> Deserialize<'de> for BrokerProfile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match Written::deserialize(deserializer)? {
            Written::Name(name) => Self::named(&name),
            Written::Table(t) => Self::custom(t.name, t.consume, t.produce, t.capability),
        }
        .map_err(de::Error::custom)
    }
}

#[cfg(feature = "openapi")]
impl utoipa::PartialSchema for BrokerProfile {
    fn schema() -> utoipa::openapi::RefOr<utoipa::openapi::Schema> {
        Written::schema()
    }
}

#[cfg(feature = "openapi")]
impl utoipa::ToSchema for BrokerProfile {
    fn schemas(
        schemas: &mut Vec<(String, utoipa::openapi::RefOr<utoipa::openapi::schema::Schema>)>,
    ) {
        Written::schemas(schemas);
    }
}

impl Serialize for BrokerProfile {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match Self::named(&self.name) {
            Ok(built_in) if built_in == *self => Written::Name(self.name.clone()),
            _ => Written::Table(Table {
                name: self.name.clone(),
                consume: self.consume.0.clone(),
                produce: self.produce.0.clone(),
                capability: self.capability.clone(),
            }),
        }
        .serialize(serializer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_tested_brokers_are_called_so() {
        for (name, is_tested) in [
            ("embedded", true),
            ("rabbitmq-3", true),
            ("mqtt", true),
            ("rabbitmq-4", false),
            ("activemq", false),
        ] {
            assert_eq!(
                BrokerProfile::named(name).expect("a profile").is_tested(),
                is_tested,
                "{name}"
            );
        }
        let own = BrokerProfile::custom("mqtt", "q/{address}", "{address}", None);
        assert!(!own.expect("a profile").is_tested(), "a name makes nothing tested");
    }

    #[test]
    fn each_broker_gets_its_own_addresses() {
        let address: LogicalAddress = "factory.FOR_MUC.ingress".parse().expect("an address");
        for (name, consume, produce) in [
            ("embedded", "factory.FOR_MUC.ingress", "factory.FOR_MUC.ingress"),
            (
                "rabbitmq-3",
                "/amq/queue/factory.FOR_MUC.ingress",
                "/exchange/verbund/factory.FOR_MUC.ingress",
            ),
            (
                "rabbitmq-4",
                "/queues/factory.FOR_MUC.ingress",
                "/exchanges/verbund/factory.FOR_MUC.ingress",
            ),
            ("activemq", "factory.FOR_MUC.ingress", "factory.FOR_MUC.ingress"),
            ("mqtt", "verbund/v1/factory/FOR_MUC/ingress", "verbund/v1/factory/FOR_MUC/ingress"),
        ] {
            let profile = BrokerProfile::named(name).expect("a profile");
            assert_eq!(profile.consume(&address).address, consume);
            assert_eq!(profile.produce(&address).address, produce);
        }
    }

    #[test]
    fn a_profile_is_a_name_or_templates() {
        let named: BrokerProfile = serde_json::from_str(r#""rabbitmq-3""#).expect("a profile");
        assert_eq!(named, BrokerProfile::rabbitmq_3());
        let json = r#"{"name":"own","consume":"q/{address}","produce":"x/{address:percent}"}"#;
        let own: BrokerProfile = serde_json::from_str(json).expect("a profile");
        assert_eq!(own.consume(&LogicalAddress::DeadLetters).address, "q/dead-letters");
        assert_eq!(serde_json::to_string(&own).expect("serializes"), json);
        let error = serde_json::from_str::<BrokerProfile>(
            r#"{"name":"own","consume":"q","produce":"{address}"}"#,
        );
        assert!(error.expect_err("no placeholder").to_string().contains("{address}"));
        assert!(serde_json::from_str::<BrokerProfile>(r#""kafka""#).is_err());
    }
}
