//! The limits we run the stack with, in one place.
//!
//! Defaults of the stack that lose data or bite early, each observed: a publish response over the
//! default message size is dropped with a log line only (about 10 000 changes); more than 20 queued
//! notification messages drop the oldest; arrays over 1000 elements do not decode (a notification
//! with more than 1000 changes is such an array); 1000 monitored items per subscription; a sampling
//! interval of 0 becomes 100 ms, and the publishing tick is 100 ms.

use std::time::Duration;

use opcua::{client::ClientBuilder, server::ServerBuilder};

/// Longest message in bytes, each way. Holds a notification of some 500 000 small changes. Decoded, its values take four
/// times as much at most, or 32 MiB where that is more.
pub const MESSAGE_BYTES_MAX: usize = 64 << 20;
/// Longest message in bytes of a server that nobody vouches for: the connection is not protected, so anybody may answer.
/// Holds a notification of some 100 000 small changes.
pub const STRANGERS_MESSAGE_BYTES_MAX: usize = 16 << 20;
/// Most bytes that all connections of a client to servers hold of messages that are not complete or not delivered yet.
/// Each connection has its part of it, and what the others leave.
pub const INCOMING_BYTES_MAX: usize = 256 << 20;
/// Shortest chunk in bytes that a server may be content with.
const CHUNK_BYTES_MIN: usize = 8 << 10;
/// Most chunks of one message to a server; with chunks of 64 KiB more than [`MESSAGE_BYTES_MAX`] needs.
pub const CHUNKS_PER_MESSAGE_MAX: usize = 2000;
/// Most elements of an array, so also most changes in one notification.
pub const ARRAY_ELEMENTS_MAX: usize = 1_000_000;
/// Longest string or byte string in bytes.
pub const STRING_BYTES_MAX: usize = 16 << 20;
/// Most monitored items of one subscription on our servers.
pub const MONITORED_ITEMS_PER_SUBSCRIPTION_MAX: usize = 100_000;
/// Longest queue of a monitored item on our servers.
pub const MONITORED_ITEM_QUEUE_MAX: usize = 1000;
/// Most notification messages that wait for a Publish request.
pub const QUEUED_NOTIFICATIONS_MAX: usize = 1000;
/// Most sessions of one server.
pub const SESSIONS_MAX: usize = 100;
/// Most subscriptions of one session.
pub const SUBSCRIPTIONS_PER_SESSION_MAX: usize = 100;
/// Most monitored items we put into one subscription as a client: split publish responses would be
/// slow, and several subscriptions spread the work.
pub const ITEMS_PER_SUBSCRIPTION: usize = 5000;
/// Interval at which our servers look for subscriptions that are due.
pub const PUBLISHING_TICK: Duration = Duration::from_millis(5);
/// Shortest publishing interval that our servers grant.
pub const PUBLISHING_INTERVAL_MIN: Duration = Duration::from_millis(5);

/// Raises the limits of a server.
///
/// The caller still decides on certificates, users and trust.
#[must_use]
pub fn raise_server(mut builder: ServerBuilder) -> ServerBuilder {
    let limits = builder.limits_mut();
    limits.max_message_size = MESSAGE_BYTES_MAX;
    limits.max_chunk_count = CHUNKS_PER_MESSAGE_MAX;
    limits.max_array_length = ARRAY_ELEMENTS_MAX;
    limits.max_string_length = STRING_BYTES_MAX;
    limits.max_byte_string_length = STRING_BYTES_MAX;
    limits.max_sessions = SESSIONS_MAX;
    limits.operational.max_nodes_per_translate_browse_paths_to_node_ids = 10_000;
    limits.operational.max_monitored_items_per_call = 10_000;
    limits.operational.max_references_per_browse_node = 10_000;
    limits.operational.max_subscriptions_per_call = SUBSCRIPTIONS_PER_SESSION_MAX;
    let subscriptions = &mut limits.subscriptions;
    subscriptions.max_subscriptions_per_session = SUBSCRIPTIONS_PER_SESSION_MAX;
    subscriptions.max_pending_publish_requests = 2 * SUBSCRIPTIONS_PER_SESSION_MAX;
    subscriptions.min_sampling_interval_ms = 0.0;
    subscriptions.min_publishing_interval_ms = PUBLISHING_INTERVAL_MIN.as_secs_f64() * 1000.0;
    subscriptions.max_monitored_items_per_sub = MONITORED_ITEMS_PER_SUBSCRIPTION_MAX;
    subscriptions.max_monitored_item_queue_size = MONITORED_ITEM_QUEUE_MAX;
    subscriptions.max_queued_notifications = QUEUED_NOTIFICATIONS_MAX;
    builder
        .subscription_poll_interval_ms(
            u64::try_from(PUBLISHING_TICK.as_millis()).expect("a tick is a few milliseconds"),
        )
        .max_session_timeout_ms(3_600_000)
}

/// Raises the limits of a client of a server whose certificate is trusted, so that each chunk is signed by it.
///
/// The caller still decides on reconnecting, certificates and trust.
#[must_use]
pub fn raise_client(builder: ClientBuilder) -> ClientBuilder {
    raise_client_to(builder, MESSAGE_BYTES_MAX)
}

/// Raises the limits of a client of a server that may be anybody.
///
/// The caller still decides on reconnecting.
#[must_use]
pub fn raise_client_of_stranger(builder: ClientBuilder) -> ClientBuilder {
    raise_client_to(builder, STRANGERS_MESSAGE_BYTES_MAX)
}

fn raise_client_to(builder: ClientBuilder, message_bytes_max: usize) -> ClientBuilder {
    builder
        .max_message_size(message_bytes_max)
        .max_chunk_count(message_bytes_max / CHUNK_BYTES_MIN)
        .max_array_length(ARRAY_ELEMENTS_MAX)
        .max_string_length(STRING_BYTES_MAX)
        .max_byte_string_length(STRING_BYTES_MAX)
        // The default of 100 ms would hold back what a server publishes faster.
        .min_publish_interval(Duration::from_millis(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_that_lose_data_are_raised() {
        let builder = raise_server(ServerBuilder::new());
        let limits = &builder.config().limits;
        assert_eq!(limits.max_message_size, MESSAGE_BYTES_MAX);
        let decoded = builder.config().decoding_options().decoded_memory_gauge.max_bytes();
        assert_eq!(decoded, 4 * MESSAGE_BYTES_MAX);
        assert_eq!(limits.subscriptions.max_queued_notifications, QUEUED_NOTIFICATIONS_MAX);
        assert!(limits.subscriptions.min_sampling_interval_ms.abs() < f64::EPSILON);
        assert_eq!(builder.config().subscription_poll_interval_ms, 5);
    }

    #[test]
    fn a_machine_may_use_the_shortest_chunks_of_the_standard() {
        assert_eq!(CHUNK_BYTES_MIN, opcua::core::comms::tcp_types::MIN_CHUNK_SIZE);
    }
}
