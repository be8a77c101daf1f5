//! Sign-ins that fail again and again.

use std::net::Ipv4Addr;

use fe2o3_amqp_types::sasl::{SaslCode, SaslOutcome};
use testkit::amqp::sasl_init;
use tokio::{io::AsyncReadExt, net::TcpSocket};

use crate::{
    raw::{RawPeer, SASL, SASL_HEADER, frame},
    support::{SECRET, TestBroker},
};

/// Signs in from one of many addresses of this machine, and returns the outcome.
async fn sign_in(broker: &TestBroker, from: u8, user: &str, secret: &str) -> SaslCode {
    let socket = TcpSocket::new_v4().expect("a socket");
    socket.bind((Ipv4Addr::new(127, 0, 3, from), 0).into()).expect("an address");
    let port = broker.port();
    let stream = socket.connect(([127, 0, 0, 1], port).into()).await.expect("a connection");
    let mut peer = RawPeer(stream);
    peer.send(SASL_HEADER).await;
    peer.send(&frame(SASL, 0, &sasl_init(user, secret))).await;
    peer.0.read_exact(&mut [0; 8]).await.expect("a header of SASL");
    peer.read().await.expect("mechanisms");
    let (_, outcome) = peer.read().await.expect("an outcome");
    serde_amqp::from_slice::<SaslOutcome>(&outcome).expect("an outcome").code
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn guesses_of_secrets_are_few_and_lock_out_nobody_elsewhere() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    assert!(matches!(sign_in(&broker, 1, "f1", SECRET).await, SaslCode::Ok));
    let mut compared = 0;
    while matches!(sign_in(&broker, 2, "f1", "a guess").await, SaslCode::Auth) {
        compared += 1;
        assert!(compared < 100, "{compared} guesses were compared");
    }
    let refused = sign_in(&broker, 2, "f1", SECRET).await;
    assert!(matches!(refused, SaslCode::SysTemp), "the secret is not compared: {refused:?}");
    for from in [1, 3] {
        let elsewhere = sign_in(&broker, from, "f1", SECRET).await;
        assert!(matches!(elsewhere, SaslCode::Ok), "at address {from}: {elsewhere:?}");
    }
    let other = sign_in(&broker, 2, "platform", SECRET).await;
    assert!(matches!(other, SaslCode::Ok), "another user of the address: {other:?}");
    broker.stop().await;
}
