//! Histories of a plant: what people, partners, machines, the link and the clock do.

use asi_model::StatusCode;
use disclosure::DisclosurePolicy;
use proptest::prelude::*;

use super::{
    fields::{FIELDS, PARTNERS, WITHHELD_STATE},
    *,
};

/// A value that comes, before it has the type of its field.
#[derive(Debug, Clone)]
pub(super) struct Coming {
    pub(super) field: usize,
    pub(super) number: u32,
    pub(super) status: StatusCode,
    /// Age of the source's time, in milliseconds.
    pub(super) age_ms: u32,
    /// True for a value of another field's type.
    pub(super) is_of_other_type: bool,
}

/// Event of a history.
#[derive(Debug, Clone)]
pub(super) enum Act {
    /// Values that come together. In the other plant they come later by a part of this time, as far
    /// as the time steps of their fields conceal it.
    Values(Vec<Coming>, u32),
    /// A field is opened for a source: manual, external, or one of two mappings.
    Open {
        field: usize,
        source: usize,
        policy: Box<DisclosurePolicy>,
    },
    Close(usize),
    /// A field is refused, with a reason for the partners.
    Refuse(usize),
    /// A mapping is imported.
    Import {
        field: usize,
        mapping: usize,
    },
    Policy {
        name: usize,
        policy: Box<DisclosurePolicy>,
    },
    Recipient {
        partner: usize,
        name: Option<usize>,
    },
    /// The partner changes the recipients of the first request, and lets both begin later.
    Revise {
        bits: u8,
        begin_ms: Option<u32>,
    },
    /// The engineer decides whether a recipient of the first request sees what had left before.
    DecidePast {
        partner: usize,
        is_released: bool,
    },
    Wait(u32),
    SetClockBack(u32),
    /// The clock leaps forward: nothing was released in between.
    SetClockForward(u32),
    Restart,
    /// The link is up: everything that waits leaves.
    Send {
        is_receipted: bool,
    },
}

pub(super) fn acts() -> impl Strategy<Value = Vec<Act>> {
    // Most fields are open from the beginning, so that there is something to see.
    let opened = (0..FIELDS.len()).map(|field| {
        (0..4_usize, policies()).prop_map(move |(source, policy)| Act::Open {
            field,
            source,
            policy: Box::new(policy),
        })
    });
    let opened: Vec<_> = opened.collect();
    let further = prop_oneof![40 => act().prop_map(|act| vec![act]), 1 => past()];
    (opened, proptest::collection::vec(further, 10..45)).prop_map(|(mut acts, further)| {
        acts.extend(further.into_iter().flatten());
        acts.push(Act::Wait(200_000));
        acts.push(Act::Send { is_receipted: true });
        acts
    })
}

/// A recipient is added after reports have left, and the engineer decides about them.
fn past() -> impl Strategy<Value = Vec<Act>> {
    let of_first = || (0..FIELDS.len()).filter(|field| FIELDS[*field].request == 0);
    let open = |field: usize, policy| Act::Open { field, source: 0, policy: Box::new(policy) };
    let before: Vec<_> =
        of_first().map(|field| policies().prop_map(move |p| open(field, p))).collect();
    let policy = || prop_oneof![3 => Just(DisclosurePolicy::default()), 1 => policies()];
    let after: Vec<_> =
        of_first().map(|field| policy().prop_map(move |p| open(field, p))).collect();
    let values = proptest::collection::vec(coming(), 4..12);
    (before, values, after, 1..PARTNERS.len(), proptest::bool::weighted(0.8)).prop_map(
        |(before, values, after, partner, is_released)| {
            let revise = |bits| Act::Revise { bits, begin_ms: None };
            let mut acts = vec![revise(0b001)];
            acts.extend(before);
            acts.extend([Act::Values(values, 0), Act::Wait(200_000)]);
            acts.extend([Act::Send { is_receipted: true }, revise(0b111)]);
            acts.extend(after);
            acts.push(Act::DecidePast { partner, is_released });
            acts
        },
    )
}

