//! After the commit: twin, mapping engine, link and pages hear of it, in this order.

use std::{
    collections::HashMap,
    time::{Duration, Instant},
};

use asi_model::OperationNetworkId;
use time::OffsetDateTime;
use twin::AsiDocument;

use super::{Desk, now};
use crate::books::{Aftermath, TwinWork};

/// How long the twin is brought up to date without letting others run.
const TURN_MAX: Duration = Duration::from_millis(2);

impl Desk {
    pub(super) async fn follow(&mut self, aftermath: Aftermath) {
        let mut turn = Instant::now();
        for work in aftermath.twin {
            self.show(work);
            // After a restart there are thousands: those who read meanwhile get their turns.
            if turn.elapsed() >= TURN_MAX {
                tokio::task::yield_now().await;
                turn = Instant::now();
            }
        }
        if !aftermath.values.is_empty() {
            self.rooms.twin.publish_values(aftermath.values);
        }
        if !aftermath.mappings.is_empty()
            && self.rooms.mappings.send(aftermath.mappings).await.is_err()
        {
            tracing::warn!("The mapping engine has ended; a mapping was not published.");
        }
        if let Some(link) = &self.rooms.link {
            if aftermath.is_receipted {
                link.receipted(OffsetDateTime::now_utc());
            }
            if aftermath.is_spool_rewound {
                link.rewind();
            }
            if aftermath.is_spool_filled {
                link.wake();
            }
        }
        if !aftermath.events.is_empty() {
            self.rooms.events.publish(aftermath.events);
        }
    }

    fn show(&self, work: TwinWork) {
        match work {
            TwinWork::Apply(id) => {
                if let Some(document) = self.document(&id) {
                    self.rooms.twin.apply(document);
                }
            }
            TwinWork::Remove(id) => {
                self.rooms.twin.remove(&id);
            }
            TwinWork::Decision(key) => {
                if let Some(field) = self.books.field(&key) {
                    self.rooms.twin.publish_decision(&key, field.record());
                }
            }
        }
    }

    fn document(&self, id: &OperationNetworkId) -> Option<AsiDocument> {
        let network = self.books.networks.get(id)?;
        let message = network.message.clone()?;
        let writers: HashMap<_, _> = message
            .operation_network
            .requests()
            .filter_map(|(key, ..)| self.books.writer_of.get(&key).map(|writer| (key, *writer)))
            .collect();
        let fields = message
            .operation_network
            .fields()
            .filter_map(|(key, ..)| self.books.field(&key).map(|field| (key, field.record())))
            .collect();
        Some(AsiDocument { message, received_at: network.received_at, writers, fields })
    }
}

/// Used by housekeeping for the age of things.
pub(super) fn offset_now() -> OffsetDateTime {
    now().into()
}
