//! Crowds that hold connections, and the count of them.

use std::{
    io,
    net::Ipv4Addr,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    time::Duration,
};

use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    time::timeout,
};

use super::attackers::Attackers;
use crate::{
    harness::say,
    probes::entrance::{Entrance, Wire},
};

/// Connections that come through no layer, of each kind to each listener, and the least number that has to be made.
pub(super) const CROWD: u16 = 1000;
/// Connections that complete TLS or the request for a WebSocket before they are silent or slow: of each kind to each
/// listener. Each handshake takes the attackers as long as the broker, and both share the processors of one machine.
pub(super) const CROWD_BEHIND_LAYERS: u16 = 100;
/// Pause before a connection that was closed comes again.
const PAUSE: Duration = Duration::from_millis(500);
const PAUSE_BEHIND_LAYERS: Duration = Duration::from_secs(4);
/// Time for the layers.
const PATIENCE: Duration = Duration::from_secs(30);

/// A running number.
pub(super) type Count = Arc<AtomicU64>;

/// Numbers of what was done, each with the least that has to be.
#[derive(Debug, Default)]
pub(super) struct Tally(Vec<(String, u64, Count)>);

impl Tally {
    /// Adds a number.
    pub fn count(&mut self, name: String, at_least: u64) -> Count {
        let count = Count::default();
        self.0.push((name, at_least, Arc::clone(&count)));
        count
    }

    /// Prints all numbers. Returns those that are too low.
    pub fn judge(&self) -> Vec<String> {
        let mut faults = Vec::new();
        for (name, at_least, count) in &self.0 {
            let count = count.load(Ordering::Relaxed);
            say(&format!("  {name}: {count}"));
            if count < *at_least {
                faults.push(format!("{name}: {count} only, of {at_least} at least"));
            }
        }
        faults
    }
}

/// Connections of a kind that are open at the same time.
#[derive(Debug, Default)]
struct Open {
    now: AtomicU64,
    most: Count,
}

impl Open {
    fn begins(self: &Arc<Self>) -> OpenConnection {
        let now = self.now.fetch_add(1, Ordering::Relaxed) + 1;
        self.most.fetch_max(now, Ordering::Relaxed);
        OpenConnection(Arc::clone(self))
    }
}

/// One of them, until it ends.
struct OpenConnection(Arc<Open>);

impl Drop for OpenConnection {
    fn drop(&mut self) {
        self.0.now.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Connections of one kind to one listener.
pub(super) struct Crowd {
    /// Name for people: `silent connections to the broker`.
    pub name: String,
    pub entrance: Entrance,
    /// Bytes that come one by one; none of a connection that is silent.
    pub slow: Option<Arc<[u8]>>,
    pub size: u16,
    /// Number that has to be open at the same time, at least: a listener has places for so many, and who comes takes
    /// that of another.
    pub open_min: u64,
}

impl Crowd {
    /// Lets the connections come from many addresses, and come again.
    pub fn gather(self, siege: &mut Attackers, tally: &mut Tally) {
        let Self { name, entrance, slow, size, open_min } = self;
        let made = tally.count(name.clone(), u64::from(size));
        // A server may end them: the longest of them show how long it bears them.
        let held = tally.count(format!("{name} for over 5 s"), 0);
        let most = tally.count(format!("{name} at the same time"), open_min);
        let open = Arc::new(Open { now: AtomicU64::default(), most });
        let pause = if size == CROWD { PAUSE } else { PAUSE_BEHIND_LAYERS };
        for n in 0..size {
            let [high, low] = (n / 8).to_be_bytes();
            // Eight of each kind from each of up to 125 addresses; honest people have another one.
            let source = Ipv4Addr::new(127, 1, high, low.max(1));
            let (made, held, slow) = (Arc::clone(&made), Arc::clone(&held), slow.clone());
            let (open, entrance) = (Arc::clone(&open), entrance.clone());
            siege.spawn(async move {
                // Not all in one moment: that would be over before anybody honest comes.
                tokio::time::sleep(pause * u32::from(n) / u32::from(size)).await;
                loop {
                    hold(&entrance, source, slow.as_deref(), [&made, &held], &open).await.ok();
                    tokio::time::sleep(pause).await;
                }
            });
        }
    }
}

/// Holds a connection open, silent or with a byte now and then, until it is closed.
async fn hold(
    entrance: &Entrance,
    source: Ipv4Addr,
    slow: Option<&[u8]>,
    [made, held]: [&AtomicU64; 2],
    open: &Arc<Open>,
) -> io::Result<()> {
    let mut wire = timeout(PATIENCE, entrance.open(source)).await??;
    let _open = open.begins();
    if slow.is_none() {
        made.fetch_add(1, Ordering::Relaxed);
    }
    let begun = tokio::time::Instant::now();
    let mut is_counted = false;
    let mut bytes = slow.unwrap_or_default().iter();
    let mut is_first = true;
    loop {
        if let Some(byte) = bytes.next() {
            send(&mut wire, *byte).await?;
            if std::mem::take(&mut is_first) {
                made.fetch_add(1, Ordering::Relaxed);
            }
        } else if slow.is_some() {
            return Ok(());
        }
        if let Ok(read) = timeout(Duration::from_millis(500), wire.read(&mut [0; 64])).await
            && read? == 0
        {
            return Ok(());
        }
        if !is_counted && begun.elapsed() > Duration::from_secs(5) {
            is_counted = true;
            held.fetch_add(1, Ordering::Relaxed);
        }
    }
}

async fn send(wire: &mut Box<dyn Wire>, byte: u8) -> io::Result<()> {
    wire.write_all(&[byte]).await?;
    wire.flush().await
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_siege_in_which_too_little_was_done_is_found() {
        let mut tally = Tally::default();
        let (guesses, repeats) = (tally.count("a".to_owned(), 3), tally.count("b".to_owned(), 3));
        guesses.fetch_add(3, Ordering::Relaxed);
        repeats.fetch_add(2, Ordering::Relaxed);
        assert_eq!(tally.judge(), ["b: 2 only, of 3 at least"]);
    }
}
