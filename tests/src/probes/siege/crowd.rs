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
    task::JoinSet,
    time::timeout,
};

use crate::{harness::say, probes::route::Route};

/// Connections of each kind to each listener, and the least number that has to be made.
const CROWD: u16 = 1000;

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

/// Lets silent and slow connections come to a listener from many addresses.
pub(super) fn gather(
    siege: &mut JoinSet<()>,
    tally: &mut Tally,
    listener: &str,
    port: u16,
    slow: Arc<[u8]>,
) {
    for (kind, is_silent) in [("silent", true), ("slow", false)] {
        let made = tally.count(format!("{kind} connections to the {listener}"), u64::from(CROWD));
        // A server may end them: the longest of them show how long it bears them.
        let held = tally.count(format!("{kind} connections to the {listener} for over 5 s"), 0);
        // As many as the server admits: it has places for so many, and who comes takes that of another.
        let most =
            tally.count(format!("{kind} connections to the {listener} at the same time"), 20);
        let open = Arc::new(Open { now: AtomicU64::default(), most });
        for n in 0..CROWD {
            let [high, low] = (n / 8).to_be_bytes();
            // Eight of each kind from each of 125 addresses; honest people have another one.
            let source = Ipv4Addr::new(127, 1, high, low.max(1));
            let (made, held, slow) = (Arc::clone(&made), Arc::clone(&held), Arc::clone(&slow));
            let open = Arc::clone(&open);
            siege.spawn(async move {
                loop {
                    let slow = (!is_silent).then_some(&*slow);
                    hold(source, port, slow, [&made, &held], &open).await.ok();
                    tokio::time::sleep(Duration::from_millis(500)).await;
                }
            });
        }
    }
}

/// Holds a connection open, silent or with a byte now and then, until it is closed.
async fn hold(
    source: Ipv4Addr,
    port: u16,
    slow: Option<&[u8]>,
    [made, held]: [&AtomicU64; 2],
    open: &Arc<Open>,
) -> io::Result<()> {
    let mut stream = Route::new(source, port).connect().await?;
    let _open = open.begins();
    if slow.is_none() {
        made.fetch_add(1, Ordering::Relaxed);
    }
    let begun = tokio::time::Instant::now();
    let mut is_counted = false;
    let (mut bytes, pause) = (slow.unwrap_or_default().iter(), Duration::from_millis(500));
    let mut is_first = true;
    loop {
        if let Some(byte) = bytes.next() {
            stream.write_all(&[*byte]).await?;
            if std::mem::take(&mut is_first) {
                made.fetch_add(1, Ordering::Relaxed);
            }
        } else if slow.is_some() {
            return Ok(());
        }
        if let Ok(read) = timeout(pause, stream.read(&mut [0; 64])).await
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
