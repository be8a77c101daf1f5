//! Relations between operations, and the conditions on them.

use std::{fmt, time::Duration};

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::{
    ids::{ConditionId, OperationId, OperationRelationId},
    values::DateTime,
};

/// Dependency between an end of the predecessor and an end of the successor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum RelationType {
    FinishToStart = 0,
    StartToStart = 1,
    FinishToFinish = 2,
    StartToFinish = 3,
}

/// "The successor's start or finish depends on the predecessor's."
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct OperationRelation {
    /// Unique within the network.
    pub operation_relation_id: OperationRelationId,
    /// Ends of the two operations that the relation connects.
    pub relation_type: RelationType,
    /// The operation that comes first.
    pub predecessor_operation_id: OperationId,
    /// The operation that waits.
    pub successor_operation_id: OperationId,
    /// Bounds on the dependency.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub condition_list: Vec<RelationCondition>,
}

/// A bound: absolute for the first four kinds (`time`), relative for the gaps (`duration`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct RelationCondition {
    /// Unique within the network.
    pub condition_id: ConditionId,
    /// Kind of bound, which tells whether a time or a duration is needed.
    pub condition_kind: ConditionKind,
    /// The bound of an absolute kind; it applies to the successor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<DateTime>,
    /// The bound of a gap, between the two ends that the relation type names.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub duration: Option<IsoDuration>,
}

/// The kinds of condition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum ConditionKind {
    StartNoEarlierThan,
    StartNoLaterThan,
    FinishNoEarlierThan,
    FinishNoLaterThan,
    MinimumGap,
    MaximumGap,
}

impl ConditionKind {
    /// True for the kinds that take a duration.
    #[must_use]
    pub const fn is_gap(self) -> bool {
        matches!(self, Self::MinimumGap | Self::MaximumGap)
    }
}

/// An ISO 8601 duration of fixed length: weeks, days, hours, minutes, seconds (`PT8H`, `P1DT30M`).
/// Years and months have no fixed length and are refused. Digits beyond the microsecond are dropped
/// on reading: as OPC UA's Duration, a Double of milliseconds, a hundred years stay exact to that.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, JsonSchema)]
#[cfg_attr(
    feature = "openapi",
    derive(utoipa::ToSchema),
    schema(value_type = String, format = Duration)
)]
#[schemars(with = "String", extend("format" = "duration"))]
pub struct IsoDuration(pub Duration);

/// A text is not such a duration.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "a duration must be ISO 8601 without years and months, as PT8H or P1DT30M, but is {found:?}"
)]
pub struct InvalidDuration {
    /// The text, cut after 80 characters.
    pub found: String,
}

/// The longest duration accepted: a hundred years.
const SECONDS_MAX: f64 = 100.0 * 366.0 * 86_400.0;

fn parse(text: &str) -> Option<Duration> {
    let mut rest = text.strip_prefix('P')?;
    let (mut nanos, mut parts, mut in_time) = (0_u128, 0, false);
    let mut order = 0;
    while !rest.is_empty() {
        if let Some(after) = rest.strip_prefix('T') {
            if in_time || after.is_empty() {
                return None;
            }
            in_time = true;
            rest = after;
            continue;
        }
        let end = rest.find(|c: char| !(c.is_ascii_digit() || c == '.'))?;
        let (number, unit) = (&rest[..end], rest.as_bytes()[end]);
        let (rank, seconds) = match (unit, in_time) {
            (b'W', false) => (1, 604_800),
            (b'D', false) => (2, 86_400),
            (b'H', true) => (3, 3_600),
            (b'M', true) => (4, 60),
            (b'S', true) => (5, 1),
            _ => return None,
        };
        if rank <= order || number.len() > 20 || (number.contains('.') && rank != 5) {
            return None;
        }
        order = rank;
        let value: f64 = number.parse().ok()?;
        if !value.is_finite() || value * f64::from(seconds) > SECONDS_MAX {
            return None;
        }
        nanos += match number.split_once('.') {
            None => number.parse::<u128>().ok()? * seconds as u128 * 1_000_000_000,
            Some((whole, fraction)) => {
                let fraction = fraction.get(..6).unwrap_or(fraction);
                let scale = 10_u128.pow(9 - u32::try_from(fraction.len()).ok()?);
                whole.parse::<u128>().ok()? * 1_000_000_000 + fraction.parse::<u128>().ok()? * scale
            }
        };
        parts += 1;
        rest = &rest[end + 1..];
    }
    (parts > 0)
        .then(|| Duration::new((nanos / 1_000_000_000) as u64, (nanos % 1_000_000_000) as u32))
}

impl IsoDuration {
    /// Converts to OPC UA's Duration: milliseconds.
    #[must_use]
    pub fn as_milliseconds(self) -> f64 {
        self.0.as_micros() as f64 / 1000.0
    }

    /// Converts OPC UA's Duration; `None` where it is negative, not finite or beyond what is
    /// accepted.
    #[must_use]
    pub fn from_milliseconds(milliseconds: f64) -> Option<Self> {
        let micros = (milliseconds * 1000.0).round();
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // The range is checked.
        (0.0..=SECONDS_MAX * 1e6)
            .contains(&micros)
            .then(|| Self(Duration::from_micros(micros as u64)))
    }
}

impl std::str::FromStr for IsoDuration {
    type Err = InvalidDuration;
    fn from_str(text: &str) -> Result<Self, InvalidDuration> {
        parse(text)
            .map(Self)
            .ok_or_else(|| InvalidDuration { found: text.chars().take(80).collect() })
    }
}

impl fmt::Display for IsoDuration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (seconds, nanos) = (self.0.as_secs(), self.0.subsec_nanos());
        let (days, hours, minutes, rest) =
            (seconds / 86_400, seconds / 3_600 % 24, seconds / 60 % 60, seconds % 60);
        f.write_str("P")?;
        if days > 0 {
            write!(f, "{days}D")?;
        }
        let has_seconds = rest > 0 || nanos > 0;
        if hours > 0 || minutes > 0 || has_seconds || days == 0 {
            f.write_str("T")?;
        }
        if hours > 0 {
            write!(f, "{hours}H")?;
        }
        if minutes > 0 {
            write!(f, "{minutes}M")?;
        }
        if nanos > 0 {
            let fraction = format!("{nanos:09}");
            write!(f, "{rest}.{}S", fraction.trim_end_matches('0'))?;
        } else if rest > 0 || seconds == 0 {
            write!(f, "{rest}S")?;
        }
        Ok(())
    }
}

impl Serialize for IsoDuration {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for IsoDuration {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        std::borrow::Cow::<'de, str>::deserialize(deserializer)?
            .parse()
            .map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_round_trip() {
        for text in ["PT8H", "P1DT30M", "PT0S", "PT1.5S", "P14D", "PT1H1M1S"] {
            assert_eq!(text.parse::<IsoDuration>().map(|d| d.to_string()), Ok(text.to_owned()));
        }
        assert_eq!(
            "PT0.1234567891S".parse::<IsoDuration>().map(|d| d.to_string()),
            Ok("PT0.123456S".to_owned())
        );
        assert_eq!("P2W".parse::<IsoDuration>().map(|d| d.to_string()), Ok("P14D".to_owned()));
        for text in [
            "",
            "P",
            "PT",
            "P1Y",
            "P1M",
            "PT1M1H",
            "8H",
            "PT1.5H",
            "PT1H1H",
            "P999999999999D",
            "PT.S",
        ] {
            assert!(text.parse::<IsoDuration>().is_err(), "{text:?}");
        }
    }
}
