//! Received messages that wait in memory, bounded together by their bytes.

use std::sync::Arc;

use bytes::Bytes;
use rumqttc::v5::mqttbytes::v5::Publish;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// Largest messages that may wait at the same time, of all addresses of a connection.
const LARGEST_MESSAGES_MAX: u64 = 16;

/// Memory for the received messages of one connection that are not settled yet.
pub(super) struct Memory {
    free: Arc<Semaphore>,
    bytes_max: u32,
}

/// A message with the memory that it takes, which is free again with the end of this.
pub(super) struct Held {
    pub publish: Publish,
    pub memory: OwnedSemaphorePermit,
}

impl Memory {
    /// Memory for messages of which the largest has `message_bytes_max` bytes.
    pub(super) fn new(message_bytes_max: u64) -> Self {
        let bytes_max = message_bytes_max.saturating_mul(LARGEST_MESSAGES_MAX);
        // No semaphore has more permits than `MAX_PERMITS`.
        let bytes_max = u32::try_from(bytes_max).unwrap_or(u32::MAX).min(u32::MAX >> 3);
        Self { free: Arc::new(Semaphore::new(bytes_max as usize)), bytes_max }
    }

    /// Waits for the memory of a message.
    pub(super) async fn hold(&self, mut publish: Publish) -> Held {
        detach(&mut publish);
        // What is larger than all memory takes all of it.
        let bytes = u32::try_from(bytes_of(&publish)).unwrap_or(u32::MAX).min(self.bytes_max);
        let memory = Arc::clone(&self.free).acquire_many_owned(bytes).await;
        Held { publish, memory: memory.expect("the semaphore is never closed") }
    }
}

/// Copies what refers to the buffer of the connection: a message of ten bytes would keep all of that
/// buffer, which is as large as the largest packet read into it.
fn detach(publish: &mut Publish) {
    let copy = |bytes: &mut Bytes| *bytes = Bytes::copy_from_slice(bytes);
    copy(&mut publish.topic);
    copy(&mut publish.payload);
    publish.properties.as_mut().and_then(|found| found.correlation_data.as_mut()).map(copy);
}

/// Bytes of memory that a message takes.
fn bytes_of(publish: &Publish) -> usize {
    let mut bytes = size_of::<Held>() + publish.topic.len() + publish.payload.len();
    if let Some(properties) = &publish.properties {
        let text = |text: &Option<String>| text.as_ref().map_or(0, String::len);
        let users = &properties.user_properties;
        bytes += text(&properties.response_topic)
            + text(&properties.content_type)
            + properties.correlation_data.as_ref().map_or(0, Bytes::len)
            + properties.subscription_identifiers.capacity() * size_of::<usize>()
            + users.capacity() * size_of::<(String, String)>()
            + users.iter().map(|(name, value)| name.len() + value.len()).sum::<usize>();
    }
    bytes
}
