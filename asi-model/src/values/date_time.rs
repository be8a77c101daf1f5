//! Time as OPC UA counts it (OPC 10000-6 §5.1.4): 100 ns since 1601-01-01T00:00:00Z.

use std::{borrow::Cow, fmt, num::NonZeroI64, str::FromStr};

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use time::{OffsetDateTime, format_description::well_known::Rfc3339};

/// An instant in UTC with a resolution of 100 ns. On the wire an RFC 3339 text.
// Held as its ticks and one more, so that an `Option<DateTime>` takes no more room: every value has
// two of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, JsonSchema)]
#[cfg_attr(
    feature = "openapi",
    derive(utoipa::ToSchema),
    schema(value_type = String, format = DateTime)
)]
#[schemars(with = "String", extend("format" = "date-time"))]
pub struct DateTime(NonZeroI64);

/// A text is not an RFC 3339 time between the years 1601 and 9999.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("a time must be RFC 3339, as 2019-04-18T06:00:00Z, but is {found:?}")]
pub struct InvalidDateTime {
    /// The text, cut after 80 characters.
    pub found: String,
}

const TICKS_PER_SECOND: i64 = 10_000_000;
/// 1601-01-01 to 1970-01-01 in ticks.
const UNIX_EPOCH_TICKS: i64 = 11_644_473_600 * TICKS_PER_SECOND;
/// 9999-12-31T23:59:59Z: the latest instant that OPC UA JSON can say.
const MAX_TICKS: i64 = 2_650_467_743_990_000_000;

impl DateTime {
    /// The earliest instant, which OPC UA also uses for "no time".
    pub const MIN: Self = Self::within(0);
    /// The latest instant, "never ends".
    pub const MAX: Self = Self::within(MAX_TICKS);

    /// Converts ticks of 100 ns since 1601; clamped to [`Self::MIN`]..=[`Self::MAX`].
    #[must_use]
    pub fn from_ticks(ticks: i64) -> Self {
        Self::within(ticks.clamp(0, MAX_TICKS))
    }

    /// Converts ticks that lie within the bounds.
    const fn within(ticks: i64) -> Self {
        Self(NonZeroI64::new(ticks + 1).expect("ticks within the bounds are not negative"))
    }

    /// Ticks of 100 ns since 1601-01-01T00:00:00Z.
    #[must_use]
    pub const fn ticks(self) -> i64 {
        self.0.get() - 1
    }

    /// Converts microseconds since 1970-01-01T00:00:00Z.
    #[must_use]
    pub fn from_unix_micros(micros: i64) -> Self {
        Self::from_ticks(micros.saturating_mul(10).saturating_add(UNIX_EPOCH_TICKS))
    }

    /// Whole microseconds since 1970-01-01T00:00:00Z (rounded down).
    #[must_use]
    pub fn unix_micros(self) -> i64 {
        (self.ticks() - UNIX_EPOCH_TICKS).div_euclid(10)
    }

    /// Whole milliseconds since 1970-01-01T00:00:00Z (rounded down).
    #[must_use]
    pub fn unix_millis(self) -> i64 {
        (self.ticks() - UNIX_EPOCH_TICKS).div_euclid(10_000)
    }

    /// The time so much later, clamped.
    #[must_use]
    pub fn after(self, duration: std::time::Duration) -> Self {
        let ticks = i64::try_from(duration.as_nanos() / 100).unwrap_or(i64::MAX);
        Self::from_ticks(self.ticks().saturating_add(ticks))
    }

    /// Time since `earlier`; zero where that is in the future.
    #[must_use]
    pub fn since(self, earlier: Self) -> std::time::Duration {
        let ticks = u64::try_from(self.ticks() - earlier.ticks()).unwrap_or(0);
        std::time::Duration::new(
            ticks / 10_000_000,
            u32::try_from(ticks % 10_000_000).unwrap_or(0) * 100,
        )
    }

    /// Rounded down to a multiple of `step` since the Unix epoch; unchanged where the step is zero.
    #[must_use]
    pub fn floor_to(self, step: std::time::Duration) -> Self {
        let step = i64::try_from(step.as_nanos() / 100).unwrap_or(i64::MAX);
        if step == 0 {
            self
        } else {
            Self::from_ticks(self.ticks() - (self.ticks() - UNIX_EPOCH_TICKS).rem_euclid(step))
        }
    }

