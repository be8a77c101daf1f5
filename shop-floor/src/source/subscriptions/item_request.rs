//! Request for one monitored item.

use opcua_stack::opcua::types::{
    AttributeId, EventFilter, ExtensionObject, MonitoredItemCreateRequest, MonitoringMode,
    MonitoringParameters, NodeId, NumericRange, QualifiedName, ReadValueId, StatusCode,
};

use super::grant::SubscriptionGrant;
use crate::{
    MonitorOptions, ShopFloorError,
    monitor_options::{numeric_range, sampling_interval_ms},
};

/// Events that the server is asked to queue between two publishings when the options have no number.
const EVENT_QUEUE: u32 = 1000;

/// Returns the request for an item under a client handle, in a subscription with this grant; the interval of an input
/// that asks for none is in milliseconds.
pub(super) fn new(
    node_id: NodeId,
    options: &MonitorOptions,
    handle: u32,
    default_sampling_ms: f64,
    grant: SubscriptionGrant,
) -> MonitoredItemCreateRequest {
    let sampling_interval = sampling_interval_ms(options, default_sampling_ms);
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
            queue_size: options.queue_size.unwrap_or_else(|| grant.queue_size(sampling_interval)),
            discard_oldest: true,
        },
    }
}

/// Returns the request for an item that takes the events of a notifier.
pub(super) fn of_events(
    node_id: NodeId,
    filter: EventFilter,
    options: &MonitorOptions,
    handle: u32,
) -> MonitoredItemCreateRequest {
    MonitoredItemCreateRequest {
        item_to_monitor: ReadValueId {
            node_id,
            attribute_id: AttributeId::EventNotifier as u32,
            index_range: NumericRange::None,
            data_encoding: QualifiedName::null(),
        },
        monitoring_mode: MonitoringMode::Reporting,
        requested_parameters: MonitoringParameters {
            client_handle: handle,
            // Events are not sampled.
            sampling_interval: 0.0,
            filter: ExtensionObject::from_message(filter),
            queue_size: options.queue_size.unwrap_or(EVENT_QUEUE),
            discard_oldest: true,
        },
    }
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
