//! Pings and their answers, which come in the order of the pings.

use std::sync::atomic::{AtomicU64, Ordering};

use rumqttc::v5::mqttbytes::v5::{Packet, PingReq};
use tokio::sync::{mpsc, watch};

/// Numbers of the pings of one connection.
#[derive(Debug, Default)]
pub(super) struct Pings {
    written: AtomicU64,
    answered: watch::Sender<u64>,
}

impl Pings {
    /// Notes that one is about to be written.
    pub(super) fn writes(&self) {
        self.written.fetch_add(1, Ordering::SeqCst);
    }

    /// Notes the answer to the oldest one without an answer.
    pub(super) fn answered(&self) {
        self.answered.send_modify(|count| *count += 1);
    }

    /// Has a ping written, and waits until one that is written from now on is answered: for ever where the connection is
    /// lost.
    pub(super) async fn ask(&self, packets: &mpsc::Sender<Packet>) {
        let number = self.written.load(Ordering::SeqCst) + 1;
        if packets.send(Packet::PingReq(PingReq)).await.is_err() {
            return std::future::pending().await;
        }
        // Its sender is this one's own, so that it never ends before.
        let _ = self.answered.subscribe().wait_for(|count| *count >= number).await;
    }
}
