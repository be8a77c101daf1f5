//! Order that a machine works off, as its server shows it.

use asi_model::values::BuiltInType as T;

use crate::{
    OrdersConfig,
    blueprint::{Blueprint, Source},
    orders::OrderPhase,
    signals::Production,
};

/// Adds the variables of the present order to the group with the machine's counters.
pub(super) fn order(
    blueprint: &mut Blueprint,
    group: usize,
    production: Production,
    orders: &OrdersConfig,
) {
    let (rhythm, cycle) = (orders.rhythm(), production.cycle);
    let ids = orders.clone();
    blueprint.signal(group, "OrderId", T::String, move |moment| {
        ids.id(rhythm.at(moment.seconds, cycle).index).as_str().into()
    });
    let quantity = orders.quantity;
    blueprint.signal(group, "OrderedQuantity", T::UInt32, move |_| quantity.into());
    let state = blueprint.signal(group, "OrderState", T::Int32, move |moment| {
        (rhythm.at(moment.seconds, cycle).phase as i32).into()
    });
    blueprint.describe(state, "0 Waiting, 1 Running, 2 Interrupted, 3 Done");
    let reason = blueprint.signal(group, "InterruptedBy", T::String, move |moment| {
        let phase = rhythm.at(moment.seconds, cycle).phase;
        (if phase == OrderPhase::Interrupted { "Tool life exceeded" } else { "none" }).into()
    });
    blueprint.describe(reason, "Reason why the order stands still");
    let start =
        time(blueprint, group, "OrderStart", move |seconds| rhythm.at(seconds, cycle).start);
    blueprint.describe(start, "Start of the order, as planned by the machine until it has begun");
    let end = time(blueprint, group, "OrderEnd", move |seconds| rhythm.at(seconds, cycle).end);
    blueprint.describe(end, "End of the order, as the machine expects it until it has come");
}

/// Adds a time of which the simulated seconds are a function of the present ones.
fn time(
    blueprint: &mut Blueprint,
    group: usize,
    name: &str,
    of: impl Fn(f64) -> f64 + Send + Sync + 'static,
) -> usize {
    let name = blueprint.own(name);
    let source = Source::Time(Box::new(move |moment| of(moment.seconds)));
    blueprint.variable(group, name, T::DateTime, source)
}
