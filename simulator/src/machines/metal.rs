//! Machines that make parts of metal: a milling cell and a press.

use std::sync::Arc;

use asi_model::values::{Array, BuiltInType as T, DateTime, NodeId, Scalar, Variant};

use super::order::order;
use crate::{
    MachineConfig, OrdersConfig,
    blueprint::{
        Blueprint, Class, POWER_AGGREGATE, POWER_AGGREGATE_FIELDS, Unit, english, ids, structure,
    },
    signals::{Moment, Production, Progress, quantised},
};

const TEMPERATURE: u64 = 20;
const POWER: u64 = 21;
const SPEED: u64 = 22;
const LOADS: u64 = 30;

/// Seconds over which power is aggregated.
const AGGREGATION: f64 = 10.0;
const PROGRAMS: [&str; 4] = ["FRAME-A.MPF", "FRAME-B.MPF", "BRACKET.MPF", "COVER.MPF"];
const ALARMS: [&str; 4] = [
    "2107 Spindle: tool life exceeded",
    "3001 Coolant: level low",
    "4020 Safety door open",
    "5113 Waiting for material",
];

/// States of such a machine; `MachineState` has these numbers and `StateText` these names.
const STATES: [&str; 4] = ["Idle", "Running", "Interrupted", "Alarm"];

/// Parameters that differ between the machines of this family.
#[derive(Clone, Copy)]
struct Character {
    production: Production,
    /// Watts while idle and while working.
    power: (f64, f64),
}

impl Character {
    fn progress(self, moment: Moment) -> Progress {
        self.production.at(moment)
    }

    fn power(self, moment: Moment) -> f64 {
        let (idle, working) = self.power;
        let progress = self.progress(moment);
        let load = if progress.works() {
            0.6 + 0.4 * (progress.cycle_progress * std::f64::consts::PI).sin()
        } else {
            0.0
        };
        let noise = 1.0 + 0.05 * moment.noise(POWER, 3.0);
        quantised((idle + (working - idle) * load) * noise, 1.0)
    }

    /// Energy is what the machine uses on average, so that it is a function of time alone.
    fn energy_watt_hours(self, moment: Moment) -> u64 {
        let (idle, working) = self.power;
        let running = self.progress(moment).running_seconds;
        ((running * (idle + working) / 2.0 + (moment.seconds - running) * idle) / 3600.0) as u64
    }

    fn power_aggregate(self, moment: Moment, data_type: &NodeId) -> Variant {
        let end = (moment.seconds / AGGREGATION).floor() * AGGREGATION;
        let samples = (0..10).map(|step| {
            let seconds = (end - AGGREGATION + f64::from(step) * AGGREGATION / 10.0).max(0.0);
            self.power(Moment { seconds, ..moment })
        });
        let (mut min, mut max, mut sum) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
        for watts in samples {
            (min, max, sum) = (min.min(watts), max.max(watts), sum + watts);
        }
        let [seconds, watts_min, watts_max, watts_avg] = POWER_AGGREGATE_FIELDS;
        structure(
            data_type.clone(),
            [
                (seconds, (AGGREGATION as u32).into()),
                (watts_min, min.into()),
                (watts_max, max.into()),
                (watts_avg, quantised(sum / 10.0, 0.1).into()),
            ],
        )
    }
}

fn state(progress: Progress) -> i32 {
    match progress.interruption {
        None => i32::from(progress.works()),
        Some(kind) if kind % 4 == 3 => 2,
        Some(_) => 3,
    }
}

