//! Second model of a gate: what may be released, computed from the events alone and without the
//! gate's code. Numbers are whole hundredths here.

use asi_model::{Scalar, StatusCode, Variant, values::Array};

use super::{strategies::other, *};
use crate::{StateValue, StatusCodes, WithholdCondition};

/// Type of the tested field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Whole,
    Number,
    Text,
}

impl Kind {
    pub(super) const fn field_type(self) -> BuiltInType {
        match self {
            Self::Whole => BuiltInType::Int64,
            Self::Number => BuiltInType::Double,
            Self::Text => BuiltInType::String,
        }
    }
}

/// A candidate that may still be released.
struct Possible {
    raw: DataValue,
    /// Its forms under the policies since it came.
    forms: Vec<DataValue>,
    /// Time from which on its delay counts: its arrival, or the end of its window.
    from: u64,
    /// True for a value of a window, with the status and time of the window.
    is_of_window: bool,
}

/// Knowledge about a gate from outside.
pub(super) struct Model {
    kind: Kind,
    policy: DisclosurePolicy,
    possible: Vec<Possible>,
    /// The last usable value since the source or the own conditions changed.
    usable: Option<Variant>,
    is_state_forgotten: bool,
    foreign: Option<bool>,
    /// Time since which values count for windows; always without it.
    covered_from: Option<u64>,
}

impl Model {
    pub(super) fn new(kind: Kind, policy: DisclosurePolicy) -> Self {
        Self {
            kind,
            policy,
            possible: Vec::new(),
            usable: None,
            is_state_forgotten: false,
            foreign: None,
            covered_from: None,
        }
    }

    pub(super) fn policy(&self) -> &DisclosurePolicy {
        &self.policy
    }

    pub(super) const fn state(&mut self, is_withheld: Option<bool>) {
        self.foreign = is_withheld;
    }

    pub(super) fn candidate(&mut self, now: u64, raw: &DataValue) {
        if !raw.status.is_bad() && !raw.value.is_null() {
            self.usable = Some(raw.value.clone());
        }
        if self.is_withheld() {
            return;
        }
        // Of a window that is not covered whole nothing leaves; its last value is the first one of
        // the next window.
        let window = self.policy.aggregate.map(|aggregate| {
            let end = window_end(now, aggregate.window_ms);
            let is_whole = self.covered_from.is_none_or(|from| end >= from + aggregate.window_ms);
            if is_whole { end } else { end + aggregate.window_ms }
        });
        self.possible.push(Possible {
            raw: raw.clone(),
            forms: vec![coarse(self.kind, &self.policy, raw)],
            from: window.unwrap_or(now),
            is_of_window: window.is_some(),
        });
    }

    /// Notes that another source begins.
    pub(super) fn source(&mut self, now: u64) {
        self.possible.clear();
        self.covered_from = Some(now);
        (self.usable, self.is_state_forgotten) = (None, true);
    }

    pub(super) fn change(&mut self, now: u64, policy: DisclosurePolicy) {
        let former = std::mem::replace(&mut self.policy, policy);
        let has_other_windows = former.aggregate != self.policy.aggregate;
        let added: Vec<&WithholdCondition> = self
            .policy
            .withhold_while
            .iter()
            .filter(|condition| !former.withhold_while.contains(condition))
            .collect();
        if added.iter().any(|condition| condition.field.is_none()) {
            (self.usable, self.is_state_forgotten) = (None, true);
        }
        if !added.is_empty() || has_other_windows {
            self.covered_from = Some(now);
        }
        if !added.is_empty() || (has_other_windows && self.policy.aggregate.is_some()) {
            self.possible.clear();
        } else if has_other_windows {
            // Single values of a window that has not ended.
            self.possible.retain(|possible| possible.from <= now);
        }
        let Self { kind, policy, possible, .. } = self;
        for possible in possible {
            let again = |form: &DataValue| coarse(*kind, policy, form);
            let mut forms: Vec<DataValue> = possible.forms.iter().map(again).collect();
            // Parts that coarsen alike coarsen no second time.
            forms.append(&mut possible.forms);
            if policy.aggregate.is_some() {
                forms.push(coarse(*kind, policy, &possible.raw));
            }
            forms.retain(|form| is_as_coarse(*kind, policy, form));
            possible.forms = forms;
        }
    }

    /// Returns true while nothing may be released.
    pub(super) fn is_withheld(&self) -> bool {
        self.policy.withhold_while.iter().any(|condition| match (&condition.field, &self.usable) {
            (Some(name), _) => {
                assert_eq!(*name, other());
                self.foreign != Some(false)
            }
            (None, None) => self.is_state_forgotten,
            (None, Some(value)) => is_in(value, condition),
        })
    }

    /// Returns true where a candidate explains a release in value, status and times.
    pub(super) fn explains(&self, now: u64, released: &DataValue) -> bool {
        let delay = self.policy.delay_ms.unwrap_or(0);
        self.possible.iter().filter(|possible| possible.from + delay <= now).any(|possible| {
            possible.forms.iter().any(|form| {
                if possible.is_of_window {
                    released.value.is_null() || form.value == released.value
                } else {
                    form == released
                }
            })
        })
    }
}

fn window_end(now: u64, window_ms: u64) -> u64 {
    let start = super::strategies::START_MS.unsigned_abs();
    (start + now) / window_ms * window_ms + window_ms - start
}