fn act() -> impl Strategy<Value = Act> {
    let field = || 0..FIELDS.len();
    let name = || 0..2_usize;
    let policy = || policies().prop_map(Box::new);
    prop_oneof![
        8 => (proptest::collection::vec(coming(), 1..5), 0..8_000_u32)
            .prop_map(|(coming, later_ms)| Act::Values(coming, later_ms)),
        // One value: that it comes later is concealed more often than that several do.
        4 => (coming(), 0..8_000_u32)
            .prop_map(|(coming, later_ms)| Act::Values(vec![coming], later_ms)),
        // Several values of one field, of which a policy may show the last one only.
        4 => (field(), proptest::collection::vec(coming(), 2..5)).prop_map(|(field, coming)| {
            let coming = coming.into_iter().map(|coming| Coming { field, ..coming });
            Act::Values(coming.collect(), 0)
        }),
        4 => (field(), 0..4_usize, policy())
            .prop_map(|(field, source, policy)| Act::Open { field, source, policy }),
        1 => field().prop_map(Act::Close),
        1 => field().prop_map(Act::Refuse),
        1 => (field(), 0..2_usize).prop_map(|(field, mapping)| Act::Import { field, mapping }),
        2 => (name(), policy()).prop_map(|(name, policy)| Act::Policy { name, policy }),
        2 => (0..PARTNERS.len(), proptest::option::weighted(0.7, name()))
            .prop_map(|(partner, name)| Act::Recipient { partner, name }),
        1 => (0..8_u8, proptest::option::of(1..60_000_u32))
            .prop_map(|(bits, begin_ms)| Act::Revise { bits, begin_ms }),
        // The same recipients: consents go on, but for what has begun already.
        1 => proptest::option::weighted(0.8, 1..60_000_u32)
            .prop_map(|begin_ms| Act::Revise { bits: 0b11, begin_ms }),
        1 => (0..PARTNERS.len(), any::<bool>())
            .prop_map(|(partner, is_released)| Act::DecidePast { partner, is_released }),
        6 => prop_oneof![1..2_000_u32, 2_000..90_000_u32].prop_map(Act::Wait),
        1 => (1..100_000_u32).prop_map(Act::SetClockBack),
        1 => prop_oneof![1..100_000_u32, 100_000..100_000_000_u32].prop_map(Act::SetClockForward),
        1 => Just(Act::Restart),
        3 => any::<bool>().prop_map(|is_receipted| Act::Send { is_receipted }),
    ]
}

fn coming() -> impl Strategy<Value = Coming> {
    let status = prop_oneof![
        8 => Just(StatusCode::GOOD),
        1 => Just(StatusCode::GOOD_CLAMPED),
        1 => Just(StatusCode::UNCERTAIN_SUB_NORMAL),
        1 => Just(StatusCode::UNCERTAIN_NO_COMMUNICATION_LAST_USABLE_VALUE),
        1 => Just(StatusCode::BAD_NO_DATA),
        1 => Just(StatusCode::BAD_SENSOR_FAILURE),
    ];
    let of_other_type = proptest::bool::weighted(0.05);
    (0..FIELDS.len(), 1_000..100_000_u32, status, 0..120_000_u32, of_other_type).prop_map(
        |(field, number, status, age_ms, is_of_other_type)| Coming {
            field,
            number,
            status,
            age_ms,
            is_of_other_type,
        },
    )
}

/// Time steps of policies.
pub(super) const TIME_STEPS_MS: [u64; 3] = [10_000, 15_000, 60_000];

