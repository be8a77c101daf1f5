//! Any request is accepted or has faults; an accepted one is accepted again, splits, differs and is
//! scheduled.

use asi_model::{
    difference::difference,
    instance::{self, Instance},
    messages::PlatformMessage,
    node_set,
    schedule::Schedule,
    split,
    validation::{parse_any_platform_message, parse_network},
};

/// Plays one input.
pub fn platform_message(bytes: &[u8]) {
    let _ = parse_network(bytes);
    match parse_any_platform_message(bytes) {
        Err(rejection) => assert!(!rejection.faults.is_empty() && rejection.faults.len() <= 101),
        Ok(message) => {
            let PlatformMessage::OperationNetwork(request) = &message else { return };
            let network = &request.operation_network;
            let _ = Schedule::of(network);
            let part = split::factory_part(network, &request.factory_id);
            let _ = difference(network, &part);
            assert!(difference(network, network).is_empty());
            let nodes = instance::node_set(&Instance::new(request));
            assert!(node_set::read(node_set::write(&nodes).as_bytes()).is_ok());
        }
    }
}