fn is_in(value: &Variant, condition: &WithholdCondition) -> bool {
    let is_state = |scalar: &Scalar| {
        condition.states.iter().any(|state| match state {
            #[allow(clippy::cast_precision_loss)]
            StateValue::Integer(state) => scalar.as_f64() == Some(*state as f64),
            StateValue::Text(state) => scalar.as_str() == Some(state.as_str()),
            _ => false,
        })
    };
    match value {
        Variant::Null => false,
        Variant::Scalar(scalar) => is_state(scalar),
        Variant::Array(array) => array.elements.iter().any(is_state),
    }
}

/// Returns true where the policy would let a form pass as it is.
fn is_as_coarse(kind: Kind, policy: &DisclosurePolicy, form: &DataValue) -> bool {
    let again = coarse(kind, policy, form);
    again.status == form.status
        && again.source_timestamp == form.source_timestamp
        && is_number_as_coarse(kind, policy, &form.value)
}

/// Returns true where a number is one that the policy makes of some number: digits are cut after
/// rounding, so that rounding it once more may yield another one.
fn is_number_as_coarse(kind: Kind, policy: &DisclosurePolicy, value: &Variant) -> bool {
    let digits_only = DisclosurePolicy { rounding_step: None, bands: Vec::new(), ..policy.clone() };
    let form = DataValue { value: value.clone(), ..DataValue::default() };
    match policy.significant_digits {
        Some(_) => coarse(kind, &digits_only, &form).value == *value,
        None => coarse(kind, policy, &form).value == *value,
    }
}

/// Coarsens a value as the policy's documentation says.
pub(super) fn coarse(kind: Kind, policy: &DisclosurePolicy, raw: &DataValue) -> DataValue {
    let has_other_type = raw.value.built_in_type().is_some_and(|found| found != kind.field_type());
    let (value, status) = if raw.status.0 >= 0x8000_0000 {
        (Variant::Null, raw.status)
    } else if has_other_type {
        (Variant::Null, StatusCode(0x8074_0000))
    } else {
        let scalar = |scalar: &Scalar| coarse_scalar(policy, scalar);
        let value = match &raw.value {
            Variant::Null => Variant::Null,
            Variant::Scalar(one) => Variant::Scalar(scalar(one)),
            Variant::Array(array) => Variant::Array(Arc::new(Array {
                element_type: array.element_type,
                elements: array.elements.iter().map(scalar).collect(),
                dimensions: array.dimensions.clone(),
            })),
        };
        (value, raw.status)
    };
    let step = policy.time_step_ms.map(|ms| i64::try_from(ms * 1_000).expect("small"));
    let floored = |time: DateTime| match step {
        Some(step) => {
            let micros = time.unix_micros();
            DateTime::from_unix_micros(micros - micros.rem_euclid(step))
        }
        None => time,
    };
    DataValue {
        value,
        status: coarse_status(policy.status_codes, status),
        source_timestamp: raw.source_timestamp.map(floored),
        ..DataValue::default()
    }
}

fn coarse_status(resolution: StatusCodes, status: StatusCode) -> StatusCode {
    const COMMON: [u32; 9] = [
        0,
        0x4000_0000,
        0x4090_0000,
        0x408F_0000,
        0x8000_0000,
        0x809B_0000,
        0x808A_0000,
        0x808D_0000,
        0x8074_0000,
    ];
    match resolution {
        StatusCodes::Full => status,
        StatusCodes::Common if COMMON.contains(&status.0) => status,
        _ => StatusCode([0, 0x4000_0000, 0x8000_0000, 0x8000_0000][(status.0 >> 30) as usize]),
    }
}

#[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss)]
fn coarse_scalar(policy: &DisclosurePolicy, scalar: &Scalar) -> Scalar {
    match scalar {
        Scalar::Int64(number) => {
            let coarse = coarse_number(policy, i128::from(*number), 1);
            Scalar::Int64(i64::try_from(coarse).expect("within the type"))
        }
        Scalar::Double(number) => {
            let hundredths = (number * 100.0).round() as i128;
            assert!(number.to_bits() == (hundredths as f64 / 100.0).to_bits() || *number == 0.0);
            Scalar::Double(coarse_number(policy, hundredths, 100) as f64 / 100.0)
        }
        other => other.clone(),
    }
}

/// Coarsens a number, in parts of one `scale`th.
#[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss)]
fn coarse_number(policy: &DisclosurePolicy, number: i128, scale: i128) -> i128 {
    let fits = |number: i128| scale != 1 || i64::try_from(number).is_ok();
    let nearest = |number: i128, unit: i128| {
        let count = (2 * number.abs() + unit) / (2 * unit);
        let away = number.signum() * count * unit;
        if fits(away) { away } else { number.signum() * (count - 1) * unit }
    };
    let mut coarse = number;
    if !policy.bands.is_empty() {
        let bounds: Vec<i128> =
            policy.bands.iter().map(|bound| (bound * scale as f64).round() as i128).collect();
        coarse = *bounds.iter().rev().find(|bound| **bound <= number).unwrap_or(&bounds[0]);
    } else if let Some(step) = policy.rounding_step {
        coarse = nearest(number, (step.decimal().to_f64() * scale as f64).round() as i128);
    }
    if let Some(digits) = policy.significant_digits {
        let length = coarse.abs().to_string().len();
        if let Some(cut) = length.checked_sub(usize::from(digits)).filter(|cut| *cut > 0) {
            coarse = nearest(coarse, 10_i128.pow(u32::try_from(cut).expect("small")));
        }
    }
    coarse
}
