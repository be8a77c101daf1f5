//! Values that come to a plant, and what differs of them at the other one.

use connector_state::{ConnectorState, use_cases::values};
use disclosure::{AggregateFunction, DisclosurePolicy, GateOutcome};

use super::{
    acts::Coming,
    below::{differing, superseded},
    fields::{FIELDS, STATE},
    knower::Knower,
    plant::{Plant, earlier},
    *,
};
use crate::coordinator::candidates;

/// Amount of what an act did.
#[derive(Debug, Default)]
pub(super) struct Varied {
    /// Values for the other plant by their fields' places, which differ below the policies.
    pub(super) values: Vec<(usize, DataValue)>,
    /// Time after which they come to the other plant.
    pub(super) later_ms: u32,
    /// Number of those that differ.
    pub(super) count: usize,
    /// Number of those that a newer one replaced before they could leave.
    pub(super) superseded: usize,
    /// Number of reports that left.
    pub(super) reports: usize,
    /// Number of reports that a recipient was shown later.
    pub(super) past_reports: usize,
}

impl Plant {
    /// Offers values as mappings, OPC UA clients and operators do. The other plant gets what differs
    /// below the policies, later: what comes and what passes meanwhile changes places.
    pub(super) async fn offer(
        &mut self,
        coming: &[Coming],
        later_ms: u32,
        knower: &mut Knower,
        varied: Option<&Varied>,
    ) -> Varied {
        if let Some(varied) = varied {
            self.wait_meanwhile(varied.later_ms).await;
            self.offer_values(&varied.values, knower);
            self.commit().await;
            return Varied::default();
        }
        let values: Vec<(usize, DataValue)> =
            coming.iter().map(|coming| (coming.field, self.value(coming))).collect();
        let policies: Vec<_> = values.iter().map(|(field, _)| self.policy(*field)).collect();
        let mut varied =
            Varied { later_ms: self.concealed(&values, later_ms), ..Varied::default() };
        let kept: Vec<bool> = values.iter().map(|(field, _)| self.is_kept(*field)).collect();
        let (outcomes, withheld) = self.offer_values(&values, knower);
        self.commit().await;
        self.wait_meanwhile(varied.later_ms).await;
        for (place, (((field, value), policy), outcome)) in
            values.iter().zip(&policies).zip(&outcomes).enumerate()
        {
            let outcome = *outcome;
            if kept[place] && (!withheld[place] || *field == STATE) {
                // It leaves when its request begins, unless another one takes its place.
                varied.values.push((*field, value.clone()));
                continue;
            }
            let mut other = differing(*field, value, policy, outcome);
            if is_superseded(place, &values, policy, &outcomes) {
                other = superseded(*field, &other, policy, &values[place + 1..]);
                varied.superseded += usize::from(other.value != value.value);
            }
            varied.count += usize::from(other.value != value.value || other.status != value.status);
            // Nor does anybody learn how many values the state of another field withholds.
            let is_of_other =
                policy.withhold_while.iter().all(|condition| condition.field.is_some());
            let is_withheld = outcome == Some(GateOutcome::Suppressed) && *field != STATE;
            let count = if is_withheld && is_of_other { varied.values.len() % 3 } else { 1 };
            varied.values.extend(std::iter::repeat_n((*field, other), count));
        }
        varied
    }

    /// Returns for how long, up to `later_ms`, the time steps of fields conceal when their values come.
    fn concealed(&self, values: &[(usize, DataValue)], later_ms: u32) -> u32 {
        let begin = self.now;
        let of = |field: usize| {
            let policy = self.policy(field);
            // A mean tells for how long a value held, and a delay counts from the arrival.
            let function = policy.aggregate.map(|aggregate| aggregate.function);
            let is_concealed = !policy.time_step().is_zero()
                && policy.delay().is_zero()
                && function != Some(AggregateFunction::Mean);
            // Up to the step on which they leave: within the step and the window of their arrival.
            let end_of = |step: Duration| begin.floor_to(step).after(step);
            let windows = policy.aggregate.map(|aggregate| end_of(aggregate.window()));
            let end = windows.into_iter().fold(end_of(policy.time_step()), DateTime::min);
            if !is_concealed
                || field == STATE
                || self.is_kept(field)
                || begin.floor_to(policy.time_step()) == begin
            {
                return 0;
            }
            u32::try_from(end.since(begin).as_millis()).unwrap_or(u32::MAX).saturating_sub(1)
        };
        values.iter().map(|(field, _)| of(*field)).min().unwrap_or(0).min(later_ms)
    }

