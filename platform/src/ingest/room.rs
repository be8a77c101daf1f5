//! Room of senders in the store: a factory or tool that has used its own up waits, and the disk is there for others.

use std::{
    collections::HashMap,
    path::PathBuf,
    time::{Duration, Instant},
};

use broker::DiskSpace;
use messaging::{BrokerUrl, LogicalAddress};
use parking_lot::Mutex;

use super::{dead_letter::holder, used_up::count_used_up};
use crate::{
    config::PlatformConfig,
    disk,
    store::{Holder, Kept, StoreError, StoreReader},
};

/// Share of a factory or tool in the store.
const KEPT: &str = "kept";
/// Time for which it is not looked again how much room a sender has left. It writes a small part of it meanwhile.
const LOOKED_EVERY: Duration = Duration::from_secs(5);

/// Bounds on what is kept of the messages of one sender, in bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RoomConfig {
    /// Folder of the store. While its disk is short, who holds more than others waits.
    pub data_directory: PathBuf,
    pub factory_bytes_max: u64,
    pub tool_bytes_max: u64,
    /// True where the broker keeps what a sender sends beyond its room, and refuses what is beyond its own. False where
    /// it would drop that without a word, as with MQTT: what is beyond is set aside then, where it can be seen.
    pub may_wait: bool,
}

impl RoomConfig {
    /// Returns the bounds that the configuration sets.
    #[must_use]
    pub fn of(config: &PlatformConfig) -> Self {
        let bytes = |mib: u32| u64::from(mib) << 20;
        let external = config.broker.external.as_ref();
        let is_mqtt = external.is_some_and(|broker| broker.urls.iter().any(BrokerUrl::is_mqtt));
        Self {
            data_directory: config.data_directory.clone(),
            factory_bytes_max: bytes(config.retention.kept_mib_per_factory),
            tool_bytes_max: bytes(config.retention.kept_mib_per_tool),
            may_wait: !is_mqtt,
        }
    }
}

/// Room of all senders.
pub(super) struct Room {
    config: RoomConfig,
    store: StoreReader,
    /// Times at which it was last seen that a sender has room.
    seen_at: Mutex<HashMap<LogicalAddress, Instant>>,
}

impl Room {
    /// Room within bounds, as far as the store has it.
    pub fn new(config: RoomConfig, store: StoreReader) -> Self {
        Self { config, store, seen_at: Mutex::default() }
    }

    /// Waits until a sender has room. Returns why there is none, where it cannot wait, or where `end` comes first.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of(
        &self,
        address: &LogicalAddress,
        end: impl Future<Output = ()>,
    ) -> Result<Option<String>, StoreError> {
        let mut end = std::pin::pin!(end);
        let mut is_said = false;
        loop {
            let Some(reason) = self.lacking(address).await? else { return Ok(None) };
            let who = holder(&address.to_string());
            if let Some(sender) = Holder::of(address) {
                count_used_up(KEPT, &sender);
            }
            if !is_said {
                tracing::warn!(sender = who, reason, "A sender has used its room in the store up.");
                is_said = true;
            }
            if !self.config.may_wait {
                return Ok(Some(reason));
            }
            tokio::select! {
                () = &mut end => return Ok(Some(reason)),
                () = tokio::time::sleep(LOOKED_EVERY) => {}
            }
        }
    }

    /// True where messages of a sender without room stay with the broker.
    pub const fn may_wait(&self) -> bool {
        self.config.may_wait
    }

    /// Returns why a sender has no room; none where it has.
    async fn lacking(&self, address: &LogicalAddress) -> Result<Option<String>, StoreError> {
        let now = Instant::now();
        let was_seen = |at: &Instant| now.saturating_duration_since(*at) < LOOKED_EVERY;
        if self.seen_at.lock().get(address).is_some_and(was_seen) {
            return Ok(None);
        }
        let kept = self.store.read().await?.quotas().of_sender(address).await?;
        let (key, most) = match address.tool_id() {
            Some(_) => ("kept_mib_per_tool", self.config.tool_bytes_max),
            None => ("kept_mib_per_factory", self.config.factory_bytes_max),
        };
        if kept.bytes >= most {
            return Ok(Some(format!(
                "{} messages and reports of {} bytes are kept; retention.{key} allows {most} bytes. Raise it, or keep \
                 messages for fewer days.",
                kept.rows, kept.bytes
            )));
        }
        let disk = disk::space_of(&self.config.data_directory);
        // One that says nothing has enough.
        if disk.is_some_and(DiskSpace::is_short) {
            let all = self.store.read().await?.quotas().of_all_senders().await?;
            if has_more_than_others(kept, all) {
                return Ok(Some(format!(
                    "The disk is nearly full, and {} of {} bytes that are kept of {} senders are this one's. Make room on \
                     the disk, or keep messages for fewer days.",
                    kept.bytes, all.bytes, all.rows
                )));
            }
        }
        self.seen_at.lock().insert(address.clone(), now);
        Ok(None)
    }
}

