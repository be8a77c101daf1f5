use asi_model::values::{LocalizedText, NodeId};

use super::*;
use crate::{BrowsePath, EventValue, InputKey, MonitorOptions, SourceId};

fn reduction(value: EventValue, severity_min: Option<u16>) -> EventReduction {
    let events = EventSelection { value, event_type: None, source_node: None, severity_min };
    let options = MonitorOptions { events: Some(Box::new(events)), ..MonitorOptions::default() };
    let source = SourceId::new("press").expect("valid");
    let node_id = NodeId::ua(2253);
    let request = MonitorRequest { input: InputKey(1), source, node_id, options };
    EventReduction::new(&Arc::new(request)).expect("a request for events")
}

fn id(node: NodeId) -> Variant {
    Variant::Scalar(Scalar::NodeId(Box::new(node)))
}

fn text(text: &str) -> Variant {
    let text = LocalizedText { locale: None, text: Some(text.into()) };
    Variant::Scalar(Scalar::LocalizedText(Box::new(text)))
}

fn at(ticks: i64) -> DateTime {
    DateTime::from_ticks(ticks)
}

/// An alarm with its number, severity and state.
fn alarm(number: u32, severity: u16, is_active: bool, is_retained: bool) -> Vec<Variant> {
    vec![
        id(NodeId::ua(2915)),
        at(i64::from(number) + 100).into(),
        severity.into(),
        text(&format!("alarm {number}")),
        id(NodeId::numeric("urn:press", number)),
        id(NodeId::ua(0)),
        is_retained.into(),
        is_active.into(),
    ]
}

/// An event that speaks of the subscription.
fn mark(event_type: NodeId) -> Vec<Variant> {
    let mut fields = vec![id(event_type), at(50).into()];
    fields.resize(8, Variant::Null);
    fields
}

fn refreshed(reduction: &mut EventReduction, named: &[Vec<Variant>]) -> Reaction {
    assert_eq!(reduction.take(mark(REFRESH_START)), Reaction::Nothing);
    for fields in named {
        assert_eq!(reduction.take(fields.clone()), Reaction::Nothing, "not before its end");
    }
    reduction.take(mark(REFRESH_END))
}

fn value_of(reaction: Reaction) -> (Variant, StatusCode) {
    match reaction {
        Reaction::Value(value) => (value.value, value.status),
        other => panic!("a value: {other:?}"),
    }
}

#[test]
fn the_last_event_that_has_the_field_makes_the_value() {
    let mut last = reduction(EventValue::Field { path: BrowsePath::default() }, None);
    let event = |field: Variant| vec![id(NodeId::ua(2041)), at(7).into(), field];
    assert_eq!(last.take(event(7_i32.into())), Reaction::Value(DataValue::good(7_i32, at(7))));
    assert_eq!(last.take(event(Variant::Null)), Reaction::Nothing);
    let failed = Variant::Scalar(Scalar::StatusCode(StatusCode::BAD_SENSOR_FAILURE));
    let expected = DataValue::status_only(StatusCode::BAD_SENSOR_FAILURE, Some(at(7)));
    assert_eq!(last.take(event(failed)), Reaction::Value(expected));
    assert_eq!(last.take(vec![id(NodeId::ua(2041)), at(7).into()]), Reaction::Unreadable);
    let overflow = vec![id(QUEUE_OVERFLOW), at(7).into(), Variant::Null];
    assert_eq!(last.take(overflow), Reaction::Overflow);
}

#[test]
fn what_a_refresh_shows_again_is_not_the_last_event() {
    let mut last = reduction(EventValue::Field { path: BrowsePath::default() }, None);
    let event = |time: i64| vec![id(NodeId::ua(2041)), at(time).into(), time.into()];
    let of = |time: i64| Reaction::Value(DataValue::good(time, at(time)));
    assert_eq!(last.take(event(500)), of(500));
    assert_eq!(last.take(vec![id(REFRESH_START), at(501).into(), 0_i64.into()]), Reaction::Nothing);
    assert_eq!(last.take(event(20)), Reaction::Nothing);
    assert_eq!(last.take(event(500)), of(500));
    // A clock that was set back.
    for time in 30..46 {
        assert_eq!(last.take(event(time)), Reaction::Nothing);
    }
    assert_eq!(last.take(event(46)), of(46));
    assert_eq!(last.take(event(47)), of(47));
}

#[test]
fn conditions_have_no_value_before_the_server_has_named_all() {
    let mut count = reduction(EventValue::ActiveConditions, None);
    assert_eq!(count.take(alarm(1, 500, true, true)), Reaction::Nothing);
    let named = [alarm(1, 500, true, true), alarm(2, 700, true, true)];
    assert_eq!(value_of(refreshed(&mut count, &named)), (2_u32.into(), StatusCode::GOOD));
    assert_eq!(value_of(count.take(alarm(2, 700, false, true))).0, 1_u32.into());
    assert_eq!(value_of(count.take(alarm(1, 500, false, false))).0, 0_u32.into());
}