    /// OPC UA VersionTime (OPC 10000-4 §7.44): seconds since 2000-01-01T00:00:00Z.
    #[must_use]
    pub fn version_time(self) -> u32 {
        u32::try_from((self.ticks() - UNIX_EPOCH_TICKS) / TICKS_PER_SECOND - 946_684_800)
            .unwrap_or(0)
    }
}

impl Default for DateTime {
    fn default() -> Self {
        Self::MIN
    }
}

impl From<OffsetDateTime> for DateTime {
    fn from(time: OffsetDateTime) -> Self {
        let ticks = time.unix_timestamp_nanos().div_euclid(100) + i128::from(UNIX_EPOCH_TICKS);
        Self::from_ticks(i64::try_from(ticks).unwrap_or(if ticks < 0 { 0 } else { MAX_TICKS }))
    }
}

impl From<std::time::SystemTime> for DateTime {
    fn from(time: std::time::SystemTime) -> Self {
        OffsetDateTime::from(time).into()
    }
}

impl From<DateTime> for OffsetDateTime {
    fn from(time: DateTime) -> Self {
        OffsetDateTime::from_unix_timestamp_nanos(i128::from(time.ticks() - UNIX_EPOCH_TICKS) * 100)
            .expect("every DateTime lies between 1601 and 9999, which OffsetDateTime covers")
    }
}

impl fmt::Display for DateTime {
    /// RFC 3339 with as many fraction digits as needed, at most seven. [`DateTime::MIN`] is the
    /// standard's `0001-01-01T00:00:00Z`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self == Self::MIN {
            return f.write_str("0001-01-01T00:00:00Z");
        }
        let time = OffsetDateTime::from(*self);
        let (date, clock) = (time.date(), time.time());
        write!(
            f,
            "{:04}-{:02}-{:02}T{:02}:{:02}:{:02}",
            date.year(),
            u8::from(date.month()),
            date.day(),
            clock.hour(),
            clock.minute(),
            clock.second()
        )?;
        let mut fraction = clock.nanosecond() / 100;
        if fraction != 0 {
            let mut digits = 7;
            while fraction % 10 == 0 {
                fraction /= 10;
                digits -= 1;
            }
            write!(f, ".{fraction:0digits$}")?;
        }
        f.write_str("Z")
    }
}

impl FromStr for DateTime {
    type Err = InvalidDateTime;

    /// Any RFC 3339 time; an offset is converted, digits beyond 100 ns are dropped, years before
    /// 1601 are [`DateTime::MIN`].
    fn from_str(text: &str) -> Result<Self, InvalidDateTime> {
        let invalid = || InvalidDateTime { found: text.chars().take(80).collect() };
        if text.len() > 64 {
            return Err(invalid());
        }
        OffsetDateTime::parse(text, &Rfc3339).map(Self::from).map_err(|_| invalid())
    }
}

impl Serialize for DateTime {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for DateTime {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Cow::<'de, str>::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_survives() {
        for text in [
            "2019-04-18T18:20:30Z",
            "2019-03-26T18:28:54.2940194Z",
            "2019-03-26T18:28:54.5Z",
            "0001-01-01T00:00:00Z",
            "9999-12-31T23:59:59Z",
        ] {
            assert_eq!(text.parse::<DateTime>().map(|t| t.to_string()), Ok(text.to_owned()));
        }
        assert_eq!(
            "2019-04-18T20:20:30.00000019+02:00".parse::<DateTime>().map(|t| t.to_string()),
            Ok("2019-04-18T18:20:30.0000001Z".into())
        );
        assert!("yesterday".parse::<DateTime>().is_err());
    }

    #[test]
    fn steps_round_down() {
        let time: DateTime = "2019-04-18T18:20:37.9Z".parse().expect("valid");
        assert_eq!(
            time.floor_to(std::time::Duration::from_secs(15)).to_string(),
            "2019-04-18T18:20:30Z"
        );
        assert_eq!(time.version_time(), 608_926_837);
    }
}
