use futures::SinkExt;
use rumqttc::v5::mqttbytes::{QoS, v5::Subscribe};
use tokio::io::DuplexStream;
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

/// A connection, and a broker that sends five times as many messages as it may.
async fn flooded(
    keep_alive_seconds: u16,
) -> (Arc<NetworkConnection>, Framed<DuplexStream, PacketCodec>) {
    let (ours, theirs) = tokio::io::duplex(1 << 20);
    let granted =
        ConnAckProperties { server_keep_alive: Some(keep_alive_seconds), ..no_properties() };
    let limits = LinkLimits { credit: RECEIVE_MAX, ..LinkLimits::default() };
    let ours: Box<dyn Stream> = Box::new(ours);
    let connection = NetworkConnection::start(Framed::new(ours, codec()), &granted, &limits);
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
