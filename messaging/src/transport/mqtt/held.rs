//! Received messages that wait in memory, bounded by their bytes: those of a session, and those of all together.

use std::sync::Arc;

use bytes::Bytes;
use rumqttc::v5::mqttbytes::v5::Publish;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// Largest messages that may wait at the same time, of all addresses of a link.
const LARGEST_MESSAGES_MAX: u64 = 16;
/// The same of an address that has a session of its own.
const LARGEST_MESSAGES_OF_ADDRESS_MAX: u64 = 2;

/// Memory for received messages that are not settled yet.
#[derive(Clone)]
pub(super) struct Memory {
    message_bytes_max: u64,
    /// A message takes of each: first of what is for one session, then of what is for all.
    shares: Vec<MemoryShare>,
}

#[derive(Clone)]
struct MemoryShare {
    free: Arc<Semaphore>,
    bytes_max: u32,
}

/// Memory that a message takes, free again with the end of this.
pub(super) type HeldMemory = Vec<OwnedSemaphorePermit>;

/// A message with the memory that it takes.
pub(super) struct Held {
    pub publish: Publish,
    pub memory: HeldMemory,
}

impl MemoryShare {
    fn new(message_bytes_max: u64, count: u64) -> Self {
        let bytes_max = message_bytes_max.saturating_mul(count);
        // No semaphore has more permits than `MAX_PERMITS`.
        let bytes_max = u32::try_from(bytes_max).unwrap_or(u32::MAX).min(u32::MAX >> 3);
        Self { free: Arc::new(Semaphore::new(bytes_max as usize)), bytes_max }
    }
}

impl Memory {
    /// Memory for messages of which the largest has `message_bytes_max` bytes.
    pub(super) fn new(message_bytes_max: u64) -> Self {
        let all = MemoryShare::new(message_bytes_max, LARGEST_MESSAGES_MAX);
        Self { message_bytes_max, shares: vec![all] }
    }

    /// Memory for one session, within this one: it takes a part of it at most.
    pub(super) fn part(&self) -> Self {
        let own = MemoryShare::new(self.message_bytes_max, LARGEST_MESSAGES_OF_ADDRESS_MAX);
        let shares = std::iter::once(own).chain(self.shares.iter().cloned()).collect();
        Self { message_bytes_max: self.message_bytes_max, shares }
    }

    /// Waits for the memory of a message.
    pub(super) async fn hold(&self, mut publish: Publish) -> Held {
        detach(&mut publish);
        let bytes = u32::try_from(bytes_of(&publish)).unwrap_or(u32::MAX);
        let mut memory = HeldMemory::with_capacity(self.shares.len());
        for MemoryShare { free, bytes_max } in &self.shares {
            // What is larger than all memory takes all of it.
            let taken = Arc::clone(free).acquire_many_owned(bytes.min(*bytes_max)).await;
            memory.push(taken.expect("the semaphore is never closed"));
        }
        Held { publish, memory }
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

#[cfg(test)]
mod tests {
    use futures::FutureExt as _;
    use rumqttc::v5::mqttbytes::QoS;

    use super::*;

    const BYTES: u64 = 100_000;

    fn message() -> Publish {
        Publish::new("t", QoS::AtLeastOnce, vec![0_u8; 60_000], None)
    }

    #[tokio::test]
    async fn a_session_takes_a_part_of_the_memory_and_all_together_no_more_than_all_of_it() {
        let memory = Memory::new(BYTES);
        let first = memory.part();
        let mut held = Vec::new();
        for _ in 0..3 {
            held.push(first.hold(message()).now_or_never().expect("there is memory for it"));
        }
        assert!(first.hold(message()).now_or_never().is_none(), "its part is used up");
        let mut others = Vec::new();
        for _ in 0..16 {
            let other = memory.part();
            let more = (0..3).map_while(|_| other.hold(message()).now_or_never());
            others.extend(more);
        }
        assert_eq!(held.len() + others.len(), 26, "sixteen messages of the largest size");
        drop(held);
        assert!(first.hold(message()).now_or_never().is_some(), "it has its part again");
    }
}