pub(super) fn milling_cell(config: &MachineConfig) -> Blueprint {
    let cycle = config.cycle_seconds.unwrap_or(5.0);
    let orders = config.orders.as_ref().map(OrdersConfig::rhythm);
    let character = Character {
        production: Production { cycle, period: 600.0, interruption: 25.0, orders },
        power: (450.0, 6200.0),
    };
    let mut blueprint = Blueprint::new(&config.namespace_uri());
    let root = blueprint.root(&config.name, ids::BASE_OBJECT_TYPE);
    identification(&mut blueprint, root, "Fräswerk GmbH", "FW-500 5X", config);
    production(&mut blueprint, root, character, config.orders.as_ref());
    status(&mut blueprint, root, character);
    energy(&mut blueprint, root, character);

    let spindle = blueprint.group(root, "Spindle");
    let temperature = blueprint.signal(spindle, "Temperature", T::Double, move |moment| {
        let load = if character.progress(moment).works() { 1.0 } else { 0.0 };
        quantised(42.0 + 9.0 * load + 6.0 * moment.noise(TEMPERATURE, 45.0), 0.1).into()
    });
    blueprint.is_analog(temperature, Unit::CELSIUS, Some((0.0, 120.0)));
    blueprint.describe(temperature, "Temperature of the spindle's front bearing");
    let power =
        blueprint.signal(spindle, "Power", T::Double, move |moment| character.power(moment).into());
    blueprint.is_analog(power, Unit::WATT, Some((0.0, 15_000.0)));
    let speed = blueprint.signal(spindle, "Speed", T::Double, move |moment| {
        let turns = character.progress(moment).works();
        let speed = if turns { 8000.0 + 120.0 * moment.noise(SPEED, 2.0) } else { 0.0 };
        quantised(speed, 10.0).into()
    });
    blueprint.is_analog(speed, Unit::RPM, Some((0.0, 18_000.0)));

    let axes = blueprint.group(root, "Axes");
    let loads = blueprint.signal(axes, "Loads", T::Float, move |moment| {
        let load = |axis: u64| 30.0 + 25.0 * moment.noise(LOADS + axis, 1.5);
        let elements =
            (0..5).map(|axis| Scalar::Float(quantised(load(axis), 0.5) as f32)).collect();
        Variant::Array(Arc::new(Array { element_type: T::Float, elements, dimensions: None }))
    });
    blueprint.is_array(loads);
    blueprint.describe(loads, "Loads of the axes X, Y, Z, B and C in percent");
    blueprint
}

pub(super) fn press(config: &MachineConfig) -> Blueprint {
    let cycle = config.cycle_seconds.unwrap_or(2.0);
    let orders = config.orders.as_ref().map(OrdersConfig::rhythm);
    let character = Character {
        production: Production { cycle, period: 900.0, interruption: 40.0, orders },
        power: (900.0, 11_000.0),
    };
    let mut blueprint = Blueprint::new(&config.namespace_uri());
    let root = blueprint.root(&config.name, ids::BASE_OBJECT_TYPE);
    identification(&mut blueprint, root, "Pressenbau AG", "PX 250", config);
    production(&mut blueprint, root, character, config.orders.as_ref());
    status(&mut blueprint, root, character);
    energy(&mut blueprint, root, character);

    let ram = blueprint.group(root, "Ram");
    blueprint.signal(ram, "Strokes", T::UInt64, move |moment| {
        // Every tenth stroke is an empty one.
        let parts = character.progress(moment).parts_in_all;
        (parts + parts / 10).into()
    });
    let force = blueprint.signal(ram, "Force", T::Double, move |moment| {
        let stroke =
            (character.progress(moment).cycle_progress * std::f64::consts::PI).sin().powi(4);
        quantised(2400.0 * stroke * (1.0 + 0.02 * moment.noise(SPEED, 2.0)), 1.0).into()
    });
    blueprint.is_analog(force, Unit::KILONEWTON, Some((0.0, 2500.0)));
    let temperature = blueprint.signal(ram, "DieTemperature", T::Float, move |moment| {
        (quantised(65.0 + 12.0 * moment.noise(TEMPERATURE, 60.0), 0.1) as f32).into()
    });
    blueprint.is_analog(temperature, Unit::CELSIUS, Some((0.0, 200.0)));
    blueprint
}

fn identification(
    blueprint: &mut Blueprint,
    root: usize,
    maker: &str,
    model: &str,
    config: &MachineConfig,
) {
    let group = blueprint.group(root, "Identification");
    for (name, value) in [
        ("Manufacturer", maker.to_owned()),
        ("Model", model.to_owned()),
        ("SerialNumber", config.serial_number()),
    ] {
        blueprint.signal(group, name, T::String, move |_| value.as_str().into());
    }
}

