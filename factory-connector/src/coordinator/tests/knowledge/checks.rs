//! Checks of what leaves against the second model.

use asi_model::BuiltInType;
use disclosure::{AggregateFunction, DisclosurePolicy, StatusCodes};

use super::{
    acts::TIME_STEPS_MS,
    below,
    fields::{FIELDS, FieldOf},
    knower::{Knower, Known},
    possible::{Possible, held_statuses, is_mean, is_sum, is_within, number_of},
    *,
};

impl Knower {
    /// Checks a report at the moment in which it leaves.
    pub(super) fn check(&self, report: &Value, now: DateTime) {
        let payload = &report["Payload"];
        let request = payload["dynamicDataRequestId"]["Body"].as_str().expect("a request");
        let request = usize::from(request == "R1");
        let stated: Vec<&str> = payload["recipientList"]["Body"]
            .as_array()
            .expect("recipients")
            .iter()
            .filter_map(Value::as_str)
            .collect();
        assert_eq!(stated, self.recipients(request), "who may read {report}");
        self.check_fields(request, report, |field, body| self.check_value(field, body, now));
    }

    /// Checks a report that a recipient of the first request is shown after it left for others: it
    /// is no finer than what is open to the recipient now.
    pub(super) fn check_past(&self, report: &Value, partner: &str) {
        let request = &report["Payload"]["dynamicDataRequestId"]["Body"];
        assert_eq!(request, "R0", "the past of another request: {report}");
        assert!(self.recipients(0).contains(&partner), "{partner} is no recipient: {report}");
        let stated = report["Payload"]["recipientList"]["Body"].to_string();
        assert!(!stated.contains(partner), "{partner} has it already: {report}");
        self.check_fields(0, report, |field, body| {
            let of_array = body.as_array().into_iter().flatten();
            let numbers = of_array.chain(Some(body)).filter_map(number_of);
            for number in numbers.filter(|_| FIELDS[field].field_type.is_numeric()) {
                self.check_number(field, number);
            }
        });
    }

    /// Checks times, openness and statuses of a report's fields, and their values as given.
    fn check_fields(&self, request: usize, report: &Value, check_value: impl Fn(usize, &Value)) {
        let payload = &report["Payload"];
        let is_shown = |of: &FieldOf| of.request == request && !payload[of.name].is_null();
        let shown = (0..FIELDS.len()).filter(|field| is_shown(&FIELDS[*field]));
        let longest = shown.map(|field| self.time_step(field)).max().unwrap_or_default();
        for time in [&report["Timestamp"], &payload["shopfloorTimestamp"]["Body"]] {
            let time: DateTime = serde_json::from_value(time.clone()).expect("a time");
            // One that waited is on the step of its time, where that was longer.
            let steps = TIME_STEPS_MS.map(Duration::from_millis).into_iter();
            let mut steps = steps.filter(|step| *step >= longest);
            let is_coarse = longest.is_zero() || steps.any(|step| time.floor_to(step) == time);
            assert!(is_coarse, "its fields have a step of {longest:?}: {report}");
        }
        for (field, of) in FIELDS.iter().enumerate().filter(|(_, of)| of.request == request) {
            let member = &payload[of.name];
            if member.is_null() {
                continue;
            }
            assert!(self.fields[field].own.is_some(), "{} is not disclosed: {report}", of.name);
            // A value with a status has another form, and so has a status without a value.
            let is_of = |kind: BuiltInType| member["Type"] == json!(kind.id());
            let (status, value) = if is_of(BuiltInType::StatusCode) {
                (&member["Body"], &Value::Null)
            } else if is_of(BuiltInType::DataValue) && !member["Body"].is_array() {
                (&member["Body"]["Status"], &member["Body"]["Value"]["Body"])
            } else {
                (&Value::Null, &member["Body"])
            };
            self.check_status(field, status);
            if !value.is_null() {
                for status in held_statuses(value) {
                    self.check_status(field, status);
                }
                check_value(field, value);
            }
        }
    }

    fn check_status(&self, field: usize, status: &Value) {
        let code = status.as_u64().unwrap_or_default();
        let is_severity = [0, 0x4000_0000, 0x8000_0000].contains(&code);
        let is_common = below::COMMON.iter().any(|common| u64::from(*common) == code);
        for policy in self.policies(field) {
            let is_coarse = match policy.status_codes {
                StatusCodes::Full => true,
                StatusCodes::Common => is_common,
                // The gate says that a value has another type than the field.
                StatusCodes::Severity => is_severity || code == 0x8074_0000,
            };
            assert!(is_coarse, "{} tells the status {code:#x}, by {policy:?}", FIELDS[field].name);
        }
    }

