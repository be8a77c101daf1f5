//! A bank of counters that change at a steady rate: no machine, but a load to measure with.

use asi_model::values::BuiltInType;

use crate::{
    MachineConfig,
    blueprint::{Blueprint, Source, ids},
};

/// `Counter0` and so on, Int64, directly below the root. Together they change `changes_per_second`
/// times.
pub(super) fn bank(config: &MachineConfig) -> Blueprint {
    let mut blueprint = Blueprint::new(&config.namespace_uri());
    let root = blueprint.root(&config.name, ids::BASE_OBJECT_TYPE);
    for index in 0..config.variables {
        let name = blueprint.own(&format!("Counter{index}"));
        blueprint.variable(root, name, BuiltInType::Int64, Source::Counter);
    }
    blueprint
}
