//! Second model: what partners may know. It knows candidates, decisions and policies, and neither
//! gate nor spool; each report is compared with it when it leaves.

use asi_model::BuiltInType;
use disclosure::{AggregateFunction, DisclosurePolicy, StatusCodes, WithholdCondition};

use super::{
    acts::TIME_STEPS_MS,
    below,
    fields::{FIELDS, FieldOf, PARTNERS, STATE, WITHHELD_STATE, recipients},
    possible::{Possible, held_statuses, is_mean, is_sum, is_within, number_of},
    *,
};

/// Knowledge about a field.
#[derive(Debug, Default)]
struct Known {
    /// The policy of the decision; none while it is not mapped.
    own: Option<DisclosurePolicy>,
    source: usize,
    possible: Vec<Possible>,
    /// End of a window behind whose begin the clock was set back.
    window_end: Option<DateTime>,
    /// Times of releases; they go on to count over decisions.
    released: Vec<DateTime>,
    /// Times of releases while a rate was in force.
    rated: Vec<DateTime>,
    /// Functions of the windows since the values began: what one of them made may wait longer than
    /// its policy is in force.
    functions: Vec<AggregateFunction>,
}

#[derive(Debug, Default)]
pub(super) struct Knower {
    fields: [Known; FIELDS.len()],
    named: [Option<DisclosurePolicy>; 2],
    of_partner: [Option<usize>; PARTNERS.len()],
    bits: Option<u8>,
    /// The last value of the field at whose state others look is the one that withholds.
    is_in_state: bool,
}

impl Knower {
    /// Notes candidates that come together.
    pub(super) fn offer<'v>(
        &mut self,
        batch: impl Iterator<Item = (usize, &'v DataValue)>,
        now: DateTime,
    ) {
        let batch: Vec<_> = batch.filter(|(field, _)| self.fields[*field].own.is_some()).collect();
        let is_state = |value: &DataValue| value.value.as_f64() == Some(WITHHELD_STATE.into());
        let states =
            || batch.iter().filter(|(field, value)| *field == STATE && !value.status.is_bad());
        let is_any_in_state = states().any(|(_, value)| is_state(value));
        for (field, value) in &batch {
            // In the order in which they came: the state may have ended just before.
            if *field == STATE && !value.status.is_bad() {
                self.is_in_state = is_state(value);
            }
            let is_in_state = is_any_in_state || self.is_in_state;
            let is_withheld = self.conditions(*field).iter().any(|condition| {
                if condition.field.is_some() { is_in_state } else { is_state(value) }
            });
            let is_usable = !value.status.is_bad()
                && value.value.built_in_type() == Some(FIELDS[*field].field_type);
            let possible = Possible {
                value: (*value).clone(),
                arrived_at: now,
                step: self.step(*field),
                hidden_part: self.hidden_part(*field),
                time_steps: vec![self.time_step(*field)],
                is_window_over: false,
                window_end: self.fields[*field].window_end.filter(|end| now < *end),
                was_due: false,
            };
            self.fields[*field]
                .possible
                .extend(Some(possible).filter(|_| is_usable && !is_withheld));
        }
    }

    pub(super) fn open(&mut self, field: usize, source: usize, policy: DisclosurePolicy) {
        let (was_mapped, former) = (self.fields[field].own.is_some(), self.fields[field].source);
        if !was_mapped || former != source {
            self.begin(field, source);
        }
        self.change(|knower| knower.fields[field].own = Some(policy));
    }

    pub(super) fn close(&mut self, field: usize) {
        self.fields[field].own = None;
        self.begin(field, 0);
    }

    pub(super) fn import(&mut self, field: usize, source: usize) {
        let known = &self.fields[field];
        if known.own.is_some() && known.source >= 2 && known.source != source {
            self.begin(field, source);
        }
    }

    pub(super) fn name_policy(&mut self, name: usize, policy: &DisclosurePolicy) {
        self.change(|knower| knower.named[name] = Some(policy.clone()));
    }

    pub(super) fn set_recipient(&mut self, partner: usize, name: Option<usize>) {
        self.change(|knower| knower.of_partner[partner] = name);
    }

    /// Notes other recipients of the first request, with the fields that are still mapped.
    pub(super) fn revise(&mut self, bits: u8, is_mapped: [bool; FIELDS.len()]) {
        self.change(|knower| knower.bits = Some(bits));
        for (field, is_mapped) in is_mapped.into_iter().enumerate() {
            if !is_mapped && self.fields[field].own.is_some() {
                self.close(field);
            }
        }
    }

    /// The state that a machine shown is not known after a restart.
    pub(super) const fn restart(&mut self) {
        self.is_in_state = false;
    }