fn production(
    blueprint: &mut Blueprint,
    root: usize,
    character: Character,
    orders: Option<&OrdersConfig>,
) {
    let group = blueprint.group(root, "Production");
    let parts = blueprint.signal(group, "PartCounter", T::UInt32, move |moment| {
        (character.progress(moment).parts as u32).into()
    });
    blueprint.describe(parts, "Parts made, good and bad");
    blueprint.keeps_history(parts);
    blueprint.signal(group, "GoodCounter", T::UInt32, move |moment| {
        let progress = character.progress(moment);
        ((progress.parts - progress.scrap) as u32).into()
    });
    blueprint.signal(group, "ScrapCounter", T::UInt32, move |moment| {
        (character.progress(moment).scrap as u32).into()
    });
    let total = blueprint.signal(group, "TotalParts", T::UInt64, move |moment| {
        // The machine had a life before, longer than 32 or 53 bits can count.
        ((1_u64 << 53) + 1 + character.progress(moment).parts_in_all).into()
    });
    blueprint.describe(total, "Parts made in the machine's life");
    blueprint.signal(group, "LastPartAt", T::DateTime, move |moment| {
        // Known to the second of simulated time since an epoch of the machine's own.
        let parts = character.progress(moment).parts_in_all as f64;
        let epoch: DateTime = "2026-01-01T00:00:00Z".parse().expect("a valid time");
        epoch.after(std::time::Duration::from_secs_f64(parts * character.production.cycle)).into()
    });
    let cycle = blueprint.signal(group, "CycleTime", T::Double, move |moment| {
        quantised(character.production.cycle * (1.0 + 0.03 * moment.noise(SPEED, 20.0)), 0.01)
            .into()
    });
    blueprint.is_analog(cycle, Unit::SECOND, None);
    blueprint.signal(group, "CurrentProgram", T::String, move |moment| {
        let progress = character.progress(moment);
        // An order is of one product.
        let turn = if progress.order.is_some() { 0 } else { progress.parts / 40 };
        PROGRAMS[turn as usize % PROGRAMS.len()].into()
    });
    if let Some(orders) = orders {
        order(blueprint, group, character.production, orders);
        return;
    }
    blueprint.written(group, "OrderId", "none");
    blueprint.written(group, "OrderedQuantity", 0_u32);
    let name = blueprint.own("StartJob");
    let method = blueprint.child(group, name, Class::StartJob);
    blueprint.describe(method, "Takes an order and its quantity");
}

fn status(blueprint: &mut Blueprint, root: usize, character: Character) {
    let group = blueprint.group(root, "Status");
    let number = blueprint.signal(group, "MachineState", T::Int32, move |moment| {
        state(character.progress(moment)).into()
    });
    blueprint.describe(number, "0 Idle, 1 Running, 2 Interrupted, 3 Alarm");
    blueprint.signal(group, "StateText", T::String, move |moment| {
        STATES[usize::try_from(state(character.progress(moment))).unwrap_or(0)].into()
    });
    blueprint.signal(group, "AlarmActive", T::Boolean, move |moment| {
        (state(character.progress(moment)) == 3).into()
    });
    blueprint.signal(group, "AlarmText", T::LocalizedText, move |moment| {
        let alarm = character
            .progress(moment)
            .interruption
            .map(|kind| ALARMS[usize::from(kind) % ALARMS.len()]);
        english(alarm.unwrap_or_default())
    });
    blueprint.signal(group, "AlarmCount", T::UInt32, move |moment| {
        (character.progress(moment).interruptions as u32).into()
    });
    let word = blueprint.signal(group, "StatusWord", T::UInt16, move |moment| {
        let progress = character.progress(moment);
        // Bit 0 powered, 1 running, 2 alarm, 3 door closed, 8 part in the clamp.
        let bits = [
            (0, true),
            (1, progress.works()),
            (2, state(progress) == 3),
            (3, progress.interruption.is_none_or(|kind| kind % 4 != 2)),
            (8, progress.cycle_progress < 0.95),
        ];
        bits.into_iter()
            .filter(|(_, is_set)| *is_set)
            .fold(0_u16, |word, (bit, _)| word | 1 << bit)
            .into()
    });
    blueprint.describe(word, "Bit 0 powered, 1 running, 2 alarm, 3 door closed, 8 part clamped");
}

fn energy(blueprint: &mut Blueprint, root: usize, character: Character) {
    let group = blueprint.group(root, "Energy");
    let total = blueprint.signal(group, "TotalEnergy", T::UInt64, move |moment| {
        character.energy_watt_hours(moment).into()
    });
    blueprint.is_analog(total, Unit::WATT_HOUR, None);
    blueprint.signal(group, "OperatingSeconds", T::UInt64, move |moment| {
        (character.progress(moment).running_seconds as u64).into()
    });
    let data_type = NodeId::numeric(&blueprint.namespace_uri, POWER_AGGREGATE);
    let value_type = data_type.clone();
    let power = blueprint.signal(group, "Power", T::ExtensionObject, move |moment| {
        character.power_aggregate(moment, &value_type)
    });
    blueprint.has_data_type(power, data_type);
    blueprint.describe(power, "Power over the last ten seconds");
}
