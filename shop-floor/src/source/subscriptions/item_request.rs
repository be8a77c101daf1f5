//! Request for one monitored item.

use opcua_stack::opcua::types::{
    AttributeId, ExtensionObject, MonitoredItemCreateRequest, MonitoringMode, MonitoringParameters,
    NodeId, QualifiedName, ReadValueId, StatusCode,
};

use crate::{
    MonitorOptions, ShopFloorError,
    monitor_options::{numeric_range, sampling_interval_ms},
};

/// Longest queue requested when the options have none.
const QUEUE_MAX: u32 = 100;
/// Length of the queue of an item that is sampled on every change.
const QUEUE_ON_CHANGE: u32 = 10;

/// Returns the request for an item under a client handle; the interval is in milliseconds.
pub(super) fn new(
    node_id: NodeId,
    options: &MonitorOptions,
    handle: u32,
    publishing_ms: f64,
) -> MonitoredItemCreateRequest {
    let sampling_interval = sampling_interval_ms(options, publishing_ms);
    MonitoredItemCreateRequest {
        item_to_monitor: ReadValueId {
            node_id,
            attribute_id: AttributeId::Value as u32,
            index_range: numeric_range(options),
            data_encoding: QualifiedName::null(),
        },
        monitoring_mode: MonitoringMode::Reporting,
        requested_parameters: MonitoringParameters {
            client_handle: handle,
            sampling_interval,
            filter: ExtensionObject::null(),
            queue_size: options
                .queue_size
                .unwrap_or_else(|| queue_size(sampling_interval, publishing_ms)),
            discard_oldest: true,
        },
    }
}

/// Returns the queue length that holds all changes between two publishings.
fn queue_size(sampling_ms: f64, publishing_ms: f64) -> u32 {
    if sampling_ms <= 0.0 {
        return QUEUE_ON_CHANGE;
    }
    let changes = (publishing_ms / sampling_ms).ceil().clamp(1.0, f64::from(QUEUE_MAX) - 1.0);
    changes as u32 + 1
}

/// Returns true for an error after which a request with fewer items may succeed.
pub(super) fn is_too_large(error: &ShopFloorError) -> bool {
    match error {
        ShopFloorError::Refused { status } => matches!(
            StatusCode::from(status.0),
            StatusCode::BadTooManyOperations
                | StatusCode::BadRequestTooLarge
                | StatusCode::BadResponseTooLarge
                | StatusCode::BadEncodingLimitsExceeded
                | StatusCode::BadTcpMessageTooLarge
                | StatusCode::BadOutOfMemory
                | StatusCode::BadResourceUnavailable
        ),
        ShopFloorError::Timeout(_) => true,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn queues_hold_all_changes_between_two_publishings() {
        for (sampling, publishing, expected) in [
            (100.0, 100.0, 2),
            (10.0, 100.0, 11),
            (0.0, 20.0, 10),
            (1.0, 60_000.0, 100),
            (1000.0, 20.0, 2),
        ] {
            assert_eq!(
                queue_size(sampling, publishing),
                expected,
                "{sampling} ms in {publishing} ms"
            );
        }
    }
}