    fn check_value(&self, field: usize, body: &Value, now: DateTime) {
        let of = &FIELDS[field];
        if of.field_type == BuiltInType::StatusCode {
            return self.check_status(field, body);
        }
        let elements: Vec<f64> = match body {
            Value::Array(elements) => elements.iter().filter_map(number_of).collect(),
            other => number_of(other).into_iter().collect(),
        };
        for number in elements.iter().filter(|_| of.field_type.is_numeric()) {
            self.check_number(field, *number);
        }
        let (window, delay) = (self.window(field), self.delay(field));
        let known = &self.fields[field];
        let due: Vec<&Possible> =
            known.possible.iter().filter(|possible| possible.is_due(window, delay, now)).collect();
        let functions = &known.functions;
        let is_explained = match elements[..] {
            [number] if of.field_type.is_numeric() && !of.is_array => {
                due.iter().any(|possible| possible.explains(number))
                    || (functions.contains(&AggregateFunction::Mean) && is_mean(&due, number))
                    || (functions.contains(&AggregateFunction::Sum) && is_sum(&due, number))
            }
            _ if of.field_type.is_numeric() => due.iter().any(|possible| {
                let raw = possible.elements();
                let pairs = raw.iter().zip(&elements);
                raw.len() == elements.len()
                    && pairs.into_iter().all(|(raw, shown)| possible.is_near(*raw, *shown))
            }),
            _ => due.iter().any(|possible| possible.is_shown_by(body)),
        };
        assert!(
            is_explained,
            "{} tells {body} at {now}, by {:?} of {:?}",
            of.name,
            self.policies(field).collect::<Vec<_>>(),
            known.possible,
        );
    }

    /// Checks that a number is no finer than the policies in force.
    fn check_number(&self, field: usize, number: f64) {
        let name = FIELDS[field].name;
        let bounds: Vec<f64> = self.policies(field).flat_map(|policy| policy.bands).collect();
        let digits = self.policies(field).filter_map(|policy| policy.significant_digits).min();
        if !bounds.is_empty() {
            assert!(bounds.contains(&number), "{name} is finer than its bands: {number}");
        } else if self.policies(field).any(|policy| policy.rounding_step.is_some()) {
            // Cut to its digits, a multiple of such a step is one of a power of ten only.
            let step = self.step(field);
            let is_on_step = number % step == 0.0 || (digits.is_some() && step % 100.0 == 50.0);
            assert!(is_on_step, "{name} is finer than its step: {number}");
        }
        if let Some(digits) = digits {
            let text = format!("{}", number.abs());
            let shown = text.replace('.', "");
            let shown = shown.trim_matches('0').len();
            assert!(shown <= digits.into(), "{name} has more than {digits} digits: {number}");
        }
    }

    /// Checks a release at the moment in which it happens: interval, rates, hours and time step.
    pub(super) fn check_release(&mut self, field: usize, at: DateTime) {
        let name = FIELDS[field].name;
        let step = self.time_step(field);
        // After a restart timers may be late by a part of the step.
        let lateness = (step / 10).min(Duration::from_secs(5));
        let is_on_step = at.since(at.floor_to(step)) <= lateness;
        assert!(is_on_step, "{name} is released between two steps: {at}");
        for policy in self.policies(field) {
            for hours in policy.working_hours.iter().chain(&policy.further_hours) {
                assert!(is_within(hours, at), "{name} is released at {at}, outside of {hours:?}");
            }
            for limit in &policy.rate_limits {
                let period = Duration::from_millis(limit.period_ms);
                let released = self.fields[field].rated.iter();
                let count = released.filter(|released| released.after(period) > at).count();
                assert!(count < limit.values as usize, "{name} exceeds {limit:?} at {at}");
            }
        }
        let interval = self.longest(field, DisclosurePolicy::minimum_interval);
        let has_rate = self.policies(field).any(|policy| !policy.rate_limits.is_empty());
        let Known { released, rated, .. } = &mut self.fields[field];
        if let Some(last) = released.last() {
            assert!(last.after(interval) <= at, "{name}: {at} is too soon after {last}");
        }
        released.push(at);
        rated.extend(Some(at).filter(|_| has_rate));
    }
}
