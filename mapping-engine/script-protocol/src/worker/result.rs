//! Limits and checks of what a script returns. The same for every engine, so that a mapping behaves
//! the same in each.

use std::sync::Arc;

use crate::{FaultKind, ScriptFault, ScriptValue, message::STATE_BYTES_MAX, value::DEPTH_MAX};

/// Most elements of a result, those of nested lists and records included.
pub const ELEMENTS_MAX: usize = 65_536;
/// Longest text or byte string of a result, in bytes.
pub const TEXT_BYTES_MAX: usize = 65_536;

/// Number of elements that a result may still have.
#[derive(Debug)]
pub struct ResultBudget {
    left: usize,
}

impl Default for ResultBudget {
    fn default() -> Self {
        Self { left: ELEMENTS_MAX }
    }
}

impl ResultBudget {
    /// Counts one element at a depth; 0 is the result itself.
    ///
    /// # Errors
    /// [`ScriptFault`] where the result nests too deep or has too many elements.
    pub fn take(&mut self, depth: usize) -> Result<(), ScriptFault> {
        if depth > DEPTH_MAX || self.left == 0 {
            return Err(invalid(format!(
                "a result nests at most {DEPTH_MAX} deep and has at most {ELEMENTS_MAX} elements"
            )));
        }
        self.left -= 1;
        Ok(())
    }

    /// Checks the length of a list before its elements are read.
    ///
    /// # Errors
    /// [`ScriptFault`] where the result would have too many elements.
    pub fn check_list(&self, length: usize) -> Result<(), ScriptFault> {
        if length > self.left {
            return Err(invalid(format!("a result has at most {ELEMENTS_MAX} elements")));
        }
        Ok(())
    }
}

/// Returns the fault of a result that is not a value.
#[must_use]
pub fn invalid(message: impl Into<Arc<str>>) -> ScriptFault {
    ScriptFault::new(FaultKind::Result, message)
}

/// Returns the fault of a promise.
#[must_use]
pub fn promise() -> ScriptFault {
    invalid("the script must return a value, not a promise: async functions do not work here")
}

/// Returns the fault of a `BigInt` that fits neither `i64` nor `u64`.
#[must_use]
pub fn wide_big_int() -> ScriptFault {
    invalid("the BigInt is beyond 64 bits")
}

/// Returns a text as a value.
///
/// # Errors
/// [`ScriptFault`] beyond [`TEXT_BYTES_MAX`].
pub fn text(text: String) -> Result<ScriptValue, ScriptFault> {
    if text.len() > TEXT_BYTES_MAX {
        return Err(invalid(format!("a text has at most {TEXT_BYTES_MAX} bytes")));
    }
    Ok(ScriptValue::Text(text.into()))
}

/// Checks the length of a `Uint8Array`, in bytes, before it is copied.
///
/// # Errors
/// [`ScriptFault`] beyond [`TEXT_BYTES_MAX`].
pub fn check_bytes(length: usize) -> Result<(), ScriptFault> {
    if length > TEXT_BYTES_MAX {
        return Err(invalid(format!("a Uint8Array has at most {TEXT_BYTES_MAX} bytes")));
    }
    Ok(())
}

/// Returns a `Date`, in milliseconds since 1970, as a value.
///
/// # Errors
/// [`ScriptFault`] for an invalid `Date`, whose time is NaN.
pub fn time(ms: f64) -> Result<ScriptValue, ScriptFault> {
    if ms.is_nan() { Err(invalid("the Date is invalid")) } else { Ok(ScriptValue::Time(ms)) }
}

/// Returns the `status` member of a result as OPC UA status code; `None` stands for a member that is
/// not a number.
///
/// # Errors
/// [`ScriptFault`] for anything but an integer of 32 bits.
pub fn status(number: Option<f64>) -> Result<u32, ScriptFault> {
    match number.filter(|n| n.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(n)) {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        Some(number) => Ok(number as u32),
        None => Err(invalid("\"status\" must be an OPC UA status code, a number from 0 to 2^32-1")),
    }
}

/// Returns `ctx.state` as JSON where it differs from the state before. A state that was removed is
/// `null`.
///
/// # Errors
/// [`ScriptFault`] beyond [`STATE_BYTES_MAX`].
pub fn changed_state(
    json: Option<String>,
    before: Option<&str>,
) -> Result<Option<Arc<str>>, ScriptFault> {
    if json.as_ref().is_some_and(|json| json.len() > STATE_BYTES_MAX) {
        return Err(invalid(format!("ctx.state has at most {STATE_BYTES_MAX} bytes as JSON")));
    }
    let json = json.or_else(|| before.map(|_| "null".to_owned()));
    Ok(json.filter(|new| before != Some(new)).map(Arc::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_is_sent_where_it_changed() {
        for (json, before, expected) in [
            (None, None, None),
            (Some("1"), None, Some("1")),
            (Some("1"), Some("1"), None),
            (Some("2"), Some("1"), Some("2")),
            (None, Some("1"), Some("null")),
            (None, Some("null"), None),
        ] {
            let changed = changed_state(json.map(str::to_owned), before).expect("short");
            assert_eq!(changed.as_deref(), expected, "{before:?} to {json:?}");
        }
        assert!(changed_state(Some("x".repeat(STATE_BYTES_MAX + 1)), None).is_err());
    }

    #[test]
    fn a_status_is_an_integer_of_32_bits() {
        assert_eq!(status(Some(2_147_483_648.0)), Ok(0x8000_0000));
        for number in [None, Some(-1.0), Some(0.5), Some(4_294_967_296.0), Some(f64::NAN)] {
            assert!(status(number).is_err(), "{number:?}");
        }
    }

    #[test]
    fn a_result_has_a_bounded_number_of_elements_and_levels() {
        let mut budget = ResultBudget::default();
        assert!(budget.take(DEPTH_MAX + 1).is_err());
        for _ in 0..ELEMENTS_MAX {
            assert_eq!(budget.take(DEPTH_MAX), Ok(()));
        }
        assert!(budget.take(0).is_err());
        assert!(budget.check_list(1).is_err());
    }
}
