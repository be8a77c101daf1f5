//! A six-axis robot as OPC 40010-1 (Robotics) lays it out below the DeviceSet of OPC 10000-100
//! (DI).

use asi_model::values::{
    BuiltInType as T, Identifier, LocalizedText, Namespace, NodeId, QualifiedName, Scalar, Variant,
};

use crate::{
    MachineConfig,
    blueprint::{
        Blueprint, Class, NodePlan, POWER_AGGREGATE, POWER_AGGREGATE_FIELDS, Source, TypePlan,
        Unit, ids, structure,
    },
    signals::{Moment, Production, quantised},
};

/// The Devices namespace.
pub const DI: &str = "http://opcfoundation.org/UA/DI/";
/// The Robotics namespace.
pub const ROBOTICS: &str = "http://opcfoundation.org/UA/Robotics/";

const AXES: u64 = 40;
const MOTORS: u64 = 60;
const PRODUCTION: Production =
    Production { cycle: 8.0, period: 720.0, interruption: 20.0, orders: None };
/// Swing of each axis: degrees to either side, and seconds per swing.
const SWINGS: [(f64, f64); 6] =
    [(120.0, 8.0), (60.0, 8.0), (80.0, 4.0), (150.0, 8.0), (90.0, 4.0), (300.0, 16.0)];

fn of(namespace: &str, name: &str) -> QualifiedName {
    QualifiedName { namespace: Namespace::uri(namespace), name: Some(name.into()) }
}

fn robotics(id: u32) -> NodeId {
    NodeId::numeric(ROBOTICS, id)
}

fn di(id: u32) -> NodeId {
    NodeId::numeric(DI, id)
}

/// The type nodes that instances refer to.
fn types() -> Vec<TypePlan> {
    let plan = |node_id, name, supertype| TypePlan { node_id, name, supertype };
    vec![
        plan(di(1001), "TopologyElementType", ids::BASE_OBJECT_TYPE),
        plan(di(15063), "ComponentType", di(1001)),
        plan(robotics(1002), "MotionDeviceSystemType", di(15063)),
        plan(robotics(1004), "MotionDeviceType", di(15063)),
        plan(robotics(16601), "AxisType", di(15063)),
        plan(robotics(16794), "PowerTrainType", di(15063)),
        plan(robotics(1019), "MotorType", di(15063)),
        plan(robotics(1003), "ControllerType", di(15063)),
        plan(robotics(1011), "TaskControlType", di(15063)),
        plan(robotics(1013), "SafetyStateType", di(15063)),
    ]
}

pub(super) fn robot(config: &MachineConfig) -> Blueprint {
    let mut blueprint = Blueprint::new(&config.namespace_uri());
    blueprint.type_namespaces = vec![DI, ROBOTICS];
    blueprint.numbers_nodes = true;
    blueprint.types = types();
    let device_set = blueprint.push(NodePlan {
        key: String::new(),
        node_id: Some(NodeId {
            namespace: Namespace::uri(DI),
            identifier: Identifier::Numeric(5001),
        }),
        parent: None,
        name: of(DI, "DeviceSet"),
        description: Some("All devices of this server"),
        class: Class::Object(ids::BASE_OBJECT_TYPE),
    });
    let name = blueprint.own(&config.name);
    let system = blueprint.object(device_set, name, robotics(1002));
    // Keys start below the system, as those of the other machines start below their root.
    blueprint.nodes[system].key = String::new();

    let devices = blueprint.object(system, of(ROBOTICS, "MotionDevices"), ids::FOLDER_TYPE);
    motion_device(&mut blueprint, devices, config);
    let controllers = blueprint.object(system, of(ROBOTICS, "Controllers"), ids::FOLDER_TYPE);
    controller(&mut blueprint, controllers, config);
    let states = blueprint.object(system, of(ROBOTICS, "SafetyStates"), ids::FOLDER_TYPE);
    safety(&mut blueprint, states);
    blueprint
}

fn constant(blueprint: &mut Blueprint, parent: usize, name: QualifiedName, value: Variant) {
    let data_type = value.built_in_type().unwrap_or(T::Variant);
    blueprint.child(parent, name, Class::Property(value, NodeId::ua(u32::from(data_type.id()))));
}

