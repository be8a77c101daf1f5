//! One network connection: a reader, a writer, and the answers awaited in between. Reading never
//! waits for writing, so that two full sockets cannot block each other. It waits for subscribers
//! that take messages, and for the memory that messages need, within a time limit.

mod pings;
mod writer;

use std::{
    collections::{HashMap, VecDeque},
    sync::Arc,
    time::Duration,
};

use futures::{
    FutureExt, StreamExt,
    stream::{SplitSink, SplitStream},
};
use parking_lot::Mutex;
use pings::Pings;
use rumqttc::v5::mqttbytes::v5::{
    ConnAckProperties, DisconnectReasonCode, Packet, PubAck, PubAckReason, Publish,
    SubscribeReasonCode, Unsubscribe,
};
use tokio::{
    sync::{Notify, OwnedSemaphorePermit, Semaphore, mpsc, oneshot, watch},
    time::{Instant, timeout},
};
use tokio_util::sync::CancellationToken;

use super::{
    super::connection::{ConnectionFault, EndpointFault},
    framing::{Incoming, PROPERTY_BYTES_MAX, PacketStream},
    held::{Held, Memory},
};
use crate::config::LinkLimits;

/// Packets that may wait to be written.
const PACKETS_BUFFERED: usize = 256;
/// Receive Maximum of a broker that sends none (MQTT 5 §3.2.2.3.3).
const RECEIVE_MAX_DEFAULT: u16 = u16::MAX;

/// Handle of a network connection for publishers and subscribers.
pub(super) struct NetworkConnection {
    packets: mpsc::Sender<Packet>,
    state: Arc<Mutex<ConnectionState>>,
    has_subscriber: Arc<Notify>,
    /// Send quota: messages that the broker accepts unacknowledged (MQTT 5 §4.9).
    send_quota: Arc<Semaphore>,
    loss: watch::Receiver<Option<ConnectionFault>>,
    /// True while the reader waits for subscribers that take messages.
    congestion: watch::Receiver<bool>,
    pings: Arc<Pings>,
    stop: CancellationToken,
    /// Largest packet that the broker accepts, in bytes.
    pub packet_bytes_max: Option<u32>,
    /// Most unacknowledged messages that the broker may send.
    pub receive_max: usize,
}

#[derive(Default)]
struct ConnectionState {
    is_lost: bool,
    last_id: u16,
    /// Publishes without an acknowledgement, by packet identifier.
    published: HashMap<u16, (oneshot::Sender<PubAck>, OwnedSemaphorePermit)>,
    /// Subscriptions without an acknowledgement, by packet identifier.
    subscribed: HashMap<u16, oneshot::Sender<Vec<SubscribeReasonCode>>>,
    /// The subscribers by topic.
    subscribers: HashMap<String, mpsc::Sender<Held>>,
    /// Messages of a persistent session that arrived before their subscriber.
    unclaimed: VecDeque<Held>,
}

impl ConnectionState {
    /// Returns a packet identifier that is not in use.
    fn next_id(&mut self) -> u16 {
        loop {
            self.last_id = self.last_id.checked_add(1).unwrap_or(1);
            if !self.published.contains_key(&self.last_id)
                && !self.subscribed.contains_key(&self.last_id)
            {
                return self.last_id;
            }
        }
    }

    fn subscriber_of(&self, publish: &Publish) -> Option<&mpsc::Sender<Held>> {
        std::str::from_utf8(&publish.topic).ok().and_then(|topic| self.subscribers.get(topic))
    }
}

impl NetworkConnection {
    pub(super) fn start(
        packets: PacketStream,
        granted: &ConnAckProperties,
        limits: &LinkLimits,
        memory: Memory,
    ) -> Arc<Self> {
        let (sink, stream) = packets.split();
        let (packets, waiting) = mpsc::channel(PACKETS_BUFFERED);
        let (lost, loss) = watch::channel(None);
        let (congested, congestion) = watch::channel(false);
        let state = Arc::new(Mutex::new(ConnectionState::default()));
        let stop = CancellationToken::new();
        let send_quota = granted.receive_max.unwrap_or(RECEIVE_MAX_DEFAULT);
        // Zero turns off the broker's keep-alive (MQTT 5 §3.2.2.3.14), not that of this side.
        let server_keep_alive = granted.server_keep_alive.filter(|seconds| *seconds > 0);
        let keep_alive = server_keep_alive
            .map_or(limits.idle_timeout, |seconds| Duration::from_secs(u64::from(seconds)));
        let receive_max = limits.credit.clamp(1, u32::from(u16::MAX)) as usize;
        let (has_subscriber, pings) = (Arc::new(Notify::new()), Arc::<Pings>::default());
        let reader = PacketReader {
            state: Arc::clone(&state),
            has_subscriber: Arc::clone(&has_subscriber),
            memory,
            congested,
            packets: packets.downgrade(),
            receive_max,
            keep_alive,
            pings: Arc::clone(&pings),
        };
        tokio::spawn(run(sink, stream, waiting, reader, lost, stop.clone()));
        Arc::new(Self {
            packets,
            state,
            has_subscriber,
            send_quota: Arc::new(Semaphore::new(usize::from(send_quota.max(1)))),
            loss,
            congestion,
            pings,
            stop,
            packet_bytes_max: granted.max_packet_size,
            receive_max,
        })
    }

