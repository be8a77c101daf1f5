//! Values of which something may be shown, and what may be made of them. Computed without the gate's
//! code.

use asi_model::{
    BuiltInType, Scalar, Variant,
    opcua_json::{DataEncoding, encode_variant},
};
use disclosure::WorkingHours;

use super::*;

/// Part of the longest rounding step by which a number may differ from what is made of it.
const ROUNDED_PART: f64 = 0.9;

/// A candidate of which something may be shown.
#[derive(Debug, Clone)]
pub(super) struct Possible {
    pub(super) value: DataValue,
    pub(super) arrived_at: DateTime,
    /// The longest rounding step since it came; endless for bands.
    pub(super) step: f64,
    /// The largest part of a number that its significant digits hid since it came.
    pub(super) hidden_part: f64,
    /// The time steps since it came, one after the other.
    pub(super) time_steps: Vec<Duration>,
    /// True where its window ended before the clock was set back.
    pub(super) is_window_over: bool,
    /// End of the window in which it came, where the clock was set back behind that window's begin: it counts
    /// from then on.
    pub(super) window_end: Option<DateTime>,
    /// True where it might be shown before the clock was set back; it still may.
    pub(super) was_due: bool,
}

impl Possible {
    /// Returns the time from which the delay counts.
    pub(super) fn counts_from(&self, window: Duration) -> DateTime {
        if window.is_zero() || self.is_window_over {
            self.arrived_at
        } else {
            let end = self.arrived_at.floor_to(window).after(window);
            self.window_end.map_or(end, |other| other.min(end))
        }
    }

    pub(super) fn is_due(&self, window: Duration, delay: Duration, now: DateTime) -> bool {
        self.was_due || self.counts_from(window).after(delay) <= now
    }

    pub(super) fn elements(&self) -> Vec<f64> {
        match &self.value.value {
            Variant::Array(array) => array.elements.iter().filter_map(Scalar::as_f64).collect(),
            other => other.as_f64().into_iter().collect(),
        }
    }

    /// Returns true where one number may have been made of the other.
    pub(super) fn is_near(&self, raw: f64, shown: f64) -> bool {
        // Rounded again under each policy since it came: a half and a third, as steps do not divide each other.
        (raw - shown).abs() <= ROUNDED_PART * self.step + self.hidden_part * raw.abs()
    }

    /// Returns a time as it is under each time step since it came.
    fn floored(&self, at: DateTime) -> DateTime {
        self.time_steps.iter().fold(at, |at, step| at.floor_to(*step))
    }

    pub(super) fn explains(&self, shown: f64) -> bool {
        matches!(self.elements()[..], [raw] if self.is_near(raw, shown))
    }

    /// Returns true where a value that is no number may have been made of this one.
    pub(super) fn is_shown_by(&self, body: &Value) -> bool {
        let json = encode_variant(&self.value.value, DataEncoding::Reversible104);
        let json: Value = serde_json::from_slice(&json).expect("JSON");
        self.is_made_of(&json["Body"], body)
    }

    /// Compares what is shown with a value member by member; what is left out says nothing.
    fn is_made_of(&self, raw: &Value, shown: &Value) -> bool {
        let time = |value: &Value| serde_json::from_value::<DateTime>(value.clone()).ok();
        match (raw, shown) {
            (_, Value::Null) => true,
            // Checked as a status.
            (Value::Object(raw), Value::Object(_)) if is_status(raw) => true,
            (Value::Object(raw), Value::Object(shown)) => shown.iter().all(|(name, shown)| {
                let is_exact = name.starts_with("Type");
                // Statuses are checked where they are.
                ["Status", "InnerStatusCode"].contains(&name.as_str())
                    || raw.get(name).is_some_and(|raw| {
                        if is_exact { raw == shown } else { self.is_made_of(raw, shown) }
                    })
            }),
            (Value::Array(raw), Value::Array(shown)) => {
                raw.len() == shown.len()
                    && raw.iter().zip(shown).all(|(raw, shown)| self.is_made_of(raw, shown))
            }
            _ => match (time(raw), time(shown), number_of(raw), number_of(shown)) {
                (Some(raw), Some(shown), ..) => self.floored(raw) == shown,
                (.., Some(raw), Some(shown)) => self.is_near(raw, shown),
                _ => raw == shown,
            },
        }
    }
}

/// Returns true for a status code as a value.
fn is_status(members: &serde_json::Map<String, Value>) -> bool {
    members.get("Type").is_some_and(|id| *id == json!(BuiltInType::StatusCode.id()))
}

/// Returns the statuses of values within a value, and the status codes that are values.
pub(super) fn held_statuses(body: &Value) -> Vec<&Value> {
    match body {
        Value::Object(members) if is_status(members) => members.get("Body").into_iter().collect(),
        Value::Object(members) => members
            .iter()
            .flat_map(|(name, value)| {
                let is_status = ["Status", "InnerStatusCode"].contains(&name.as_str());
                if is_status { vec![value] } else { held_statuses(value) }
            })
            .collect(),
        Value::Array(elements) => elements.iter().flat_map(held_statuses).collect(),
        _ => Vec::new(),
    }
}

pub(super) fn number_of(body: &Value) -> Option<f64> {
    body.as_f64().or_else(|| body.as_str().and_then(|text| text.parse().ok()))
}

/// Returns true for a number between the values of which it may be the mean.
pub(super) fn is_mean(values: &[&Possible], shown: f64) -> bool {
    let numbers = || values.iter().flat_map(|possible| possible.elements());
    let room = values.iter().map(|possible| ROUNDED_PART * possible.step).fold(0.0, f64::max);
    let part = values.iter().map(|possible| possible.hidden_part).fold(0.0, f64::max);
    let (least, most) = (numbers().fold(f64::MAX, f64::min), numbers().fold(f64::MIN, f64::max));
    let room = room + part * least.abs().max(most.abs());
    (least - room..=most + room).contains(&shown)
}

/// Returns true for a number of at most the sum of all values.
pub(super) fn is_sum(values: &[&Possible], shown: f64) -> bool {
    let room = values.iter().map(|possible| ROUNDED_PART * possible.step).fold(0.0, f64::max);
    let part = values.iter().map(|possible| possible.hidden_part).fold(0.0, f64::max);
    let sum: f64 = values.iter().flat_map(|possible| possible.elements()).map(f64::abs).sum();
    shown.abs() <= sum * (1.0 + part) + room
}

/// Returns true within hours, computed without the gate's code.
pub(super) fn is_within(hours: &WorkingHours, at: DateTime) -> bool {
    const MINUTES_PER_DAY: i64 = 24 * 60;
    let local = at.unix_millis().div_euclid(60_000) + i64::from(hours.utc_offset_minutes);
    // 1970-01-01 was a Thursday.
    let day = (local.div_euclid(MINUTES_PER_DAY) + 3).rem_euclid(7);
    let days = ["MONDAY", "TUESDAY", "WEDNESDAY", "THURSDAY", "FRIDAY", "SATURDAY", "SUNDAY"];
    let day = json!(days[usize::try_from(day).expect("a day")]);
    let minute = local.rem_euclid(MINUTES_PER_DAY);
    let time = format!("{:02}:{:02}", minute / 60, minute % 60);
    hours.days.iter().any(|known| json!(known) == day)
        && hours.from.to_string() <= time
        && time < hours.until.to_string()
}
