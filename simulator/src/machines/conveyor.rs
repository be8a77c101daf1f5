//! A belt conveyor with a light barrier.

use asi_model::values::BuiltInType as T;

use super::order::order;
use crate::{
    MachineConfig, OrdersConfig,
    blueprint::{Blueprint, Unit, ids},
    signals::{Production, quantised},
};

const SPEED: u64 = 20;
const TEMPERATURE: u64 = 21;
const ITEMS: u64 = 22;

pub(super) fn conveyor(config: &MachineConfig) -> Blueprint {
    // A part is an item that passes the light barrier, an interruption is a jam.
    let cycle = config.cycle_seconds.unwrap_or(3.0);
    let orders = config.orders.as_ref().map(OrdersConfig::rhythm);
    let production = Production { cycle, period: 420.0, interruption: 15.0, orders };
    let mut blueprint = Blueprint::new(&config.namespace_uri());
    let root = blueprint.root(&config.name, ids::BASE_OBJECT_TYPE);

    let belt = blueprint.group(root, "Belt");
    let speed = blueprint.signal(belt, "Speed", T::Double, move |moment| {
        let runs = production.at(moment).works();
        quantised(if runs { 12.0 + 0.3 * moment.noise(SPEED, 4.0) } else { 0.0 }, 0.01).into()
    });
    blueprint.is_analog(speed, Unit::METRE_PER_MINUTE, Some((0.0, 30.0)));
    let setpoint = blueprint.written(belt, "SpeedSetpoint", 12.0);
    blueprint.is_analog(setpoint, Unit::METRE_PER_MINUTE, Some((0.0, 30.0)));
    blueprint.signal(belt, "Jam", T::Boolean, move |moment| {
        production.at(moment).interruption.is_some().into()
    });
    blueprint.signal(belt, "JamCount", T::UInt32, move |moment| {
        (production.at(moment).interruptions as u32).into()
    });

    let items = blueprint.group(root, "Items");
    blueprint
        .signal(items, "ItemCount", T::UInt64, move |moment| production.at(moment).parts.into());
    blueprint.signal(items, "ItemsOnBelt", T::UInt16, move |moment| {
        ((5.0 + 4.0 * moment.noise(ITEMS, 15.0)).round() as u16).into()
    });
    blueprint.signal(items, "ItemAtBarrier", T::Boolean, move |moment| {
        (production.at(moment).cycle_progress > 0.9).into()
    });
    if let Some(orders) = &config.orders {
        order(&mut blueprint, items, production, orders);
    }

    let motor = blueprint.group(root, "Motor");
    let temperature = blueprint.signal(motor, "Temperature", T::Float, move |moment| {
        (quantised(48.0 + 7.0 * moment.noise(TEMPERATURE, 60.0), 0.1) as f32).into()
    });
    blueprint.is_analog(temperature, Unit::CELSIUS, Some((-20.0, 130.0)));
    blueprint
}
