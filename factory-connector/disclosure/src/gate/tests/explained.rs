//! Every released value is what the policy in force makes of a candidate of the present source:
//! for numbers and texts, any status and any source time, through changes of policy and source.

use asi_model::{Scalar, StatusCode, Variant, values::Array};
use proptest::prelude::*;

use super::{
    model::{Kind, Model},
    properties::is_working,
    strategies::{HOUR_MS, START_MS, at, other, policies},
    *,
};
use crate::{StateValue, WindowAggregate, gate_from_json, gate_to_json};

#[derive(Debug, Clone)]
enum Event {
    Candidate(DataValue),
    State(Option<bool>),
    Wake,
    Restart,
    Policy(Box<DisclosurePolicy>),
    Source,
}

/// A kind of field with its first policy, and events after pauses in milliseconds.
type Play = (Kind, DisclosurePolicy, Vec<(u64, Event)>);

fn plays(pause_ms: u64) -> impl Strategy<Value = Play> {
    prop_oneof![Just(Kind::Whole), Just(Kind::Number), Just(Kind::Text)].prop_flat_map(
        move |kind| {
            let policy = move || policies().prop_map(move |policy| fitted(kind, policy));
            let event = prop_oneof![
                14 => candidates(kind).prop_map(Event::Candidate),
                2 => proptest::option::of(any::<bool>()).prop_map(Event::State),
                2 => Just(Event::Wake),
                1 => Just(Event::Restart),
                2 => policy().prop_map(|policy| Event::Policy(Box::new(policy))),
                1 => Just(Event::Source),
            ];
            (Just(kind), policy(), proptest::collection::vec((0..pause_ms, event), 0..60))
        },
    )
}

/// Adapts a policy for whole numbers. Aggregates are single values of the window.
fn fitted(kind: Kind, mut policy: DisclosurePolicy) -> DisclosurePolicy {
    let single = |function| match function {
        AggregateFunction::Sum => AggregateFunction::Last,
        AggregateFunction::Mean => AggregateFunction::Maximum,
        function => function,
    };
    policy.aggregate = policy
        .aggregate
        .map(|aggregate| WindowAggregate { function: single(aggregate.function), ..aggregate });
    match kind {
        Kind::Whole => policy,
        Kind::Number => {
            policy.rounding_step = policy
                .rounding_step
                .map(|step| (step.decimal().to_f64() / 100.0).try_into().expect("positive"));
            policy
        }
        Kind::Text => {
            for condition in &mut policy.withhold_while {
                condition.states = vec![StateValue::Text("text 0".to_owned())];
            }
            policy.fitted_to(BuiltInType::String, false)
        }
    }
}

fn scalars(kind: Kind) -> BoxedStrategy<Scalar> {
    match kind {
        Kind::Whole => prop_oneof![
            8 => (-1000_i64..1000).prop_map(Scalar::Int64),
            1 => any::<i64>().prop_map(Scalar::Int64),
        ]
        .boxed(),
        Kind::Number => (-100_000_i32..100_000)
            .prop_map(|hundredths| Scalar::Double(f64::from(hundredths) / 100.0))
            .boxed(),
        Kind::Text => (0..4).prop_map(|n| Scalar::from(format!("text {n}").as_str())).boxed(),
    }
}

/// Any candidate, as a machine, script, person or client makes it.
fn candidates(kind: Kind) -> impl Strategy<Value = DataValue> {
    let value = prop_oneof![
        8 => scalars(kind).prop_map(Variant::Scalar),
        1 => prop_oneof![scalars(Kind::Whole), scalars(Kind::Number), scalars(Kind::Text)]
            .prop_map(Variant::Scalar),
        1 => Just(Variant::Null),
        1 => proptest::collection::vec(scalars(kind), 0..4).prop_map(move |elements| {
            let element_type = kind.field_type();
            Variant::Array(Arc::new(Array { element_type, elements, dimensions: None }))
        }),
    ];
    let status = prop_oneof![
        4 => Just(StatusCode::GOOD),
        1 => Just(StatusCode::UNCERTAIN_NO_COMMUNICATION_LAST_USABLE_VALUE),
        1 => Just(StatusCode::BAD_NO_DATA),
        2 => any::<u32>().prop_map(StatusCode),
    ];
    let time = || {
        proptest::option::of(
            (-20_000_000_i64..20_000_000)
                .prop_map(|micros| DateTime::from_unix_micros(START_MS * 1_000 + micros)),
        )
    };
    (value, status, time(), time(), 0_u16..10_000).prop_map(
        |(value, status, source_timestamp, server_timestamp, picoseconds)| DataValue {
            value,
            status,
            source_timestamp,
            source_picoseconds: if source_timestamp.is_some() { picoseconds } else { 0 },
            server_timestamp,
            server_picoseconds: if server_timestamp.is_some() { picoseconds } else { 0 },
        },
    )
}

/// A gate beside its model, and its releases.
struct Stage {
    kind: Kind,
    gate: Gate,
    model: Model,
    now: u64,
    last: Option<u64>,
    /// Times of releases under the present policy.
    releases: Vec<u64>,
}