    pub(super) fn set_clock_back(&mut self, former: DateTime, now: DateTime) {
        for field in 0..FIELDS.len() {
            let (window, delay) = (self.window(field), self.delay(field));
            let Known { possible, window_end, released, rated, .. } = &mut self.fields[field];
            let is_behind = |possible: &Possible| possible.arrived_at.floor_to(window) > now;
            if !window.is_zero() && possible.iter().any(is_behind) {
                *window_end = Some(now.after(window));
            }
            for released in released.iter_mut().chain(rated) {
                *released = (*released).min(now);
            }
            for possible in &mut self.fields[field].possible {
                let from = possible.counts_from(window);
                possible.was_due = possible.is_due(window, delay, former);
                possible.is_window_over |= from <= former;
                let at = if possible.is_window_over { from } else { possible.arrived_at };
                possible.arrived_at = at.min(now);
            }
        }
    }

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
                self.check_value(field, value, now);
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

    /// Begins another source or consent: nothing of before may be shown.
    fn begin(&mut self, field: usize, source: usize) {
        self.forget(field);
        self.fields[field].source = source;
        if field == STATE {
            self.is_in_state = false;
        }
    }

    fn forget(&mut self, field: usize) {
        self.fields[field].possible.clear();
        self.fields[field].functions.clear();
    }

    /// Changes policies. What came before a condition, or as a single value before a window, may
    /// not be shown any more.
    fn change(&mut self, change: impl FnOnce(&mut Self)) {
        let windows = |knower: &Self, field: usize| {
            let aggregates = knower.policies(field).filter_map(|policy| policy.aggregate);
            aggregates.max_by_key(|aggregate| (aggregate.window_ms, aggregate.function))
        };
        let before: Vec<_> = (0..FIELDS.len())
            .map(|field| (self.conditions(field), windows(self, field), self.delay(field)))
            .collect();
        change(self);
        for (field, (conditions, window, delay)) in before.into_iter().enumerate() {
            let (now, other) = (self.conditions(field), windows(self, field));
            let is_added = now.iter().any(|condition| !conditions.contains(condition));
            if is_added || (other.is_some() && other != window) {
                self.forget(field);
            }
            let functions = self.policies(field).filter_map(|policy| policy.aggregate);
            let functions: Vec<_> = functions.map(|aggregate| aggregate.function).collect();
            self.fields[field].functions.extend(functions);
            if other != window {
                self.fields[field].window_end = None;
            }
            let (step, is_later) = (self.step(field), self.delay(field) > delay);
            let (part, time_step) = (self.hidden_part(field), self.time_step(field));
            for possible in &mut self.fields[field].possible {
                possible.step = possible.step.max(step);
                possible.hidden_part = possible.hidden_part.max(part);
                if possible.time_steps.last() != Some(&time_step) {
                    possible.time_steps.push(time_step);
                }
                possible.was_due &= !is_later;
            }
        }
    }

    fn recipients(&self, request: usize) -> Vec<&'static str> {
        recipients(request, self.bits.unwrap_or(0b11))
    }

    /// Returns all policies in force for a mapped field.
    fn policies(&self, field: usize) -> impl Iterator<Item = DisclosurePolicy> {
        let of = &FIELDS[field];
        let own = self.fields[field].own.iter().cloned();
        let readers = self.recipients(of.request);
        let partners = PARTNERS.iter().zip(&self.of_partner);
        let partners = partners.filter(move |(partner, _)| readers.contains(*partner));
        let named = partners.filter_map(|(_, name)| self.named[(*name)?].as_ref());
        own.chain(named.map(|policy| policy.fitted_to(of.field_type, of.is_array)))
    }

    fn conditions(&self, field: usize) -> Vec<WithholdCondition> {
        self.policies(field).flat_map(|policy| policy.withhold_while).collect()
    }

    fn step(&self, field: usize) -> f64 {
        let steps = self.policies(field).filter_map(|policy| policy.rounding_step);
        let steps = steps.filter_map(|step| step.to_string().parse::<f64>().ok());
        let is_banded = self.policies(field).any(|policy| !policy.bands.is_empty());
        if is_banded { f64::INFINITY } else { steps.fold(1.0, f64::max) }
    }

    fn hidden_part(&self, field: usize) -> f64 {
        let digits = self.policies(field).filter_map(|policy| policy.significant_digits).min();
        digits.map_or(0.0, |digits| 0.6 * 10_f64.powi(1 - i32::from(digits)))
    }

    fn time_step(&self, field: usize) -> Duration {
        self.longest(field, DisclosurePolicy::time_step)
    }

    fn delay(&self, field: usize) -> Duration {
        self.longest(field, DisclosurePolicy::delay)
    }

    fn window(&self, field: usize) -> Duration {
        let window =
            |policy: &DisclosurePolicy| policy.aggregate.map(|aggregate| aggregate.window());
        self.longest(field, |policy| window(policy).unwrap_or_default())
    }

    fn longest(&self, field: usize, part: impl Fn(&DisclosurePolicy) -> Duration) -> Duration {
        self.policies(field).map(|policy| part(&policy)).max().unwrap_or_default()
    }
}
