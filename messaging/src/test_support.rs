//! Brokers and an inbox for the tests of this and other crates; never part of a daemon.

mod mosquitto;
mod rabbitmq;

use std::{collections::HashMap, time::Duration};

use async_trait::async_trait;
use parking_lot::Mutex;

pub use crate::transport::read_mqtt;
pub use mosquitto::{Mosquitto, Saving, ServerCertificate};
pub use rabbitmq::RabbitMq;

use crate::{
    address::LogicalAddress,
    inbox::{Delivery, Inbox, Settlement},
};

/// An inbox that records its deliveries and answers as configured.
#[derive(Debug, Default)]
pub struct RecordingInbox {
    /// All deliveries, repeats included.
    pub received: Mutex<Vec<(LogicalAddress, Delivery)>>,
    /// Answers by message id, the last one first and each used once; all others are accepted.
    pub answers: Mutex<HashMap<String, Vec<Settlement>>>,
    /// Duration of each batch.
    pub delay: Mutex<Duration>,
}

impl RecordingInbox {
    /// Returns the ids of the received messages, repeats included.
    #[must_use]
    pub fn ids(&self) -> Vec<String> {
        let received = self.received.lock();
        received.iter().map(|(_, delivery)| id_of(delivery)).collect()
    }

    /// Adds an answer to a message with that id, used once.
    pub fn answer(&self, id: &str, settlement: Settlement) {
        self.answers.lock().entry(id.to_owned()).or_default().push(settlement);
    }
}

#[async_trait]
impl Inbox for RecordingInbox {
    async fn receive(
        &self,
        address: &LogicalAddress,
        deliveries: Vec<Delivery>,
    ) -> Vec<Settlement> {
        let delay = *self.delay.lock();
        if !delay.is_zero() {
            tokio::time::sleep(delay).await;
        }
        let answer = |delivery: Delivery| {
            let id = id_of(&delivery);
            self.received.lock().push((address.clone(), delivery));
            self.answers.lock().get_mut(&id).and_then(Vec::pop).unwrap_or(Settlement::Accept)
        };
        deliveries.into_iter().map(answer).collect()
    }
}

fn id_of(delivery: &Delivery) -> String {
    delivery.envelope.message_id.as_ref().map_or(String::new(), ToString::to_string)
}
