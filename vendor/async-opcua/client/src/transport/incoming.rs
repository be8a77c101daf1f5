//! Room for incoming messages. Several connections may share it, so that what many servers send, and
//! never end, has a bound over all of them.

use std::{
    collections::HashMap,
    fmt, mem,
    sync::Arc,
};

use opcua_core::{
    comms::{message_chunk::MessageChunk, message_chunk_info::ChunkInfo},
    sync::Mutex,
    ResponseMessage,
};
use opcua_types::{Error, StatusCode};

/// Room in bytes for incoming messages that are not complete or not delivered yet, of all connections
/// that are given the same one.
///
/// Where it is used up, the connection that holds most loses its incomplete messages, and ends with its next chunk.
/// So each connection can rely on the room divided by the number of connections, and may use
/// what others leave. Messages that are complete cannot be taken back: where they fill the room, all together hold up
/// to twice as much.
pub struct IncomingBudget {
    max_bytes: usize,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    held: usize,
    last_id: u64,
    connections: HashMap<u64, Connection>,
}

/// What a connection holds.
#[derive(Default)]
struct Connection {
    /// Bytes of incomplete messages.
    held: usize,
    /// Bytes of complete messages that are not delivered yet.
    undelivered: usize,
    messages: HashMap<u32, IncompleteMessage>,
    is_displaced: bool,
}

#[derive(Default)]
struct IncompleteMessage {
    held: usize,
    chunks: Vec<ReceivedChunk>,
}

/// A chunk with what its headers say.
#[derive(Debug)]
pub(super) struct ReceivedChunk {
    pub(super) info: ChunkInfo,
    pub(super) data: bytes::Bytes,
}

impl ReceivedChunk {
    pub(super) fn new(info: ChunkInfo, chunk: MessageChunk) -> Self {
        Self {
            info,
            data: chunk.data,
        }
    }

    /// Memory that the chunk takes. The header of one that opens a channel repeats certificates.
    fn size(&self) -> usize {
        let header = match self.info.message_header.message_type.is_open_secure_channel() {
            true => self.data.len(),
            false => 0,
        };
        self.data.len() + header + mem::size_of::<Self>()
    }
}

impl IncomingBudget {
    /// Room for so many bytes.
    pub fn new(max_bytes: usize) -> Self {
        Self {
            max_bytes,
            state: Mutex::new(State::default()),
        }
    }

    /// Bytes that all connections together hold.
    pub fn held_bytes(&self) -> usize {
        self.state.lock().held
    }

    /// A connection that takes its room from here.
    pub(super) fn connect(self: &Arc<Self>) -> Arc<ConnectionRoom> {
        let mut state = self.state.lock();
        state.last_id += 1;
        let id = state.last_id;
        state.connections.insert(id, Connection::default());
        Arc::new(ConnectionRoom {
            budget: self.clone(),
            id,
        })
    }
}

impl fmt::Debug for IncomingBudget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("IncomingBudget")
            .field("max_bytes", &self.max_bytes)
            .field("held_bytes", &self.held_bytes())
            .finish_non_exhaustive()
    }
}

/// Two are the same where they are shared.
impl PartialEq for IncomingBudget {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl State {
    /// Make room for so many bytes of a connection. What others lose is to be dropped without the lock.
    fn make_room(
        &mut self,
        id: u64,
        bytes: usize,
        max_bytes: usize,
        lost: &mut Vec<HashMap<u32, IncompleteMessage>>,
    ) -> bool {
        // One that was displaced displaces no others.
        if self.connections.get(&id).map_or(true, |own| own.is_displaced) {
            return false;
        }
        while self.held + bytes > max_bytes {
            let own = self.connections.get(&id);
            let own = own.map_or(0, |own| own.held + own.undelivered);
            let largest = self
                .connections
                .iter()
                .map(|(id, connection)| (*id, connection.held))
                .max_by_key(|(_, held)| *held);
            match largest {
                Some((largest, held)) if largest != id && held > own + bytes => {
                    lost.extend(self.displace(largest));
                }
                // What fills the room is complete. That is no reason to refuse a connection its part.
                _ => return own + bytes <= max_bytes / self.connections.len(),
            }
        }
        true
    }

    fn displace(&mut self, id: u64) -> Option<HashMap<u32, IncompleteMessage>> {
        let connection = self.connections.get_mut(&id)?;
        connection.is_displaced = true;
        self.held -= mem::take(&mut connection.held);
        Some(mem::take(&mut connection.messages))
    }

