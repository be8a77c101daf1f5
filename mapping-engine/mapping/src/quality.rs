//! Status and times along a chain.
//!
//! The rules, in one place:
//! 1. A result has the worst status of the inputs it was made from: Bad before Uncertain before
//!    Good; among equals that of the first input.
//! 2. A result has the newest source time of the inputs it was made from, and their newest server
//!    time. No function makes up a time; a value that passes later (debounce, a window that
//!    empties) keeps the time of its sample.
//! 3. A Bad input is not evaluated: the candidate has no value and the input's status. State stays
//!    as it is.
//! 4. An Uncertain input is evaluated; its status goes with the result.
//! 5. An input whose source is away keeps its last value, as Uncertain
//!    (UncertainNoCommunicationLastUsableValue).
//! 6. A function that cannot make a value of what it got yields a candidate without value whose
//!    status says why.
//! 7. `merge` with `newest` and `firstGood` uses the one input it picks; the status of the others
//!    does not matter.
//! 8. Once inputs are better again and the chain has nothing new to say, the last value is shown
//!    again.

use asi_model::{DataValue, DateTime, StatusCode, Variant};

/// Status and times without the value.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Meta {
    pub status: StatusCode,
    pub source_timestamp: Option<DateTime>,
    pub source_picoseconds: u16,
    pub server_timestamp: Option<DateTime>,
    pub server_picoseconds: u16,
}

impl Meta {
    /// Returns status and times of a value.
    pub fn of(value: &DataValue) -> Self {
        Self {
            status: value.status,
            source_timestamp: value.source_timestamp,
            source_picoseconds: value.source_picoseconds,
            server_timestamp: value.server_timestamp,
            server_picoseconds: value.server_picoseconds,
        }
    }

    /// Rules 1 and 2.
    pub fn combine(&mut self, other: &Self) {
        self.status = worst(self.status, other.status);
        let newest =
            |a: (Option<DateTime>, u16), b: (Option<DateTime>, u16)| if b > a { b } else { a };
        (self.source_timestamp, self.source_picoseconds) = newest(
            (self.source_timestamp, self.source_picoseconds),
            (other.source_timestamp, other.source_picoseconds),
        );
        (self.server_timestamp, self.server_picoseconds) = newest(
            (self.server_timestamp, self.server_picoseconds),
            (other.server_timestamp, other.server_picoseconds),
        );
    }

    /// Makes a data value of a value with this status and these times.
    pub fn with(self, value: Variant) -> DataValue {
        DataValue {
            value,
            status: self.status,
            source_timestamp: self.source_timestamp,
            source_picoseconds: self.source_picoseconds,
            server_timestamp: self.server_timestamp,
            server_picoseconds: self.server_picoseconds,
        }
    }

    /// Without value but with another status.
    pub fn failed(mut self, status: StatusCode) -> DataValue {
        self.status = status;
        self.with(Variant::Null)
    }
}

/// The worse of two; the first among equals.
pub(crate) fn worst(a: StatusCode, b: StatusCode) -> StatusCode {
    if severity(b) > severity(a) { b } else { a }
}

/// 0 Good, 1 Uncertain, 2 Bad.
pub(crate) const fn severity(status: StatusCode) -> u32 {
    // 0b11 is reserved; a source that sends it does not mean Good.
    let bits = status.0 >> 30;
    if bits > 2 { 2 } else { bits }
}

/// Returns true where a status means that the source cannot be asked, not that its value is bad.
pub(crate) fn is_source_away(status: StatusCode) -> bool {
    const AWAY: [u32; 6] = [
        StatusCode::BAD_NOT_CONNECTED.0,
        StatusCode::BAD_COMMUNICATION_ERROR.0,
        StatusCode::BAD_SHUTDOWN.0,
        // BadNoCommunication, BadServerNotConnected, BadConnectionClosed.
        0x8031_0000,
        0x800D_0000,
        0x80AE_0000,
    ];
    AWAY.contains(&(status.0 & 0xFFFF_0000))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn meta(status: StatusCode, micros: i64) -> Meta {
        Meta {
            status,
            source_timestamp: Some(DateTime::from_unix_micros(micros)),
            ..Meta::default()
        }
    }

    #[test]
    fn worst_status_and_newest_time_win() {
        for (a, b, status, micros) in [
            (meta(StatusCode::GOOD, 1), meta(StatusCode::GOOD, 2), StatusCode::GOOD, 2),
            (meta(StatusCode::UNCERTAIN, 3), meta(StatusCode::GOOD, 2), StatusCode::UNCERTAIN, 3),
            (
                meta(StatusCode::UNCERTAIN, 1),
                meta(StatusCode::BAD_TIMEOUT, 2),
                StatusCode::BAD_TIMEOUT,
                2,
            ),
            (
                meta(StatusCode::BAD_TIMEOUT, 1),
                meta(StatusCode::BAD_NO_DATA, 1),
                StatusCode::BAD_TIMEOUT,
                1,
            ),
        ] {
            let mut combined = a;
            combined.combine(&b);
            assert_eq!(combined, meta(status, micros));
        }
        let mut combined = meta(StatusCode::GOOD, 5);
        combined.combine(&Meta::default());
        assert_eq!(combined.source_timestamp, Some(DateTime::from_unix_micros(5)));
    }
}