impl Stage {
    fn new(kind: Kind, policy: DisclosurePolicy) -> Self {
        let state = GateState::default();
        let gate = Gate::new(Arc::new(policy.clone()), kind.field_type(), state, at(0));
        let model = Model::new(kind, policy);
        Self { kind, gate, model, now: 0, last: None, releases: Vec::new() }
    }

    /// Plays an event at a gate and its model.
    fn play(&mut self, event: &Event, state: &mut Option<bool>) -> Result<(), TestCaseError> {
        let now = self.now;
        match event {
            Event::Candidate(candidate) => {
                self.model.candidate(now, candidate);
                self.gate.on(at(now), candidate.clone());
            }
            Event::State(is_withheld) => {
                *state = *is_withheld;
                self.model.state(*is_withheld);
                self.gate.on_state(at(now), &other(), *is_withheld);
            }
            Event::Wake => self.gate.on_time(at(now)),
            Event::Restart => {
                let policy = Arc::clone(self.gate.policy());
                let stored = gate_from_json(&gate_to_json(&self.gate.state()));
                let stored = stored.expect("it reads what it wrote");
                self.gate = Gate::new(policy, self.kind.field_type(), stored, at(now));
            }
            Event::Policy(policy) => {
                self.model.change(now, (**policy).clone());
                self.gate.change_policy(Arc::new((**policy).clone()), at(now));
                self.check_shown()?;
                self.gate.on_state(at(now), &other(), *state);
                self.releases.clear();
            }
            Event::Source => {
                self.model.source(now);
                self.gate.close(at(now));
                prop_assert_eq!(self.gate.disclosed(), None, "a value of the former source");
            }
        }
        self.check()
    }

    /// Checks what key frames repeat under a new policy.
    fn check_shown(&self) -> Result<(), TestCaseError> {
        if let Some(shown) = self.gate.disclosed() {
            let again = super::model::coarse(self.kind, self.model.policy(), shown);
            prop_assert_eq!(again.status, shown.status, "a finer status is repeated");
            prop_assert_eq!(again.source_timestamp, shown.source_timestamp);
            let digits = self.model.policy().significant_digits.is_some();
            prop_assert!(digits || again.value == shown.value, "a finer value is repeated");
        }
        Ok(())
    }

    /// Checks a release, if there was one.
    fn check(&mut self) -> Result<(), TestCaseError> {
        if !self.gate.take_released() {
            return Ok(());
        }
        let (now, policy) = (self.now, self.model.policy());
        let released = self.gate.disclosed().expect("a release is a value");
        prop_assert!(self.model.explains(now, released), "{released:?} at {now} by {policy:?}");
        prop_assert!(!self.model.is_withheld(), "released in a withheld state");
        prop_assert_eq!((released.server_timestamp, released.server_picoseconds), (None, 0));
        let start = START_MS.unsigned_abs();
        let slots = [policy.time_step_ms, policy.aggregate.map(|aggregate| aggregate.window_ms)];
        if let Some(last) = self.last {
            prop_assert!(now - last >= policy.minimum_interval_ms.unwrap_or(0), "too fast");
            for period in slots.into_iter().flatten() {
                let slot = |ms: u64| (start + ms) / period;
                prop_assert!(slot(last) < slot(now), "twice in one step or window");
            }
        }
        if let Some(step) = policy.time_step_ms {
            let late = (start + now) % step;
            prop_assert!(late <= (step / 10).clamp(100, 5_000), "{late} ms after the step");
        }
        prop_assert!(policy.working_hours.is_none() || is_working(now), "outside of the hours");
        self.last = Some(now);
        self.releases.push(now);
        for limit in &policy.rate_limits {
            let since = self.releases.iter().filter(|when| **when + limit.period_ms > now);
            prop_assert!(since.count() <= limit.values as usize, "more than {limit:?}");
        }
        Ok(())
    }
}

fn run((kind, policy, events): Play, is_late: bool) -> Result<(), TestCaseError> {
    let mut stage = Stage::new(kind, policy);
    let mut state = None;
    for (pause, event) in events {
        let next = stage.now + pause;
        while let Some(due) = stage.gate.due().filter(|due| !is_late && *due < at(next)) {
            let due = u64::try_from(due.unix_millis() - START_MS).expect("later");
            stage.now = stage.now.max(due);
            stage.gate.on_time(at(stage.now));
            stage.check()?;
        }
        stage.now = next;
        stage.gate.on_time(at(next));
        stage.check()?;
        stage.play(&event, &mut state)?;
    }
    Ok(())
}

proptest! {
    #[test]
    fn every_released_value_is_made_of_a_candidate_by_the_policy(play in plays(2_000), is_late in any::<bool>()) {
        run(play, is_late)?;
    }

    /// The same over days, for the hours.
    #[test]
    fn every_value_released_within_the_hours_is_explained(play in plays(8 * HOUR_MS), is_late in any::<bool>()) {
        run(play, is_late)?;
    }
}