    /// Take an incomplete message out. Its bytes still count.
    fn take(&mut self, id: u64, request_id: u32) -> IncompleteMessage {
        let Some(connection) = self.connections.get_mut(&id) else {
            return IncompleteMessage::default();
        };
        let message = connection.messages.remove(&request_id).unwrap_or_default();
        connection.held -= message.held;
        message
    }
}

/// What a connection holds of the room. Gives it back when dropped.
#[derive(Debug)]
pub(super) struct ConnectionRoom {
    budget: Arc<IncomingBudget>,
    id: u64,
}

impl ConnectionRoom {
    /// A message that is expected, under the identity of its request.
    pub(super) fn expect(self: &Arc<Self>, request_id: u32) -> MessageRoom {
        MessageRoom {
            connection: self.clone(),
            request_id,
        }
    }
}

impl Drop for ConnectionRoom {
    fn drop(&mut self) {
        let mut state = self.budget.state.lock();
        let lost = state.displace(self.id);
        state.connections.remove(&self.id);
        drop(state);
        drop(lost);
    }
}

/// What one incomplete message holds of the room. Gives it back when dropped.
#[derive(Debug)]
pub(super) struct MessageRoom {
    connection: Arc<ConnectionRoom>,
    request_id: u32,
}

impl MessageRoom {
    /// Keep a chunk. An error ends the connection: there is no room, or others needed what it held.
    pub(super) fn push(&self, chunk: ReceivedChunk) -> Result<(), Error> {
        let (budget, id) = (&self.connection.budget, self.connection.id);
        let size = chunk.size();
        let mut lost = Vec::new();
        let mut state = budget.state.lock();
        let has_room = state.make_room(id, size, budget.max_bytes, &mut lost);
        let state_of_all = &mut *state;
        let kept = match state_of_all.connections.get_mut(&id) {
            Some(connection) if has_room => {
                let message = connection.messages.entry(self.request_id).or_default();
                message.held += size;
                message.chunks.push(chunk);
                connection.held += size;
                state_of_all.held += size;
                Ok(())
            }
            _ => Err(no_room()),
        };
        drop(state);
        drop(lost);
        kept
    }

    /// The chunks of a message that is complete, and the room that they take. An error ends the connection: others
    /// needed what it held.
    pub(super) fn complete(self) -> Result<(Vec<ReceivedChunk>, HeldBytes), Error> {
        let (budget, id) = (self.connection.budget.clone(), self.connection.id);
        let mut state = budget.state.lock();
        let message = state.take(id, self.request_id);
        if let Some(connection) = state.connections.get_mut(&id) {
            connection.undelivered += message.held;
        }
        drop(state);
        let held = HeldBytes {
            bytes: message.held,
            connection: id,
            budget,
        };
        if message.chunks.is_empty() {
            return Err(no_room());
        }
        Ok((message.chunks, held))
    }
}

impl Drop for MessageRoom {
    fn drop(&mut self) {
        let mut state = self.connection.budget.state.lock();
        let message = state.take(self.connection.id, self.request_id);
        state.held -= message.held;
        drop(state);
        drop(message);
    }
}

fn no_room() -> Error {
    Error::new(
        StatusCode::BadResponseTooLarge,
        "There is no room for incoming messages",
    )
}

/// Room of a complete message. Gives it back when dropped.
#[derive(Debug)]
pub(super) struct HeldBytes {
    bytes: usize,
    connection: u64,
    budget: Arc<IncomingBudget>,
}

impl Drop for HeldBytes {
    fn drop(&mut self) {
        let mut state = self.budget.state.lock();
        state.held -= self.bytes;
        // It may have ended before.
        if let Some(connection) = state.connections.get_mut(&self.connection) {
            connection.undelivered -= self.bytes;
        }
    }
}

/// A response on its way to who waits for it. It counts as incoming until then.
#[derive(Debug)]
pub struct ReceivedResponse {
    message: ResponseMessage,
    _held: HeldBytes,
}

impl ReceivedResponse {
    pub(super) fn new(message: ResponseMessage, held: HeldBytes) -> Self {
        Self {
            message,
            _held: held,
        }
    }

    /// Take the response.
    pub fn into_message(self) -> ResponseMessage {
        self.message
    }
}

#[cfg(test)]
mod tests {
    use opcua_core::comms::{
        message_chunk::{MessageChunkHeader, MessageChunkType, MessageIsFinalType},
        security_header::{SecurityHeader, SequenceHeader, SymmetricSecurityHeader},
    };

    use super::*;

    fn chunk() -> ReceivedChunk {
        let info = ChunkInfo {
            message_header: MessageChunkHeader {
                message_type: MessageChunkType::Message,
                is_final: MessageIsFinalType::Intermediate,
                message_size: 1000,
                secure_channel_id: 1,
            },
            security_header: SecurityHeader::Symmetric(SymmetricSecurityHeader { token_id: 1 }),
            sequence_header: SequenceHeader {
                sequence_number: 1,
                request_id: 1,
            },
            security_header_offset: 12,
            sequence_header_offset: 16,
            body_offset: 24,
            body_length: 976,
        };
        let data = vec![0; 1000].into();
        ReceivedChunk::new(info, MessageChunk { data })
    }

    #[test]
    fn what_is_not_delivered_leaves_each_connection_its_part() {
        let budget = Arc::new(IncomingBudget::new(4 * chunk().size()));
        let (slow, honest) = (budget.connect(), budget.connect());
        let message = slow.expect(1);
        for _ in 0..4 {
            message.push(chunk()).unwrap();
        }
        let (_, undelivered) = message.complete().unwrap();
        let part = honest.expect(1);
        for _ in 0..2 {
            part.push(chunk()).unwrap();
        }
        assert!(part.push(chunk()).is_err(), "the room is full, and its part is half of it");
        let (_, own) = part.complete().unwrap();
        for one in [&slow, &honest] {
            assert!(one.expect(2).push(chunk()).is_err(), "what is not delivered counts");
        }
        drop((undelivered, own));
        assert_eq!(budget.held_bytes(), 0);
        for request_id in 3..7 {
            // Dropped at once: nothing of it stays.
            honest.expect(request_id).push(chunk()).unwrap();
        }
        assert_eq!(budget.held_bytes(), 0);
    }
}
