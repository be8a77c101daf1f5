//! A bare MQTT 5 client. Its messages are those of the link, with the same properties. It uses the session of the link's user, whose subscription stores the
//! messages.

use std::time::{Duration, Instant};

use bytes::Bytes;
use rumqttc::v5::{
    AsyncClient, Event, EventLoop, MqttOptions,
    mqttbytes::{
        QoS,
        v5::{Packet, PublishProperties},
    },
};

use super::broker_under_test::{Account, BODY_BYTES, BrokerUnderTest, MESSAGES, WINDOW};

/// A week, in seconds.
const SESSION_EXPIRY: u32 = 7 * 24 * 3600;

pub(super) async fn send(broker: &BrokerUnderTest) -> anyhow::Result<Duration> {
    let began = Instant::now();
    let (client, mut events) = connect(broker, &broker.sender)?;
    let topic = broker.profile.produce(&broker.address).address;
    let publishing = tokio::spawn(async move {
        let body = Bytes::from(vec![b'x'; BODY_BYTES]);
        for number in 1..=MESSAGES {
            let properties = PublishProperties {
                content_type: Some("application/json".to_owned()),
                user_properties: vec![
                    ("subject".to_owned(), "bench".to_owned()),
                    ("message-id".to_owned(), format!("m{number}")),
                ],
                ..PublishProperties::default()
            };
            let (topic, body) = (topic.as_str(), body.clone());
            let quality = QoS::AtLeastOnce;
            client.publish_bytes_with_properties(topic, quality, false, body, properties).await?;
        }
        anyhow::Ok(client)
    });
    let mut acknowledged = 0;
    while acknowledged < MESSAGES {
        if let Event::Incoming(Packet::PubAck(_)) = events.poll().await? {
            acknowledged += 1;
        }
    }
    let took = began.elapsed();
    leave(&publishing.await??, &mut events).await;
    Ok(took)
}

pub(super) async fn receive(broker: &BrokerUnderTest) -> anyhow::Result<Duration> {
    let began = Instant::now();
    let (client, mut events) = connect(broker, &broker.receiver)?;
    let mut received = 0;
    while received < MESSAGES {
        if let Event::Incoming(Packet::Publish(_)) = events.poll().await? {
            received += 1;
        }
    }
    let took = began.elapsed();
    // The last acknowledgements are on their way still.
    let _ = tokio::time::timeout(Duration::from_millis(300), async {
        while events.poll().await.is_ok() {}
    })
    .await;
    leave(&client, &mut events).await;
    Ok(took)
}

async fn leave(client: &AsyncClient, events: &mut EventLoop) {
    let _ = client.disconnect().await;
    let _ = tokio::time::timeout(Duration::from_secs(1), async {
        while events.poll().await.is_ok() {}
    })
    .await;
}

fn connect(
    broker: &BrokerUnderTest,
    account: &Account,
) -> anyhow::Result<(AsyncClient, EventLoop)> {
    let (host, port) = broker.endpoint()?;
    let mut options = MqttOptions::new(&account.user_name, host, port);
    options
        .set_credentials(&account.user_name, &account.password)
        .set_clean_start(false)
        .set_session_expiry_interval(Some(SESSION_EXPIRY))
        .set_receive_maximum(Some(WINDOW))
        .set_outgoing_inflight_upper_limit(WINDOW);
    Ok(AsyncClient::new(options, usize::from(WINDOW)))
}