    /// Returns true while values of a field are kept until its request begins.
    fn is_kept(&self, field: usize) -> bool {
        let field = self.work.state.field(&FIELDS[field].key()).expect("a field");
        field.decision().is_mapped() && field.validity().from.is_some_and(|from| from > self.now)
    }

    fn policy(&self, field: usize) -> Arc<DisclosurePolicy> {
        let field = self.work.state.field(&FIELDS[field].key()).expect("a field");
        Arc::clone(field.gate().policy())
    }

    /// Offers the values of mappings in one batch, and then each that was written. Returns what the
    /// gates say, and whether a state withholds it as the second model has it.
    fn offer_values(
        &mut self,
        values: &[(usize, DataValue)],
        knower: &mut Knower,
    ) -> (Vec<Option<GateOutcome>>, Vec<bool>) {
        let now = self.now;
        let source = |state: &ConnectorState, field: usize| {
            let field = state.field(&FIELDS[field].key()).expect("a field");
            (field.decision().value_source.unwrap_or(ValueSource::Manual), field.target_key())
        };
        let mapped: Vec<_> = (0..values.len())
            .filter(|place| source(&self.work.state, values[*place].0).0 == ValueSource::Mapping)
            .collect();
        let (mut outcomes, mut withheld) = (vec![None; values.len()], vec![false; values.len()]);
        let of_mappings = mapped.iter().map(|place| (values[*place].0, &values[*place].1));
        for (place, is_withheld) in mapped.iter().zip(knower.offer(of_mappings, now)) {
            withheld[*place] = is_withheld;
        }
        let batch: Vec<Candidate> = mapped
            .iter()
            .map(|place| Candidate {
                target: source(&self.work.state, values[*place].0).1,
                value: values[*place].1.clone(),
                state: None,
            })
            .collect();
        let of_batch =
            candidates::receive(&mut self.work, candidates::of_fields(batch.into_iter()), now);
        for (place, outcome) in mapped.iter().zip(of_batch) {
            outcomes[*place] = outcome;
        }
        for (place, (field, value)) in values.iter().enumerate() {
            if !mapped.contains(&place) {
                let (source, _) = source(&self.work.state, *field);
                withheld[place] = knower.offer(std::iter::once((*field, value)), now) == [true];
                let key = FIELDS[*field].key();
                let state = &mut self.work.state;
                outcomes[place] = values::write_value(state, &key, source, value.clone(), now).ok();
            }
        }
        // The answer to a write says whether it leaves, but for what a state withholds.
        let answered =
            outcomes.iter().flatten().filter(|outcome| **outcome != GateOutcome::Suppressed);
        self.seen.extend(answered.map(|outcome| format!("outcome {}", is_released(*outcome))));
        (outcomes, withheld)
    }

    fn value(&self, coming: &Coming) -> DataValue {
        let other = FIELDS.len() - 1 - coming.field;
        let field = if coming.is_of_other_type { other } else { coming.field };
        let value = FIELDS[field].value(coming.number);
        let value = DataValue::good(value, earlier(self.now, coming.age_ms));
        DataValue { status: coming.status, ..value }
    }

    async fn wait_meanwhile(&mut self, ms: u32) {
        if ms > 0 {
            self.wait(ms).await;
        }
    }
}

/// Returns true for a value after which another of its field comes at the same time, so that it never leaves: it
/// waits without a delay, or is one of several in a window.
fn is_superseded(
    place: usize,
    values: &[(usize, DataValue)],
    policy: &DisclosurePolicy,
    outcomes: &[Option<GateOutcome>],
) -> bool {
    let field = values[place].0;
    let is_taken = |outcome: Option<GateOutcome>| {
        outcome.is_some_and(|outcome| outcome != GateOutcome::Suppressed)
    };
    let does_wait =
        policy.aggregate.is_some() || matches!(outcomes[place], Some(GateOutcome::Withheld { .. }));
    let mut later = (place + 1..values.len()).filter(|later| values[*later].0 == field);
    field != STATE
        && does_wait
        && policy.delay().is_zero()
        && is_taken(outcomes[place])
        && later.any(|later| is_taken(outcomes[later]))
}

const fn is_released(outcome: GateOutcome) -> bool {
    matches!(outcome, GateOutcome::Disclosed { .. })
}