#[test]
fn conditions_are_doubted_until_the_server_has_named_them_again() {
    let mut count = reduction(EventValue::ActiveConditions, None);
    for (doubt, expected) in
        [(REFRESH_REQUIRED, Reaction::RefreshNeeded), (QUEUE_OVERFLOW, Reaction::Overflow)]
    {
        refreshed(&mut count, &[alarm(1, 500, true, true)]);
        assert!(!count.awaits_conditions());
        assert_eq!(count.take(mark(doubt)), expected);
        assert!(count.awaits_conditions());
        assert_eq!(count.take(alarm(2, 500, true, true)), Reaction::Nothing);
        assert_eq!(count.take(mark(REFRESH_END)), Reaction::Nothing, "its begin was lost");
        let named = [alarm(2, 500, true, true), alarm(3, 500, true, true)];
        assert_eq!(value_of(refreshed(&mut count, &named)), (2_u32.into(), StatusCode::GOOD));
        assert_eq!(refreshed(&mut count, &named), Reaction::Nothing, "nothing has changed");
    }
}

#[test]
fn what_a_refresh_does_not_name_is_not_active_any_more() {
    let mut count = reduction(EventValue::ActiveConditions, None);
    refreshed(&mut count, &[alarm(1, 500, true, true), alarm(2, 500, true, true)]);
    assert_eq!(value_of(refreshed(&mut count, &[alarm(2, 500, true, true)])).0, 1_u32.into());
    assert_eq!(value_of(refreshed(&mut count, &[])).0, 0_u32.into());
}

#[test]
fn a_condition_that_becomes_less_severe_than_is_asked_for_goes() {
    let mut worst = reduction(EventValue::ActiveSeverity, Some(500));
    let named = [alarm(1, 600, true, true), alarm(2, 499, true, true)];
    assert_eq!(value_of(refreshed(&mut worst, &named)).0, 600_u16.into());
    assert_eq!(value_of(worst.take(alarm(2, 900, true, true))).0, 900_u16.into());
    assert_eq!(value_of(worst.take(alarm(2, 100, true, true))).0, 600_u16.into());
    assert_eq!(value_of(worst.take(alarm(1, 100, true, true))).0, 0_u16.into());
}

#[test]
fn the_message_is_that_of_the_most_severe_condition_and_of_several_the_newest() {
    let mut message = reduction(EventValue::ActiveMessage, None);
    assert_eq!(value_of(refreshed(&mut message, &[])).0, text(""));
    assert_eq!(value_of(message.take(alarm(3, 300, true, true))).0, text("alarm 3"));
    assert_eq!(value_of(message.take(alarm(4, 300, true, true))).0, text("alarm 4"));
    assert_eq!(value_of(message.take(alarm(1, 800, true, true))).0, text("alarm 1"));
    assert_eq!(value_of(message.take(alarm(1, 800, false, true))).0, text("alarm 4"));
}

#[test]
fn states_of_the_past_and_conditions_without_a_state_are_distinguished() {
    let mut count = reduction(EventValue::ActiveConditions, None);
    refreshed(&mut count, &[]);
    let mut past = alarm(1, 500, true, true);
    past[5] = id(NodeId::numeric("urn:press", 77));
    assert_eq!(value_of(count.take(past)).0, 0_u32.into());
    let mut stateless = alarm(2, 500, true, true);
    stateless[7] = Variant::Null;
    assert_eq!(value_of(count.take(stateless)).0, 1_u32.into());
    let mut nameless = alarm(3, 500, true, true);
    nameless[4] = Variant::Null;
    assert_eq!(value_of(count.take(nameless)).0, 1_u32.into());
}

#[test]
fn a_message_without_end_and_an_id_without_end_are_not_kept() {
    let mut message = reduction(EventValue::ActiveMessage, None);
    refreshed(&mut message, &[]);
    let mut long = alarm(1, 500, true, true);
    long[3] = text(&"\u{e4}".repeat(1_000_000));
    assert_eq!(value_of(message.take(long)).0, text(&"\u{e4}".repeat(500)));
    let mut nameless = alarm(2, 900, true, true);
    nameless[4] = id(NodeId::string("urn:press", &"n".repeat(4097)));
    assert_eq!(value_of(message.take(nameless)).0, text(&"\u{e4}".repeat(500)));
}

#[test]
fn without_a_refresh_the_value_is_uncertain() {
    let mut count = reduction(EventValue::ActiveConditions, None);
    count.take(alarm(1, 500, true, true));
    let value = count.give_up_refresh(at(9)).expect("a value");
    assert_eq!((value.value, value.status), (1_u32.into(), StatusCode::UNCERTAIN_INITIAL_VALUE));
    let next = value_of(count.take(alarm(1, 500, false, false)));
    assert_eq!(next, (0_u32.into(), StatusCode::UNCERTAIN_INITIAL_VALUE));
    // A later one that the server answers settles it.
    assert_eq!(value_of(refreshed(&mut count, &[])), (0_u32.into(), StatusCode::GOOD));
    assert_eq!(count.give_up_refresh(at(9)), None);
}