    /// Publishes as soon as the send quota allows. Returns the future acknowledgement.
    pub(super) async fn publish(
        &self,
        mut publish: Publish,
    ) -> Result<oneshot::Receiver<PubAck>, EndpointFault> {
        let permit = Arc::clone(&self.send_quota).acquire_owned().await.map_err(|_| broken())?;
        let (reply, answer) = oneshot::channel();
        {
            let mut state = self.state.lock();
            if state.is_lost {
                return Err(broken());
            }
            publish.pkid = state.next_id();
            // The permit returns with the acknowledgement, as the broker counts.
            state.published.insert(publish.pkid, (reply, permit));
        }
        self.packets.send(Packet::Publish(publish)).await.map_err(|_| broken())?;
        Ok(answer)
    }

    /// Subscribes to topics. The subscriber gets their messages, beginning with those that arrived
    /// before it.
    pub(super) async fn subscribe(
        &self,
        topics: &[String],
        subscriber: &mpsc::Sender<Held>,
        packet: impl FnOnce(u16) -> Packet,
    ) -> Result<oneshot::Receiver<Vec<SubscribeReasonCode>>, EndpointFault> {
        let (reply, answer) = oneshot::channel();
        let id = {
            let mut state = self.state.lock();
            if state.is_lost {
                return Err(broken());
            }
            // Before the packet: the broker may at once send what its session holds.
            for topic in topics {
                state.subscribers.insert(topic.clone(), subscriber.clone());
            }
            for held in std::mem::take(&mut state.unclaimed) {
                match state.subscriber_of(&held.publish) {
                    // The subscriber is new and has capacity for all unclaimed messages.
                    Some(subscriber) => drop(subscriber.try_send(held)),
                    None => state.unclaimed.push_back(held),
                }
            }
            let id = state.next_id();
            state.subscribed.insert(id, reply);
            id
        };
        self.has_subscriber.notify_waiters();
        self.packets.send(packet(id)).await.map_err(|_| broken())?;
        Ok(answer)
    }

    /// Removes the subscriber of topics. The broker delivers messages that it did not acknowledge
    /// again on the next connection.
    pub(super) fn forget(&self, topics: &[String]) {
        let mut state = self.state.lock();
        for topic in topics {
            state.subscribers.remove(topic);
        }
    }

    pub(super) async fn unsubscribe(&self, filters: Vec<String>) {
        let pkid = self.state.lock().next_id();
        let packet = Packet::Unsubscribe(Unsubscribe { pkid, filters, properties: None });
        // Without a connection there is no one to unsubscribe from.
        let _ = self.packets.send(packet).await;
    }

    pub(super) async fn acknowledge(&self, acknowledgement: PubAck) -> Result<(), EndpointFault> {
        self.packets.send(Packet::PubAck(acknowledgement)).await.map_err(|_| broken())
    }

    pub(super) async fn lost(&self) -> ConnectionFault {
        let mut loss = self.loss.clone();
        let lost = loss.wait_for(Option::is_some).await;
        lost.ok()
            .and_then(|fault| fault.clone())
            .unwrap_or_else(|| ConnectionFault::transient("the connection ended"))
    }

    /// Waits until the broker has answered a ping that is written from now on. False where the connection is lost before.
    pub(super) async fn answers(&self) -> bool {
        tokio::select! {
            () = self.pings.ask(&self.packets) => true,
            _ = self.lost() => false,
        }
    }

    /// Waits until the reader waits for subscribers: no answer of the broker arrives before they
    /// have taken messages.
    pub(super) async fn congested(&self) {
        // A reader that has ended is reported by `lost`.
        if self.congestion.clone().wait_for(|congested| *congested).await.is_err() {
            std::future::pending::<()>().await;
        }
    }

    pub(super) fn close(&self) {
        self.stop.cancel();
    }
}

pub(super) fn broken() -> EndpointFault {
    EndpointFault::Broken("the connection is lost".to_owned())
}

async fn run(
    sink: SplitSink<PacketStream, Packet>,
    stream: SplitStream<PacketStream>,
    waiting: mpsc::Receiver<Packet>,
    reader: PacketReader,
    lost: watch::Sender<Option<ConnectionFault>>,
    stop: CancellationToken,
) {
    let fault = tokio::select! {
        fault = reader.read(stream) => fault,
        fault = writer::write(sink, waiting, stop, reader.keep_alive, Arc::clone(&reader.pings)) => fault,
    };
    {
        // All awaited answers resolve now, as errors.
        let mut state = reader.state.lock();
        *state = ConnectionState { is_lost: true, ..ConnectionState::default() };
    }
    lost.send_replace(Some(fault));
}

