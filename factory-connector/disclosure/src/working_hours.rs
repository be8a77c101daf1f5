//! Working hours, in which values may be released.

use std::{fmt, str::FromStr, time::Duration};

use asi_model::{DateTime, messages::HoursStatement};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error as _};

/// A day of the week.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
#[allow(missing_docs)]
pub enum Weekday {
    Monday,
    Tuesday,
    Wednesday,
    Thursday,
    Friday,
    Saturday,
    Sunday,
}

impl Weekday {
    /// Returns its name in messages.
    #[must_use]
    pub const fn code(self) -> &'static str {
        match self {
            Self::Monday => "MONDAY",
            Self::Tuesday => "TUESDAY",
            Self::Wednesday => "WEDNESDAY",
            Self::Thursday => "THURSDAY",
            Self::Friday => "FRIDAY",
            Self::Saturday => "SATURDAY",
            Self::Sunday => "SUNDAY",
        }
    }
}

/// A time of day, `HH:MM`, up to and including `24:00`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, utoipa::ToSchema)]
#[schema(value_type = String, pattern = "^[0-2][0-9]:[0-5][0-9]$", example = "06:00")]
pub struct ClockTime(u16);

impl ClockTime {
    /// Returns the minutes since midnight, 0 to 1440.
    #[must_use]
    pub const fn minutes(self) -> u16 {
        self.0
    }
}

impl FromStr for ClockTime {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let parse = || {
            let (hours, minutes) = text.split_once(':')?;
            let (hours, minutes): (u16, u16) = (hours.parse().ok()?, minutes.parse().ok()?);
            (minutes < 60 && hours * 60 + minutes <= 1440).then_some(Self(hours * 60 + minutes))
        };
        if text.len() == 5 { parse() } else { None }.ok_or_else(|| {
            format!(
                "a time of day must look like 06:30, but is {:?}",
                text.get(..20).unwrap_or(text)
            )
        })
    }
}

impl fmt::Display for ClockTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:02}:{:02}", self.0 / 60, self.0 % 60)
    }
}

impl Serialize for ClockTime {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for ClockTime {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(D::Error::custom)
    }
}

/// Hours in which values may be released. Of changes outside of them, the newest is released when
/// they begin.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct WorkingHours {
    pub days: Vec<Weekday>,
    /// The first minute, `HH:MM`.
    pub from: ClockTime,
    /// The first minute after them, `HH:MM`; later than `from`.
    pub until: ClockTime,
    /// Offset of the plant's clock from UTC, in minutes; positive to the east.
    #[serde(default)]
    pub utc_offset_minutes: i16,
}

const DAYS: [Weekday; 7] = [
    Weekday::Monday,
    Weekday::Tuesday,
    Weekday::Wednesday,
    Weekday::Thursday,
    Weekday::Friday,
    Weekday::Saturday,
    Weekday::Sunday,
];
const MILLIS_PER_MINUTE: i64 = 60_000;
const MILLIS_PER_DAY: i64 = 86_400_000;

impl WorkingHours {
    /// Returns the first instant from `at` on within the hours; `None` if there is none in a week.
    #[must_use]
    pub fn first_open(&self, at: DateTime) -> Option<DateTime> {
        let offset = i64::from(self.utc_offset_minutes) * MILLIS_PER_MINUTE;
        let local = at.unix_millis() + offset;
        let midnight = local - local.rem_euclid(MILLIS_PER_DAY);
        (0..=7).find_map(|ahead| {
            let day = midnight + ahead * MILLIS_PER_DAY;
            // 1970-01-01 was a Thursday.
            let weekday =
                usize::try_from((day.div_euclid(MILLIS_PER_DAY) + 3).rem_euclid(7)).ok()?;
            let opens = day + i64::from(self.from.minutes()) * MILLIS_PER_MINUTE;
            let closes = day + i64::from(self.until.minutes()) * MILLIS_PER_MINUTE;
            if !self.days.contains(&DAYS[weekday]) || local >= closes {
                return None;
            }
            let open = opens.max(local);
            Some(if open == local {
                at
            } else {
                DateTime::from_unix_micros((open - offset) * 1_000)
            })
        })
    }

    /// The hours in words.
    #[must_use]
    pub fn describe(&self) -> String {
        let days: Vec<String> =
            self.days.iter().map(|day| format!("{day:?}")[..3].to_owned()).collect();
        format!("only {} from {} until {}", days.join(", "), self.from, self.until)
    }

    /// Returns the same as members of a message.
    #[must_use]
    pub fn statement(&self) -> HoursStatement {
        HoursStatement {
            day_list: self.days.iter().map(|day| day.code().to_owned()).collect(),
            from: self.from.to_string(),
            until: self.until.to_string(),
            utc_offset_minutes: self.utc_offset_minutes,
        }
    }

    /// Returns the longest time for which hours can withhold a value.
    #[must_use]
    pub const fn longest_pause() -> Duration {
        Duration::from_secs(7 * 86_400)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opens_on_the_next_working_day() {
        let hours = WorkingHours {
            days: vec![Weekday::Monday, Weekday::Friday],
            from: "06:00".parse().expect("a time"),
            until: "22:00".parse().expect("a time"),
            utc_offset_minutes: 60,
        };
        for (at, open) in [
            ("2026-11-20T12:00:00Z", Some("2026-11-20T12:00:00Z")),
            ("2026-11-20T21:00:00Z", Some("2026-11-23T05:00:00Z")),
            ("2026-11-20T04:59:59.9Z", Some("2026-11-20T05:00:00Z")),
            ("2026-11-21T12:00:00Z", Some("2026-11-23T05:00:00Z")),
        ] {
            let found = hours.first_open(at.parse().expect("a time")).map(|t| t.to_string());
            assert_eq!(found.as_deref(), open, "{at}");
        }
        for text in ["24:01", "6:00", "06:60", "ab:cd", ""] {
            assert!(text.parse::<ClockTime>().is_err(), "{text}");
        }
    }
}
