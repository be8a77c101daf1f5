use futures::SinkExt;
use rumqttc::v5::mqttbytes::{QoS, v5::Subscribe};
use tokio::io::{AsyncWriteExt as _, DuplexStream};
use tokio_util::codec::Framed;

use super::{
    super::{config::no_properties, framing::PacketCodec},
    *,
};
use crate::transport::dial::Stream;

const RECEIVE_MAX: u32 = 4;

fn codec() -> PacketCodec {
    PacketCodec::new(u32::MAX)
}

fn start(
    ours: Box<dyn Stream>,
    granted: &ConnAckProperties,
    limits: &LinkLimits,
) -> Arc<NetworkConnection> {
    let memory = Memory::new(limits.message_bytes_max);
    NetworkConnection::start(Framed::new(ours, codec()), granted, limits, memory)
}

/// A connection, and a broker that sends five times as many messages as it may.
async fn flooded(
    keep_alive_seconds: u16,
) -> (Arc<NetworkConnection>, Framed<DuplexStream, PacketCodec>) {
    let (ours, theirs) = tokio::io::duplex(1 << 20);
    let granted =
        ConnAckProperties { server_keep_alive: Some(keep_alive_seconds), ..no_properties() };
    let limits = LinkLimits { credit: RECEIVE_MAX, ..LinkLimits::default() };
    let ours: Box<dyn Stream> = Box::new(ours);
    let connection = start(ours, &granted, &limits);
    let mut broker = Framed::new(theirs, codec());
    for id in 1..=5 * u16::try_from(RECEIVE_MAX).expect("small") {
        let mut publish = Publish::new("t", QoS::AtLeastOnce, id.to_string(), None);
        publish.pkid = id;
        broker.feed(Packet::Publish(publish)).await.expect("there is room");
    }
    broker.flush().await.expect("there is room");
    (connection, broker)
}

#[tokio::test]
async fn messages_beyond_the_receive_maximum_wait_and_none_is_lost() {
    let (connection, _broker) = flooded(30).await;
    tokio::time::sleep(Duration::from_millis(50)).await;
    assert_eq!(
        connection.state.lock().unclaimed.len(),
        connection.receive_max,
        "no more is stored than the receive maximum"
    );
    let (subscriber, mut arrived) = mpsc::channel(connection.receive_max);
    let subscribe =
        |pkid| Packet::Subscribe(Subscribe { pkid, filters: Vec::new(), properties: None });
    let answer = connection.subscribe(&["t".to_owned()], &subscriber, subscribe).await;
    assert!(answer.is_ok(), "the subscription is sent");
    for id in 1..=20 {
        assert_eq!(arrived.recv().await.map(|held| held.publish.pkid), Some(id));
    }
}

#[tokio::test]
async fn a_broker_without_keep_alive_is_pinged() {
    let (connection, mut broker) = flooded(0).await;
    let ping = timeout(LinkLimits::default().idle_timeout, broker.next()).await;
    assert!(matches!(ping, Ok(Some(Ok(Incoming::Packet(Packet::PingReq(_)))))), "{ping:?}");
    assert!(connection.loss.borrow().is_none(), "the connection stays");
}

#[tokio::test]
async fn a_flood_that_is_not_read_ends_the_connection() {
    let (connection, _broker) = flooded(1).await;
    assert!(connection.lost().await.reason.contains("more than it may"));
}

#[tokio::test]
async fn a_broker_answers_what_it_was_asked_and_not_what_was_asked_before() {
    const ANSWER: [u8; 2] = [0xD0, 0x00];
    let (ours, theirs) = tokio::io::duplex(1 << 20);
    let ours: Box<dyn Stream> = Box::new(ours);
    let limits = LinkLimits::default();
    let connection = start(ours, &no_properties(), &limits);
    let mut broker = Framed::new(theirs, codec());
    let first = broker.next().await;
    assert!(matches!(first, Some(Ok(Incoming::Packet(Packet::PingReq(_))))), "{first:?}");
    let asked = Arc::clone(&connection);
    let mut asking = tokio::spawn(async move { asked.answers().await });
    let second = broker.next().await;
    assert!(matches!(second, Some(Ok(Incoming::Packet(Packet::PingReq(_))))), "{second:?}");
    broker.get_mut().write_all(&ANSWER).await.expect("there is room");
    let answered = timeout(Duration::from_millis(100), &mut asking).await;
    assert!(answered.is_err(), "that was the answer to the first one");
    broker.get_mut().write_all(&ANSWER).await.expect("there is room");
    assert!(asking.await.expect("no panic"));
    drop(broker);
    assert!(!connection.answers().await, "the connection is lost");
}