/// Returns true for a sender of which more than an equal part is kept.
fn has_more_than_others(kept: Kept, all: Kept) -> bool {
    u128::from(kept.bytes) * u128::from(all.rows) > u128::from(all.bytes)
}

#[cfg(test)]
mod tests {
    use asi_model::DateTime;

    use super::*;
    use crate::store::{NewInboxMessage, Store};

    fn small(folder: &tempfile::TempDir) -> RoomConfig {
        RoomConfig {
            data_directory: folder.path().to_owned(),
            factory_bytes_max: 10_000,
            tool_bytes_max: 1_000,
            may_wait: false,
        }
    }

    fn address(text: &str) -> LogicalAddress {
        text.parse().expect("an address")
    }

    async fn store(folder: &tempfile::TempDir) -> Store {
        Store::open(&folder.path().join("store.sqlite")).await.expect("it opens")
    }

    /// Stores messages of 1 000 bytes each, what counts beside the body included.
    async fn sends(store: &Store, address: &LogicalAddress, ids: std::ops::Range<u32>) {
        let message = |number| NewInboxMessage {
            message_id: format!("m{number}").parse().expect("an id"),
            message_type: "ua-data".into(),
            received_at: DateTime::from_ticks(i64::from(number)),
            body: "x".repeat(800),
        };
        let messages: Vec<_> = ids.map(message).collect();
        let mut work = store.begin().await.expect("begun");
        work.inbox().store(&address.to_string(), &messages).await.expect("stored");
        work.commit().await.expect("committed");
    }

    #[tokio::test]
    async fn who_has_used_its_room_up_waits_until_messages_are_forgotten_and_nobody_else_does() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = store(&folder).await;
        let [full, other, tool] =
            ["factory.F.ingress", "factory.G.ingress", "tool.T.requests"].map(address);
        sends(&store, &full, 0..10).await;
        sends(&store, &other, 0..9).await;
        sends(&store, &tool, 0..1).await;
        // What comes twice is kept once.
        sends(&store, &other, 0..9).await;
        let room = Room::new(small(&folder), store.reader());
        let never = std::future::pending::<()>;
        let reason = room.of(&full, never()).await.expect("read").expect("no room");
        assert!(reason.contains("kept_mib_per_factory allows 10000 bytes"), "{reason}");
        assert!(reason.starts_with("10 messages and reports of 10000 bytes"), "{reason}");
        assert!(room.of(&tool, never()).await.expect("read").is_some());
        assert_eq!(room.of(&other, never()).await.expect("read"), None);

        let waiting = Room::new(RoomConfig { may_wait: true, ..small(&folder) }, store.reader());
        let ended = waiting.of(&full, std::future::ready(())).await.expect("read");
        assert!(ended.is_some(), "the end comes first");
        let mut work = store.begin().await.expect("begun");
        let forgotten = work.inbox().forget(DateTime::from_ticks(5), 100).await.expect("forgotten");
        work.commit().await.expect("committed");
        assert_eq!(forgotten, 5 + 5 + 1);
        assert_eq!(waiting.of(&full, never()).await.expect("read"), None);
    }

    #[test]
    fn who_holds_more_than_an_equal_part_waits_while_the_disk_is_short() {
        let kept = |bytes| Kept { rows: 1, bytes };
        let all = Kept { rows: 3, bytes: 300 };
        assert!(has_more_than_others(kept(101), all));
        assert!(!has_more_than_others(kept(100), all), "an equal part");
        assert!(
            !has_more_than_others(kept(300), Kept { rows: 1, bytes: 300 }),
            "there are no others"
        );
    }
}
