//! Second model: what partners may know. It knows candidates, decisions and policies, and neither
//! gate nor spool; each report is compared with it when it leaves.

use disclosure::{AggregateFunction, DisclosurePolicy, WithholdCondition};

use super::{
    fields::{FIELDS, PARTNERS, STATE, WITHHELD_STATE, recipients},
    possible::Possible,
    *,
};

/// Knowledge about a field.
#[derive(Debug, Default)]
pub(super) struct Known {
    /// The policy of the decision; none while it is not mapped.
    pub(super) own: Option<DisclosurePolicy>,
    source: usize,
    pub(super) possible: Vec<Possible>,
    /// End of a window behind whose begin the clock was set back.
    window_end: Option<DateTime>,
    /// Times of releases; they go on to count over decisions.
    pub(super) released: Vec<DateTime>,
    /// Times of releases while a rate was in force.
    pub(super) rated: Vec<DateTime>,
    /// Functions of the windows since the values began: what one of them made may wait longer than
    /// its policy is in force.
    pub(super) functions: Vec<AggregateFunction>,
}

#[derive(Debug, Default)]
pub(super) struct Knower {
    pub(super) fields: [Known; FIELDS.len()],
    named: [Option<DisclosurePolicy>; 2],
    of_partner: [Option<usize>; PARTNERS.len()],
    bits: Option<u8>,
    now: DateTime,
    /// Begin of the requests: what comes before counts as coming then.
    begins_at: Option<DateTime>,
    /// The last value of the field at whose state others look is the one that withholds.
    is_in_state: bool,
}

impl Knower {
    pub(super) const fn set_time(&mut self, now: DateTime) {
        self.now = now;
    }

    /// Notes candidates that come together. Returns for each whether a state withholds it.
    pub(super) fn offer<'v>(
        &mut self,
        batch: impl Iterator<Item = (usize, &'v DataValue)>,
        now: DateTime,
    ) -> Vec<bool> {
        let all: Vec<_> = batch.collect();
        let batch = all.iter().filter(|(field, _)| self.fields[*field].own.is_some());
        let batch: Vec<_> = batch.copied().collect();
        let mut withheld = Vec::new();
        let is_state = |value: &DataValue| value.value.as_f64() == Some(WITHHELD_STATE.into());
        let states =
            || batch.iter().filter(|(field, value)| *field == STATE && !value.status.is_bad());
        let is_any_in_state = states().any(|(_, value)| is_state(value));
        for (field, value) in &all {
            if self.fields[*field].own.is_none() {
                withheld.push(false);
                continue;
            }
            // In the order in which they came: the state may have ended just before.
            if *field == STATE && !value.status.is_bad() {
                self.is_in_state = is_state(value);
            }
            let is_in_state = is_any_in_state || self.is_in_state;
            let is_withheld = self.conditions(*field).iter().any(|condition| {
                if condition.field.is_some() { is_in_state } else { is_state(value) }
            });
            withheld.push(is_withheld);
            let is_usable = !value.status.is_bad()
                && value.value.built_in_type() == Some(FIELDS[*field].field_type);
            let possible = Possible {
                value: (*value).clone(),
                arrived_at: self.begins_at.map_or(now, |begin| begin.max(now)),
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
        withheld
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
    pub(super) fn revise(
        &mut self,
        bits: u8,
        begins_at: Option<DateTime>,
        is_mapped: [bool; FIELDS.len()],
    ) {
        self.change(|knower| knower.bits = Some(bits));
        self.begins_at = begins_at;
        let now = self.now;
        for possible in self.fields.iter_mut().flat_map(|known| &mut known.possible) {
            if possible.arrived_at > now {
                possible.arrived_at = begins_at.unwrap_or(now).max(now);
            }
        }
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
            // What is kept for the begin of its request has not come yet.
            let is_kept = |possible: &Possible| possible.arrived_at > former;
            let is_behind = |possible: &Possible| {
                !is_kept(possible) && possible.arrived_at.floor_to(window) > now
            };
            if !window.is_zero() && possible.iter().any(is_behind) {
                *window_end = Some(now.after(window));
            }
            for released in released.iter_mut().chain(rated) {
                *released = (*released).min(now);
            }
            let come = self.fields[field].possible.iter_mut();
            for possible in come.filter(|possible| !is_kept(possible)) {
                let from = possible.counts_from(window);
                possible.was_due = possible.is_due(window, delay, former);
                possible.is_window_over |= from <= former;
                let at = if possible.is_window_over { from } else { possible.arrived_at };
                possible.arrived_at = at.min(now);
            }
        }
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
            let parts = aggregates.map(|aggregate| (aggregate.window_ms, aggregate.function));
            parts.reduce(|(window, function), (other, another)| {
                (window.max(other), function.max(another))
            })
        };
        let before: Vec<_> = (0..FIELDS.len())
            .map(|field| (self.conditions(field), windows(self, field), self.delay(field)))
            .collect();
        change(self);
        for (field, (conditions, window, delay)) in before.into_iter().enumerate() {
            let (now, other) = (self.conditions(field), windows(self, field));
            let is_added = now.iter().any(|condition| !conditions.contains(condition));
            if is_added {
                self.forget(field);
            } else if other.is_some() && other != window {
                let now = self.now;
                self.fields[field].possible.retain(|possible| possible.arrived_at > now);
                self.fields[field].functions.clear();
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

    pub(super) fn recipients(&self, request: usize) -> Vec<&'static str> {
        recipients(request, self.bits.unwrap_or(0b11))
    }

    /// Returns all policies in force for a mapped field.
    pub(super) fn policies(&self, field: usize) -> impl Iterator<Item = DisclosurePolicy> {
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

    pub(super) fn step(&self, field: usize) -> f64 {
        let steps = self.policies(field).filter_map(|policy| policy.rounding_step);
        let steps = steps.filter_map(|step| step.to_string().parse::<f64>().ok());
        let is_banded = self.policies(field).any(|policy| !policy.bands.is_empty());
        if is_banded { f64::INFINITY } else { steps.fold(1.0, f64::max) }
    }

    fn hidden_part(&self, field: usize) -> f64 {
        let digits = self.policies(field).filter_map(|policy| policy.significant_digits).min();
        digits.map_or(0.0, |digits| 0.6 * 10_f64.powi(1 - i32::from(digits)))
    }

    pub(super) fn time_step(&self, field: usize) -> Duration {
        self.longest(field, DisclosurePolicy::time_step)
    }

    pub(super) fn delay(&self, field: usize) -> Duration {
        self.longest(field, DisclosurePolicy::delay)
    }

    pub(super) fn window(&self, field: usize) -> Duration {
        let window =
            |policy: &DisclosurePolicy| policy.aggregate.map(|aggregate| aggregate.window());
        self.longest(field, |policy| window(policy).unwrap_or_default())
    }

    pub(super) fn longest(
        &self,
        field: usize,
        part: impl Fn(&DisclosurePolicy) -> Duration,
    ) -> Duration {
        self.policies(field).map(|policy| part(&policy)).max().unwrap_or_default()
    }
}
