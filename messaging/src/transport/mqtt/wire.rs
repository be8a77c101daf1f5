//! One MQTT connection: what reads, what writes, and what is awaited in between. Reading never
//! waits for writing, so that two full sockets cannot lock each other up; it waits for who takes
//! messages, but not for ever.

use std::{
    collections::{HashMap, VecDeque},
    sync::Arc,
    time::Duration,
};

use futures::{
    SinkExt, StreamExt,
    stream::{SplitSink, SplitStream},
};
use parking_lot::Mutex;
use rumqttc::v5::mqttbytes::v5::{
    ConnAckProperties, Disconnect, DisconnectReasonCode, Packet, PingReq, PubAck, Publish,
    SubscribeReasonCode, Unsubscribe,
};
use tokio::{
    sync::{Notify, OwnedSemaphorePermit, Semaphore, mpsc, oneshot, watch},
    time::{Instant, timeout},
};
use tokio_util::{codec::Framed, sync::CancellationToken};

use super::{
    super::{
        connection::{ConnectionFault, LaneFault},
        dial::Stream,
    },
    config::CLOSE_TIMEOUT,
    framing::PacketCodec,
};
use crate::config::LinkLimits;

/// Packets that may wait to be written.
const PACKETS_BUFFERED: usize = 256;
/// The limit where a broker names none (MQTT 5 §3.2.2.3.3).
const RECEIVE_MAX_DEFAULT: u16 = u16::MAX;

type Framing = Framed<Box<dyn Stream>, PacketCodec>;

/// The lanes' view of a connection.
pub(super) struct Wire {
    packets: mpsc::Sender<Packet>,
    state: Arc<Mutex<State>>,
    lane_opened: Arc<Notify>,
    room: Arc<Semaphore>,
    loss: watch::Receiver<Option<ConnectionFault>>,
    stop: CancellationToken,
    /// Largest packet the broker takes, in bytes.
    pub packet_bytes_max: Option<u32>,
    /// Messages the broker may have under way to us.
    pub receive_max: usize,
}

#[derive(Default)]
struct State {
    is_lost: bool,
    last_id: u16,
    published: HashMap<u16, (oneshot::Sender<PubAck>, OwnedSemaphorePermit)>,
    subscribed: HashMap<u16, oneshot::Sender<Vec<SubscribeReasonCode>>>,
    lanes: HashMap<String, mpsc::Sender<Publish>>,
    /// What a persistent session delivers before its lane is open.
    unclaimed: VecDeque<Publish>,
}

impl State {
    /// A packet identifier that nothing awaits.
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

    fn lane_of(&self, publish: &Publish) -> Option<&mpsc::Sender<Publish>> {
        std::str::from_utf8(&publish.topic).ok().and_then(|topic| self.lanes.get(topic))
    }
}

impl Wire {
    pub(super) fn start(
        framing: Framing,
        granted: &ConnAckProperties,
        limits: &LinkLimits,
    ) -> Arc<Self> {
        let (sink, stream) = framing.split();
        let (packets, waiting) = mpsc::channel(PACKETS_BUFFERED);
        let (lost, loss) = watch::channel(None);
        let state = Arc::new(Mutex::new(State::default()));
        let stop = CancellationToken::new();
        let room = granted.receive_max.unwrap_or(RECEIVE_MAX_DEFAULT);
        // Zero: the broker does not watch (MQTT 5 §3.2.2.3.14). We do.
        let watched = granted.server_keep_alive.filter(|seconds| *seconds > 0);
        let keep_alive =
            watched.map_or(limits.idle_timeout, |seconds| Duration::from_secs(u64::from(seconds)));
        let receive_max = limits.credit.clamp(1, u32::from(u16::MAX)) as usize;
        let lane_opened = Arc::new(Notify::new());
        let reader = Reader {
            state: Arc::clone(&state),
            lane_opened: Arc::clone(&lane_opened),
            receive_max,
            keep_alive,
        };
        tokio::spawn(run(sink, stream, waiting, reader, lost, stop.clone()));
        Arc::new(Self {
            packets,
            state,
            lane_opened,
            room: Arc::new(Semaphore::new(usize::from(room.max(1)))),
            loss,
            stop,
            packet_bytes_max: granted.max_packet_size,
            receive_max,
        })
    }