/// Policies of which each part is there or not. Some steps divide each other, and some do not.
fn policies() -> impl Strategy<Value = DisclosurePolicy> {
    let part = |chance: f64, values: Value| {
        let values = values.as_array().cloned().unwrap_or_default();
        proptest::option::weighted(chance, proptest::sample::select(values))
    };
    let condition = |own: Value| json!([{ "states": [WITHHELD_STATE], "field": own }]);
    // The plants begin on a Monday at midnight.
    let hours = |from: &str, until: &str, offset: i16| {
        json!({ "days": ["MONDAY", "TUESDAY"], "from": from, "until": until,
            "utcOffsetMinutes": offset })
    };
    let parts = (
        part(0.5, json!([10, 100, 150, 1000])),
        part(0.25, json!([5_000, 60_000])),
        part(0.25, json!([3_000, 30_000])),
        part(0.25, json!(TIME_STEPS_MS)),
        (
            part(0.2, json!(["LAST", "MAXIMUM", "MINIMUM", "MEAN", "SUM"])),
            proptest::sample::select(vec![60_000_u32, 90_000]),
        ),
        part(0.3, json!(["FULL", "SEVERITY"])),
        part(0.2, json!([condition(json!("state")), condition(Value::Null)])),
        part(
            0.25,
            json!([
                [{ "values": 2, "periodMs": 60_000 }],
                [{ "values": 1, "periodMs": 5_000 }],
                [{ "values": 4, "periodMs": 300_000 }, { "values": 1, "periodMs": 2_000 }],
            ]),
        ),
        part(0.2, json!([[0, 20_000, 50_000], [-50_000, -20_000, 0, 50_000]])),
        part(0.15, json!([1, 3])),
        part(0.1, json!([hours("00:01", "23:59", 0), hours("01:00", "01:20", 60)])),
        part(0.05, json!([[hours("00:02", "23:59", 0)]])),
    );
    parts.prop_map(|parts| {
        let (step, delay, interval, time_step, aggregate, status, condition, rates, ..) = &parts;
        let (function, window) = aggregate;
        let (.., bands, digits, hours, further_hours) = &parts;
        // Bands and a rounding step exclude each other.
        let bands = bands.as_ref().filter(|_| step.is_none());
        let window =
            function.as_ref().map(|function| json!({ "function": function, "windowMs": window }));
        let members = [
            ("roundingStep", step.as_ref()),
            ("bands", bands),
            ("significantDigits", digits.as_ref()),
            ("delayMs", delay.as_ref()),
            ("minimumIntervalMs", interval.as_ref()),
            ("timeStepMs", time_step.as_ref()),
            ("aggregate", window.as_ref()),
            ("statusCodes", status.as_ref()),
            ("withholdWhile", condition.as_ref()),
            ("rateLimits", rates.as_ref()),
            ("workingHours", hours.as_ref()),
            ("furtherHours", further_hours.as_ref()),
        ];
        let members =
            members.into_iter().filter_map(|(name, part)| Some((name.to_owned(), part?.clone())));
        let policy = Value::Object(members.collect());
        serde_json::from_value(policy).expect("a policy")
    })
}

/// A member that a policy gets one day is part of the histories, or this says that it is not.
#[test]
fn histories_have_every_member_of_policies() {
    use std::collections::BTreeSet;

    use proptest::{strategy::ValueTree as _, test_runner::TestRunner};

    let description = serde_json::to_value(crate::api::openapi()).expect("JSON");
    let schema = &description["components"]["schemas"]["DisclosurePolicy"]["properties"];
    let members: BTreeSet<String> = schema.as_object().expect("members").keys().cloned().collect();
    let functions = &description["components"]["schemas"]["AggregateFunction"]["enum"];
    let functions = functions.as_array().expect("functions").iter().filter_map(Value::as_str);
    let (mut runner, mut used, mut aggregates) =
        (TestRunner::deterministic(), BTreeSet::new(), BTreeSet::new());
    for _ in 0..1_000 {
        let policy = policies().new_tree(&mut runner).expect("a policy").current();
        let policy = serde_json::to_value(policy).expect("JSON");
        used.extend(policy.as_object().expect("members").keys().cloned());
        aggregates.extend(policy["aggregate"]["function"].as_str().map(ToOwned::to_owned));
    }
    assert_eq!(used, members);
    assert_eq!(aggregates, functions.map(ToOwned::to_owned).collect());
}