fn text(text: &str) -> Variant {
    Variant::Scalar(Scalar::LocalizedText(Box::new(LocalizedText {
        locale: None,
        text: Some(text.into()),
    })))
}

fn identify(blueprint: &mut Blueprint, device: usize, model: &str, serial_number: &str) {
    constant(blueprint, device, of(DI, "Manufacturer"), text("Gelenkarm Robotik"));
    constant(blueprint, device, of(DI, "Model"), text(model));
    constant(blueprint, device, of(DI, "ProductCode"), "GR-6".into());
    constant(blueprint, device, of(DI, "SerialNumber"), serial_number.into());
}

fn signal(
    blueprint: &mut Blueprint,
    parent: usize,
    name: &str,
    data_type: T,
    signal: impl Fn(Moment) -> Variant + Send + Sync + 'static,
) -> usize {
    blueprint.variable(parent, of(ROBOTICS, name), data_type, Source::Signal(Box::new(signal)))
}

fn motion_device(blueprint: &mut Blueprint, devices: usize, config: &MachineConfig) {
    let name = blueprint.own("MotionDevice1");
    let device = blueprint.object(devices, name, robotics(1004));
    identify(blueprint, device, "GR 6 R900", &config.serial_number());
    constant(blueprint, device, of(DI, "AssetId"), config.asset_id().into());
    constant(blueprint, device, of(ROBOTICS, "MotionDeviceCategory"), 1_i32.into());
    let parameters = blueprint.object(device, of(DI, "ParameterSet"), ids::BASE_OBJECT_TYPE);
    signal(blueprint, parameters, "InControl", T::Boolean, |_| true.into());
    signal(blueprint, parameters, "OnPath", T::Boolean, |moment| {
        PRODUCTION.at(moment).interruption.is_none().into()
    });
    let over = signal(blueprint, parameters, "SpeedOverride", T::Double, |moment| {
        (if PRODUCTION.at(moment).interruption.is_none() { 100.0 } else { 0.0 }).into()
    });
    blueprint.is_analog(over, Unit::PERCENT, Some((0.0, 100.0)));

    let axes = blueprint.object(device, of(ROBOTICS, "Axes"), ids::FOLDER_TYPE);
    let trains = blueprint.object(device, of(ROBOTICS, "PowerTrains"), ids::FOLDER_TYPE);
    for (index, swing) in SWINGS.into_iter().enumerate() {
        axis(blueprint, axes, index, swing);
        power_train(blueprint, trains, index);
    }
}

/// The robot moves only while it produces.
fn angle(moment: Moment, index: usize, (degrees, period): (f64, f64)) -> f64 {
    let seconds = PRODUCTION.at(moment).running_seconds;
    degrees * Moment { seconds, ..moment }.wave(AXES + index as u64, period)
}

fn axis(blueprint: &mut Blueprint, axes: usize, index: usize, swing: (f64, f64)) {
    let name = blueprint.own(&format!("Axis{}", index + 1));
    let axis = blueprint.object(axes, name, robotics(16601));
    constant(blueprint, axis, of(ROBOTICS, "MotionProfile"), 1_i32.into());
    let parameters = blueprint.object(axis, of(DI, "ParameterSet"), ids::BASE_OBJECT_TYPE);
    let position = signal(blueprint, parameters, "ActualPosition", T::Double, move |moment| {
        quantised(angle(moment, index, swing), 0.001).into()
    });
    blueprint.is_analog(position, Unit::DEGREE, Some((-swing.0 - 5.0, swing.0 + 5.0)));
    let speed = signal(blueprint, parameters, "ActualSpeed", T::Double, move |moment| {
        let step = 0.01;
        let before = Moment { seconds: (moment.seconds - step).max(0.0), ..moment };
        quantised((angle(moment, index, swing) - angle(before, index, swing)) / step, 0.1).into()
    });
    blueprint.is_analog(speed, Unit::DEGREE_PER_SECOND, None);
}