    /// Publishes as soon as the broker has room, and gives what will be its acknowledgement.
    pub(super) async fn publish(
        &self,
        mut publish: Publish,
    ) -> Result<oneshot::Receiver<PubAck>, LaneFault> {
        let permit = Arc::clone(&self.room).acquire_owned().await.map_err(|_| broken())?;
        let (tell, told) = oneshot::channel();
        {
            let mut state = self.state.lock();
            if state.is_lost {
                return Err(broken());
            }
            publish.pkid = state.next_id();
            state.published.insert(publish.pkid, (tell, permit));
        }
        self.packets.send(Packet::Publish(publish)).await.map_err(|_| broken())?;
        Ok(told)
    }

    /// Subscribes; the lane then gets what arrives for its topics, beginning with what arrived
    /// before.
    pub(super) async fn subscribe(
        &self,
        topics: &[String],
        lane: &mpsc::Sender<Publish>,
        packet: impl FnOnce(u16) -> Packet,
    ) -> Result<oneshot::Receiver<Vec<SubscribeReasonCode>>, LaneFault> {
        let (tell, told) = oneshot::channel();
        let id = {
            let mut state = self.state.lock();
            if state.is_lost {
                return Err(broken());
            }
            for topic in topics {
                state.lanes.insert(topic.clone(), lane.clone());
            }
            for publish in std::mem::take(&mut state.unclaimed) {
                match state.lane_of(&publish) {
                    // The lane is new and has room for as many as were held.
                    Some(lane) => drop(lane.try_send(publish)),
                    None => state.unclaimed.push_back(publish),
                }
            }
            let id = state.next_id();
            state.subscribed.insert(id, tell);
            id
        };
        self.lane_opened.notify_waiters();
        self.packets.send(packet(id)).await.map_err(|_| broken())?;
        Ok(told)
    }

    /// Ends a lane. What it has not acknowledged comes again with the next connection.
    pub(super) fn forget(&self, topics: &[String]) {
        let mut state = self.state.lock();
        for topic in topics {
            state.lanes.remove(topic);
        }
    }

    pub(super) async fn unsubscribe(&self, filters: Vec<String>) {
        let pkid = self.state.lock().next_id();
        let packet = Packet::Unsubscribe(Unsubscribe { pkid, filters, properties: None });
        // Without a connection there is nothing to tell.
        let _ = self.packets.send(packet).await;
    }

    pub(super) async fn acknowledge(&self, acknowledgement: PubAck) -> Result<(), LaneFault> {
        self.packets.send(Packet::PubAck(acknowledgement)).await.map_err(|_| broken())
    }

    pub(super) async fn lost(&self) -> ConnectionFault {
        let mut loss = self.loss.clone();
        let lost = loss.wait_for(Option::is_some).await;
        lost.ok()
            .and_then(|fault| fault.clone())
            .unwrap_or_else(|| ConnectionFault::passing("the connection ended"))
    }

    pub(super) fn close(&self) {
        self.stop.cancel();
    }
}

pub(super) fn broken() -> LaneFault {
    LaneFault::Broken("the connection is lost".to_owned())
}

async fn run(
    sink: SplitSink<Framing, Packet>,
    stream: SplitStream<Framing>,
    waiting: mpsc::Receiver<Packet>,
    reader: Reader,
    lost: watch::Sender<Option<ConnectionFault>>,
    stop: CancellationToken,
) {
    let fault = tokio::select! {
        fault = reader.read(stream) => fault,
        fault = write(sink, waiting, stop, reader.keep_alive) => fault,
    };
    {
        // Everything that was awaited resolves now.
        let mut state = reader.state.lock();
        *state = State { is_lost: true, ..State::default() };
    }
    lost.send_replace(Some(fault));
}

