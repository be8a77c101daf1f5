//! Recorder of accesses: the one place where withheld values are opened.

use std::{convert::Infallible, sync::Arc, time::Duration};

use access_log::{AccessKind, AccessLogKey};
use asi_model::DateTime;
use async_trait::async_trait;
use daemon::turns::Turns;
use parking_lot::Mutex;
use tokio_util::sync::CancellationToken;

use super::{Coalescer, Contents, Reader, Reading, Withheld};
use crate::clock::Clock;

/// Time between two entries about reads that go on, and between two checkpoints of a log that grows.
const INTERVAL: Duration = Duration::from_secs(60);
/// Most entries of one transaction, so that nobody waits long for the writer.
const ENTRIES_PER_WORK_MAX: usize = 500;
/// Entries of readers of one organisation that are written at a time. Its pages and live streams are many, and only so
/// many of them wait for the writer among others.
const OF_AN_ORGANISATION: usize = 2;

/// Failure to record an access; nothing is handed out then.
#[derive(Debug, thiserror::Error)]
pub enum NotRecorded {
    /// The store failed.
    #[error("cannot record who reads values")]
    Storage(#[source] Box<dyn std::error::Error + Send + Sync>),
    /// A viewer without an organisation would get values.
    #[error("values are for organisations only")]
    Nobody,
}

/// Writes entries of access logs.
#[async_trait]
pub trait AccessStorage: Send + Sync {
    /// Appends readings to the logs of their factories; on success they are durable.
    async fn append(&self, readings: &[Reading], now: DateTime) -> Result<(), NotRecorded>;

    /// Signs a checkpoint of each log that grew since its last one.
    async fn sign_checkpoints(&self, key: &AccessLogKey) -> Result<(), NotRecorded>;
}

/// Records accesses and opens withheld values. Clones share one.
#[derive(Clone)]
pub struct AccessRecorder(Arc<Shared>);

struct Shared {
    storage: Arc<dyn AccessStorage>,
    key: AccessLogKey,
    clock: Clock,
    coalescer: Mutex<Coalescer>,
    /// Turns to write, by organisation.
    turns: Turns,
}

impl AccessRecorder {
    /// Creates a recorder that has counted nothing. `key` signs the checkpoints.
    #[must_use]
    pub fn new(storage: Arc<dyn AccessStorage>, key: AccessLogKey, clock: Clock) -> Self {
        let (coalescer, turns) = (Mutex::default(), Turns::new(OF_AN_ORGANISATION));
        Self(Arc::new(Shared { storage, key, clock, coalescer, turns }))
    }

    /// Returns the key that signs the checkpoints.
    #[must_use]
    pub fn key(&self) -> &AccessLogKey {
        &self.0.key
    }

    /// Hands values out to a reader, once that is on record.
    ///
    /// # Errors
    /// [`NotRecorded`]; then nothing is handed out.
    pub async fn disclose<T>(
        &self,
        reader: Option<&Reader>,
        kind: AccessKind,
        withheld: Withheld<T>,
    ) -> Result<T, NotRecorded> {
        self.record(reader, kind, withheld.contents()).await?;
        Ok(withheld.open())
    }

    /// Shows values to a reader, once that is on record.
    ///
    /// # Errors
    /// [`NotRecorded`]; then nothing is shown.
    pub async fn show<'v, T>(
        &self,
        reader: Option<&Reader>,
        kind: AccessKind,
        withheld: &'v Withheld<T>,
    ) -> Result<&'v T, NotRecorded> {
        self.record(reader, kind, withheld.contents()).await?;
        Ok(withheld.get())
    }

    /// Divides readings into those that have to be entries before their values leave, and those to be
    /// counted. For those who write the entries in the transaction by which the values leave, and
    /// call [`written`](Self::written) after its commit.
    #[must_use]
    pub fn divide(&self, readings: Vec<Reading>) -> (Vec<Reading>, Vec<Reading>) {
        self.0.coalescer.lock().divide(readings)
    }

    /// Notes readings of a committed transaction: those that are entries, and those to be counted.
    pub fn written(&self, entries: &[Reading], counted: Vec<Reading>) {
        let mut coalescer = self.0.coalescer.lock();
        for reading in entries {
            coalescer.recorded(reading);
        }
        coalescer.put_back(counted);
    }

    /// Records what was counted so far, and signs a checkpoint of each log that grew.
    ///
    /// # Errors
    /// [`NotRecorded`]; the counts stay for the next time.
    pub async fn settle(&self) -> Result<(), NotRecorded> {
        self.summarise().await?;
        self.0.storage.sign_checkpoints(&self.0.key).await
    }

    async fn summarise(&self) -> Result<(), NotRecorded> {
        let mut counted = self.0.coalescer.lock().take();
        while !counted.is_empty() {
            let rest = counted.split_off(counted.len().min(ENTRIES_PER_WORK_MAX));
            if let Err(error) = self.0.storage.append(&counted, self.0.clock.now()).await {
                counted.extend(rest);
                self.0.coalescer.lock().put_back(counted);
                return Err(error);
            }
            counted = rest;
        }
        Ok(())
    }

    /// Records counts and signs checkpoints each minute until shutdown, and at its end.
    ///
    /// # Errors
    /// Never; a failing store is logged and tried again.
    pub async fn run(self, shutdown: CancellationToken) -> Result<(), Infallible> {
        let mut rounds = tokio::time::interval(INTERVAL);
        loop {
            let is_last = shutdown.run_until_cancelled(rounds.tick()).await.is_none();
            if let Err(error) = self.settle().await {
                tracing::warn!(%error, "Accesses could not be recorded.");
            }
            if is_last {
                return Ok(());
            }
        }
    }

    async fn record(
        &self,
        reader: Option<&Reader>,
        kind: AccessKind,
        contents: &[Contents],
    ) -> Result<(), NotRecorded> {
        if contents.is_empty() {
            return Ok(());
        }
        let reader = reader.ok_or(NotRecorded::Nobody)?;
        let since = self.0.clock.now();
        let readings = contents.iter().map(|contents| Reading {
            reader: reader.clone(),
            kind,
            contents: contents.clone(),
            since,
        });
        let due = self.uncounted(readings.collect());
        if due.is_empty() {
            return Ok(());
        }
        // However many wait: pages have turns of their own, and live streams places.
        let _turn = self.0.turns.take(reader.organisation_id.as_str(), usize::MAX).await;
        // Another page of the reader may have entered the same meanwhile.
        let due = self.uncounted(due);
        if due.is_empty() {
            return Ok(());
        }
        // On its own: who reads waits once for the disk, and then for a minute no more.
        self.0.storage.append(&due, since).await?;
        let mut coalescer = self.0.coalescer.lock();
        for reading in &due {
            coalescer.recorded(reading);
        }
        Ok(())
    }

    /// Counts readings of what is on record, and returns the others.
    fn uncounted(&self, readings: Vec<Reading>) -> Vec<Reading> {
        let all = readings.len();
        let mut coalescer = self.0.coalescer.lock();
        let due: Vec<Reading> =
            readings.into_iter().filter(|reading| !coalescer.count(reading)).collect();
        drop(coalescer);
        let counted = (all - due.len()) as u64;
        metrics::counter!("verbund_accesses_coalesced_total").increment(counted);
        due
    }
}

impl std::fmt::Debug for AccessRecorder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("AccessRecorder")
    }
}

#[cfg(test)]
mod tests;