/// The reading half of a connection.
struct PacketReader {
    state: Arc<Mutex<ConnectionState>>,
    has_subscriber: Arc<Notify>,
    memory: Memory,
    congested: watch::Sender<bool>,
    packets: mpsc::WeakSender<Packet>,
    receive_max: usize,
    keep_alive: Duration,
    pings: Arc<Pings>,
}

impl PacketReader {
    async fn read(&self, mut stream: SplitStream<PacketStream>) -> ConnectionFault {
        loop {
            // The writer's pings make the broker answer in time, unless it is gone.
            let packet = match tokio::time::timeout_at(
                Instant::now() + self.keep_alive,
                stream.next(),
            )
            .await
            {
                Ok(Some(Ok(packet))) => packet,
                Ok(Some(Err(e))) => {
                    return ConnectionFault::transient(format!("the connection was lost: {e:?}"));
                }
                Ok(None) => return ConnectionFault::transient("the broker closed the connection"),
                Err(_) => return ConnectionFault::transient("the broker has fallen silent"),
            };
            let packet = match packet {
                Incoming::Packet(packet) => packet,
                Incoming::Overlong { id } => {
                    if !self.reject_overlong(id) {
                        return ConnectionFault::transient(
                            "the broker sends what has to be rejected, and reads no answer",
                        );
                    }
                    continue;
                }
            };
            match packet {
                Packet::PubAck(acknowledgement) => {
                    let awaited = self.state.lock().published.remove(&acknowledgement.pkid);
                    if let Some((reply, _permit)) = awaited {
                        let _ = reply.send(acknowledgement);
                    }
                }
                Packet::SubAck(answer) => {
                    let awaited = self.state.lock().subscribed.remove(&answer.pkid);
                    if let Some(reply) = awaited {
                        let _ = reply.send(answer.return_codes);
                    }
                }
                Packet::Publish(publish) => {
                    let is_delivered = self.deliver_in_time(publish).await;
                    if !is_delivered {
                        return ConnectionFault::transient(
                            "the broker sends more than it may, and nobody takes it in time",
                        );
                    }
                }
                Packet::PingResp(_) => self.pings.answered(),
                Packet::Disconnect(packet) => return disconnected(packet.reason_code),
                _ => {}
            }
        }
    }

    /// Rejects a message that is not decoded. Returns false if the writer has no capacity for that:
    /// waiting for it could block both sides.
    fn reject_overlong(&self, id: Option<u16>) -> bool {
        tracing::warn!(
            bytes_max = PROPERTY_BYTES_MAX,
            "A received message has too many properties and is rejected."
        );
        let (Some(id), Some(packets)) = (id, self.packets.upgrade()) else { return true };
        let mut rejection = PubAck::new(id, None);
        rejection.reason = PubAckReason::PayloadFormatInvalid;
        packets.try_send(Packet::PubAck(rejection)).is_ok()
    }

    /// Delivers a message. Returns whether subscribers took enough for that within the keep-alive
    /// time.
    async fn deliver_in_time(&self, publish: Publish) -> bool {
        let mut delivering = std::pin::pin!(self.deliver(publish));
        if delivering.as_mut().now_or_never().is_some() {
            return true;
        }
        self.congested.send_replace(true);
        let delivered = timeout(self.keep_alive, delivering).await;
        self.congested.send_replace(false);
        delivered.is_ok()
    }

    /// Hands a message to its subscriber, or stores it until there is one. Of messages that are
    /// small, a broker that respects the Receive Maximum never makes this wait. Mosquitto 2.0.11
    /// exceeds it for a resumed session; the surplus then stays in the sockets.
    async fn deliver(&self, publish: Publish) {
        let held = self.memory.hold(publish).await;
        let subscriber = loop {
            // Before the look into the state, so that a subscriber that comes in between is not
            // missed.
            let subscribed = self.has_subscriber.notified();
            {
                let mut state = self.state.lock();
                if let Some(subscriber) = state.subscriber_of(&held.publish) {
                    break subscriber.clone();
                }
                if state.unclaimed.len() < self.receive_max {
                    return state.unclaimed.push_back(held);
                }
            }
            subscribed.await;
        };
        // A closed subscriber has not acknowledged the message, so the broker delivers it again.
        let _ = subscriber.send(held).await;
    }
}

fn disconnected(reason: DisconnectReasonCode) -> ConnectionFault {
    match reason {
        DisconnectReasonCode::SessionTakenOver => {
            ConnectionFault::permanent("another connection uses the same user; only one may")
        }
        DisconnectReasonCode::NotAuthorized | DisconnectReasonCode::AdministrativeAction => {
            ConnectionFault::permanent(format!("the broker closed the connection: {reason:?}"))
        }
        reason => {
            ConnectionFault::transient(format!("the broker closed the connection: {reason:?}"))
        }
    }
}

#[cfg(test)]
mod tests;
