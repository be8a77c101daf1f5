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
/// what others leave.
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

/// What a connection holds of incomplete messages.
#[derive(Default)]
struct Connection {
    held: usize,
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
            let own = self.connections.get(&id).map_or(0, |own| own.held);
            let largest = self
                .connections
                .iter()
                .map(|(id, connection)| (*id, connection.held))
                .max_by_key(|(_, held)| *held);
            match largest {
                Some((largest, held)) if largest != id && held > own + bytes => {
                    lost.extend(self.displace(largest));
                }
                _ => return false,
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
        let budget = self.connection.budget.clone();
        let message = budget.state.lock().take(self.connection.id, self.request_id);
        let held = HeldBytes {
            bytes: message.held,
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
    budget: Arc<IncomingBudget>,
}

impl Drop for HeldBytes {
    fn drop(&mut self) {
        self.budget.state.lock().held -= self.bytes;
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