async fn write(
    mut sink: SplitSink<Framing, Packet>,
    mut waiting: mpsc::Receiver<Packet>,
    stop: CancellationToken,
    keep_alive: Duration,
) -> ConnectionFault {
    let mut ping = tokio::time::interval(keep_alive / 3);
    loop {
        let packet = tokio::select! {
            () = stop.cancelled() => {
                let goodbye = Packet::Disconnect(Disconnect::new(DisconnectReasonCode::NormalDisconnection));
                let _ = timeout(CLOSE_TIMEOUT, sink.send(goodbye)).await;
                return ConnectionFault::passing("closed by this side");
            }
            packet = waiting.recv() => match packet {
                Some(packet) => packet,
                None => return ConnectionFault::passing("closed by this side"),
            },
            _ = ping.tick() => Packet::PingReq(PingReq),
        };
        if let Err(e) = sink.feed(packet).await {
            return ConnectionFault::passing(format!("the connection was lost: {e:?}"));
        }
        // One system call for what waits by now.
        while let Ok(packet) = waiting.try_recv() {
            if let Err(e) = sink.feed(packet).await {
                return ConnectionFault::passing(format!("the connection was lost: {e:?}"));
            }
        }
        if let Err(e) = sink.flush().await {
            return ConnectionFault::passing(format!("the connection was lost: {e:?}"));
        }
    }
}

/// The reading half.
struct Reader {
    state: Arc<Mutex<State>>,
    lane_opened: Arc<Notify>,
    receive_max: usize,
    keep_alive: Duration,
}

impl Reader {
    async fn read(&self, mut stream: SplitStream<Framing>) -> ConnectionFault {
        loop {
            // Our pings make the broker answer in time, unless it is gone.
            let packet = match tokio::time::timeout_at(
                Instant::now() + self.keep_alive,
                stream.next(),
            )
            .await
            {
                Ok(Some(Ok(packet))) => packet,
                Ok(Some(Err(e))) => {
                    return ConnectionFault::passing(format!("the connection was lost: {e:?}"));
                }
                Ok(None) => return ConnectionFault::passing("the broker closed the connection"),
                Err(_) => return ConnectionFault::passing("the broker has fallen silent"),
            };
            match packet {
                Packet::PubAck(acknowledgement) => {
                    let awaited = self.state.lock().published.remove(&acknowledgement.pkid);
                    if let Some((tell, _room)) = awaited {
                        let _ = tell.send(acknowledgement);
                    }
                }
                Packet::SubAck(answer) => {
                    let awaited = self.state.lock().subscribed.remove(&answer.pkid);
                    if let Some(tell) = awaited {
                        let _ = tell.send(answer.return_codes);
                    }
                }
                Packet::Publish(publish) => {
                    let delivered = timeout(self.keep_alive, self.deliver(publish)).await;
                    if delivered.is_err() {
                        return ConnectionFault::passing(
                            "the broker sends more than it may, and nobody takes it in time",
                        );
                    }
                }
                Packet::Disconnect(goodbye) => return disconnected(goodbye.reason_code),
                _ => {}
            }
        }
    }

    /// Hands a message to its lane, or keeps it until the lane is open. A broker that keeps to the
    /// Receive Maximum never makes this wait; Mosquitto 2.0.11 does not for a resumed session, and
    /// the surplus then stays in the sockets.
    async fn deliver(&self, publish: Publish) {
        let lane = loop {
            let opened = self.lane_opened.notified();
            {
                let mut state = self.state.lock();
                if let Some(lane) = state.lane_of(&publish) {
                    break lane.clone();
                }
                if state.unclaimed.len() < self.receive_max {
                    return state.unclaimed.push_back(publish);
                }
            }
            opened.await;
        };
        // Closed: the lane has gone, nothing is lost.
        let _ = lane.send(publish).await;
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
        reason => ConnectionFault::passing(format!("the broker closed the connection: {reason:?}")),
    }
}

#[cfg(test)]
mod tests;