fn power_train(blueprint: &mut Blueprint, trains: usize, index: usize) {
    let name = blueprint.own(&format!("PowerTrain{}", index + 1));
    let train = blueprint.object(trains, name, robotics(16794));
    let name = blueprint.own(&format!("Motor{}", index + 1));
    let motor = blueprint.object(train, name, robotics(1019));
    identify(blueprint, motor, "Servo 1.5", &format!("M-{}", index + 1));
    let parameters = blueprint.object(motor, of(DI, "ParameterSet"), ids::BASE_OBJECT_TYPE);
    let stream = MOTORS + index as u64;
    let temperature = signal(blueprint, parameters, "MotorTemperature", T::Double, move |moment| {
        quantised(55.0 + 10.0 * moment.noise(stream, 50.0), 0.1).into()
    });
    blueprint.is_analog(temperature, Unit::CELSIUS, Some((0.0, 110.0)));
    signal(blueprint, parameters, "BrakeReleased", T::Boolean, |moment| {
        PRODUCTION.at(moment).interruption.is_none().into()
    });
    signal(blueprint, parameters, "EffectiveLoadRate", T::UInt16, move |moment| {
        ((45.0 + 35.0 * moment.noise(stream + 20, 4.0)) as u16).into()
    });
    // A vendor's own: the standard has no power of a single motor.
    let data_type = NodeId::numeric(&blueprint.namespace_uri, POWER_AGGREGATE);
    let value_type = data_type.clone();
    let name = blueprint.own("RecentPowerConsumption");
    let power = blueprint.variable(
        parameters,
        name,
        T::ExtensionObject,
        Source::Signal(Box::new(move |moment| {
            let window = Moment { seconds: (moment.seconds / 5.0).floor() * 5.0, ..moment };
            let average = quantised(300.0 + 200.0 * window.noise(stream + 20, 20.0), 0.1);
            let [seconds, min, max, avg] = POWER_AGGREGATE_FIELDS;
            let fields = [
                (seconds, 5_u32.into()),
                (min, quantised(average * 0.4, 0.1).into()),
                (max, quantised(average * 1.9, 0.1).into()),
                (avg, average.into()),
            ];
            structure(value_type.clone(), fields)
        })),
    );
    blueprint.has_data_type(power, data_type);
}

fn controller(blueprint: &mut Blueprint, controllers: usize, config: &MachineConfig) {
    let name = blueprint.own("Controller1");
    let controller = blueprint.object(controllers, name, robotics(1003));
    identify(blueprint, controller, "GRC 4", &format!("C-{}", config.serial_number()));
    let parameters = blueprint.object(controller, of(DI, "ParameterSet"), ids::BASE_OBJECT_TYPE);
    let energy = signal(blueprint, parameters, "TotalEnergyConsumption", T::Double, |moment| {
        let running = PRODUCTION.at(moment).running_seconds;
        quantised(running * 1800.0 + (moment.seconds - running) * 250.0, 100.0).into()
    });
    blueprint.is_analog(energy, Unit::JOULE, None);
    let temperature = signal(blueprint, parameters, "Temperature", T::Double, |moment| {
        quantised(31.0 + 4.0 * moment.noise(80, 90.0), 0.1).into()
    });
    blueprint.is_analog(temperature, Unit::CELSIUS, Some((0.0, 60.0)));

    let tasks = blueprint.object(controller, of(ROBOTICS, "TaskControls"), ids::FOLDER_TYPE);
    let name = blueprint.own("TaskControl1");
    let task = blueprint.object(tasks, name, robotics(1011));
    let parameters = blueprint.object(task, of(DI, "ParameterSet"), ids::BASE_OBJECT_TYPE);
    signal(blueprint, parameters, "TaskProgramName", T::String, |moment| {
        if (PRODUCTION.at(moment).parts / 20).is_multiple_of(2) {
            "PICK_FRAME".into()
        } else {
            "PALLETISE".into()
        }
    });
    signal(blueprint, parameters, "TaskProgramLoaded", T::Boolean, |_| true.into());
    signal(blueprint, parameters, "ExecutionMode", T::Int32, |_| 1_i32.into());
}

fn safety(blueprint: &mut Blueprint, states: usize) {
    let name = blueprint.own("SafetyState1");
    let state = blueprint.object(states, name, robotics(1013));
    let parameters = blueprint.object(state, of(DI, "ParameterSet"), ids::BASE_OBJECT_TYPE);
    signal(blueprint, parameters, "EmergencyStop", T::Boolean, |_| false.into());
    signal(blueprint, parameters, "ProtectiveStop", T::Boolean, |moment| {
        PRODUCTION.at(moment).interruption.is_some().into()
    });
    signal(blueprint, parameters, "OperationalMode", T::Int32, |_| 3_i32.into());
}
