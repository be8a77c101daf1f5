//! Browsing of servers by a person who chooses variables.

use asi_model::{NodeId, values::BuiltInType};
use shop_floor::{NodeClass, ShopFloorHandle, SourceId};
use simulator::{MachineConfig, MachineKind};

use crate::support::{Simulation, TestShopFloor, node};

/// Follows browse names (without namespaces) from the Objects folder.
async fn follow(
    floor: &ShopFloorHandle,
    source: &SourceId,
    path: &[&str],
) -> shop_floor::BrowsedNode {
    let mut at: Option<shop_floor::BrowsedNode> = None;
    for name in path {
        let children =
            floor.browse(source, at.as_ref().map(|node| &node.node_id)).await.expect("browse");
        let names: Vec<_> = children.iter().map(|child| child.display_name.clone()).collect();
        at = Some(
            children
                .into_iter()
                .find(|child| child.display_name == *name)
                .unwrap_or_else(|| panic!("{name} is not among {names:?}")),
        );
    }
    at.expect("a path")
}

#[tokio::test]
async fn a_variable_shows_type_unit_and_range() {
    let simulation = Simulation::milling_cell().await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    let source = floor.connect(&cell).await;

    let spindle = follow(&floor.handle, &source, &["Cell", "Spindle"]).await;
    assert_eq!((spindle.node_class, spindle.has_children), (NodeClass::Object, true));
    let temperature = follow(&floor.handle, &source, &["Cell", "Spindle", "Temperature"]).await;
    assert_eq!(temperature.node_id, node(&cell, "Spindle.Temperature"));
    assert_eq!(temperature.browse_name, "nsu=urn:verbund:simulator:Cell;Temperature");
    assert_eq!(temperature.node_class, NodeClass::Variable);
    assert_eq!(
        temperature.type_definition.as_ref().map(|found| found.name.as_str()),
        Some("AnalogUnitRangeType")
    );
    assert_eq!(temperature.data_type.as_ref().map(|found| found.name.as_str()), Some("Double"));
    assert_eq!(temperature.built_in_type, Some(BuiltInType::Double));
    assert_eq!(temperature.value_rank, Some(-1));
    let unit = temperature.unit.as_ref().expect("a unit");
    assert_eq!((unit.display_name.as_str(), unit.code.as_deref()), ("°C", Some("CEL")));
    assert_eq!(temperature.range, Some((0.0, 120.0)));
    assert!(!temperature.is_writable);
    assert_eq!(
        temperature.description.as_deref(),
        Some("Temperature of the spindle's front bearing")
    );

    let loads = follow(&floor.handle, &source, &["Cell", "Axes", "Loads"]).await;
    assert_eq!((loads.built_in_type, loads.value_rank), (Some(BuiltInType::Float), Some(1)));
    let order = follow(&floor.handle, &source, &["Cell", "Production", "OrderId"]).await;
    assert!(order.is_writable);
    let power =
        floor.handle.describe(&source, &node(&cell, "Energy.Power")).await.expect("described");
    assert_eq!(power.built_in_type, Some(BuiltInType::ExtensionObject));
    assert_eq!(power.data_type.map(|found| found.name), Some("PowerAggregateType".into()));
    let missing = NodeId::string("urn:verbund:simulator:Cell", "Missing");
    assert!(floor.handle.describe(&source, &missing).await.is_err());
}

#[tokio::test]
async fn children_come_in_pages_that_are_the_whole() {
    let simulation = Simulation::milling_cell().await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    let source = floor.connect(&cell).await;
    let parent = follow(&floor.handle, &source, &["Cell"]).await.node_id;
    let whole = floor.handle.browse(&source, Some(&parent)).await.expect("browse");
    assert!(whole.len() > 3, "{} children are too few to be paged", whole.len());

    let (mut paged, mut from) = (Vec::new(), 0);
    loop {
        let (page, next) =
            floor.handle.browse_from(&source, Some(&parent), from, 2).await.expect("a page");
        assert!(page.len() <= 2);
        paged.extend(page.into_iter().map(|node| node.node_id));
        match next {
            Some(next) => from = next,
            None => break,
        }
    }
    assert_eq!(paged, whole.into_iter().map(|node| node.node_id).collect::<Vec<_>>());
    let (behind, next) =
        floor.handle.browse_from(&source, Some(&parent), 1000, 2).await.expect("behind the end");
    assert!(behind.is_empty() && next.is_none());
}

#[tokio::test]
async fn a_robot_is_laid_out_as_the_standard_says() {
    let simulation = Simulation::of(vec![MachineConfig::new("Robot1", MachineKind::Robot)]).await;
    let robot = simulation.machine("Robot1");
    let floor = TestShopFloor::start();
    let source = floor.connect(&robot).await;
    let path = [
        "DeviceSet",
        "Robot1",
        "MotionDevices",
        "MotionDevice1",
        "Axes",
        "Axis2",
        "ParameterSet",
        "ActualPosition",
    ];
    let position = follow(&floor.handle, &source, &path).await;
    assert_eq!(position.browse_name, "nsu=http://opcfoundation.org/UA/Robotics/;ActualPosition");
    assert_eq!(position.unit.and_then(|unit| unit.code).as_deref(), Some("DD"));
    assert!(position.range.is_some());
    let axis = follow(&floor.handle, &source, &path[..6]).await;
    let axis_type = axis.type_definition.expect("a type");
    assert_eq!(axis_type.node_id, NodeId::numeric("http://opcfoundation.org/UA/Robotics/", 16601));
    assert_eq!(axis_type.name, "AxisType");

    let found = floor.handle.search(&source, "actualposition", 100).await.expect("search");
    assert_eq!(found.len(), 6);
    let second = found.iter().find(|found| found.node_id == position.node_id).expect("found");
    let found_path = second.browse_path.as_ref().expect("a search says where");
    assert_eq!(found_path.to_string(), path.join("/"));
    let asked = floor.handle.browse_path(&source, &position.node_id).await.expect("a path");
    assert_eq!(&asked, found_path);
}

#[tokio::test]
async fn all_variables_are_listed_with_the_types_they_stand_under() {
    let simulation = Simulation::of(vec![MachineConfig::new("Robot1", MachineKind::Robot)]).await;
    let floor = TestShopFloor::start();
    let source = floor.connect(&simulation.machine("Robot1")).await;
    let list = floor.handle.variables(&source, 100_000).await.expect("listed");
    assert!(list.is_complete);
    let path =
        "DeviceSet/Robot1/MotionDevices/MotionDevice1/Axes/Axis2/ParameterSet/ActualPosition";
    let position = list
        .variables
        .iter()
        .find(|found| found.browse_path.to_string() == path)
        .expect("the position");
    let has = |name: &str| position.type_names.iter().any(|found| **found == *name);
    assert!(
        has("AxisType") && has("MotionDeviceType") && !has("BaseObjectType"),
        "{:?}",
        position.type_names
    );
    assert_eq!(position.display_name, "ActualPosition");
    let is_aside = |path: &str| path.starts_with("Server/") || path.ends_with("/EngineeringUnits");
    assert!(!list.variables.iter().any(|found| is_aside(&found.browse_path.to_string())));

    let found = floor
        .handle
        .describe_many(&source, std::slice::from_ref(&position.node_id))
        .await
        .expect("described");
    assert_eq!(found[0].unit.as_ref().and_then(|unit| unit.code.as_deref()), Some("DD"));
    let part = floor.handle.variables(&source, 10).await.expect("listed");
    assert!(!part.is_complete && part.variables.len() < list.variables.len());
}
