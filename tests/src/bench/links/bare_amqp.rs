//! A bare AMQP 1.0 client. Its messages are those of the link, with the same properties.

use std::time::{Duration, Instant};

use anyhow::{Context as _, ensure};
use fe2o3_amqp::{
    Connection, Receiver, Sender, Session,
    connection::ConnectionHandle,
    link::receiver::CreditMode,
    sasl_profile::SaslProfile,
    types::{
        messaging::{Body, Data, Header, Message, MessageId, Properties},
        primitives::{Symbol, Value},
    },
};
use futures::{StreamExt as _, stream::FuturesUnordered};

use super::broker_under_test::{Account, BODY_BYTES, BrokerUnderTest, MESSAGES, WINDOW};

/// Messages settled at once, as the link does.
const BATCH: usize = 100;

pub(super) async fn send(broker: &BrokerUnderTest) -> anyhow::Result<Duration> {
    let began = Instant::now();
    let mut connection = connect(broker, &broker.sender).await?;
    let mut session = Session::begin(&mut connection).await?;
    let target = broker.profile.produce(&broker.address).address;
    let mut sender = Sender::attach(&mut session, "bare-out", target).await?;
    let mut outcomes = FuturesUnordered::new();
    for number in 1..=MESSAGES {
        if outcomes.len() >= usize::from(WINDOW) {
            let outcome: fe2o3_amqp::types::messaging::Outcome =
                outcomes.next().await.context("an outcome")??;
            ensure!(outcome.is_accepted(), "every message is accepted");
        }
        let mut message = Message::from(Data::from(vec![b'x'; BODY_BYTES]));
        message.header = Some(Header { durable: true, ..Header::default() });
        message.properties = Some(Properties {
            message_id: Some(MessageId::String(format!("m{number}"))),
            subject: Some("bench".to_owned()),
            content_type: Some(Symbol::from("application/json")),
            ..Properties::default()
        });
        outcomes.push(sender.send_batchable(message).await?);
    }
    while let Some(outcome) = outcomes.next().await {
        ensure!(outcome?.is_accepted(), "every message is accepted");
    }
    let took = began.elapsed();
    let _ = connection.close().await;
    Ok(took)
}

pub(super) async fn receive(broker: &BrokerUnderTest) -> anyhow::Result<Duration> {
    let began = Instant::now();
    let mut connection = connect(broker, &broker.receiver).await?;
    let mut session = Session::begin(&mut connection).await?;
    let mut receiver = Receiver::builder()
        .name("bare-in")
        .source(broker.profile.consume(&broker.address).address)
        .credit_mode(CreditMode::Auto(u32::from(WINDOW)))
        .attach(&mut session)
        .await?;
    let mut batch = Vec::with_capacity(BATCH);
    for number in 1..=MESSAGES {
        batch.push(receiver.recv::<Body<Value>>().await?);
        if batch.len() == BATCH || number == MESSAGES {
            receiver.accept_all(batch.drain(..)).await?;
        }
    }
    let took = began.elapsed();
    let _ = connection.close().await;
    Ok(took)
}

async fn connect(
    broker: &BrokerUnderTest,
    account: &Account,
) -> anyhow::Result<ConnectionHandle<()>> {
    let stream = tokio::net::TcpStream::connect(broker.endpoint()?).await?;
    stream.set_nodelay(true)?;
    let profile = SaslProfile::Plain {
        username: account.user_name.clone(),
        password: account.password.clone(),
    };
    Ok(Connection::builder()
        .container_id("bare")
        .sasl_profile(profile)
        .open_with_stream(stream)
        .await?)
}
