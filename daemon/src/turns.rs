//! Turns by name: of each name so many work at a time, and the others wait in a line of their own.

use std::{collections::HashMap, sync::Arc};

use parking_lot::Mutex;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// Turns of all names; clones share them. Names of which nothing works or waits are forgotten.
#[derive(Debug, Clone)]
pub struct Turns {
    at_a_time: usize,
    lines: Arc<Mutex<HashMap<String, WaitingLine>>>,
}

/// Line of a name, in the order in which its requests came.
#[derive(Debug)]
struct WaitingLine {
    turns: Arc<Semaphore>,
    /// Number of those that have their turn or wait for it.
    entered: usize,
}

/// Turn, which ends when this is dropped.
#[derive(Debug)]
pub struct Turn {
    _permit: OwnedSemaphorePermit,
    /// Dropped last: a name that is forgotten has no permits any more.
    _place: PlaceInLine,
}

/// Place in the line of a name.
#[derive(Debug)]
struct PlaceInLine {
    turns: Turns,
    name: String,
}

impl Turns {
    /// Turns for so many of each name at a time.
    #[must_use]
    pub fn new(at_a_time: usize) -> Self {
        Self { at_a_time, lines: Arc::default() }
    }

    /// Waits for a turn of a name; none where so many of it wait already.
    pub async fn take(&self, name: &str, waiting_max: usize) -> Option<Turn> {
        let (place, turns) = self.enter(name, waiting_max)?;
        let permit = turns.acquire_owned().await.expect("a line is never closed");
        Some(Turn { _permit: permit, _place: place })
    }

    fn enter(&self, name: &str, waiting_max: usize) -> Option<(PlaceInLine, Arc<Semaphore>)> {
        let mut lines = self.lines.lock();
        let line = lines.entry(name.to_owned()).or_insert_with(|| WaitingLine {
            turns: Arc::new(Semaphore::new(self.at_a_time)),
            entered: 0,
        });
        if line.entered >= self.at_a_time.saturating_add(waiting_max) {
            return None;
        }
        line.entered += 1;
        Some((PlaceInLine { turns: self.clone(), name: name.to_owned() }, Arc::clone(&line.turns)))
    }
}

impl Drop for PlaceInLine {
    fn drop(&mut self) {
        let mut lines = self.turns.lines.lock();
        let Some(line) = lines.get_mut(&self.name) else { return };
        line.entered -= 1;
        if line.entered == 0 {
            lines.remove(&self.name);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use tokio::time::timeout;

    use super::*;

    /// Takes a turn that is free; none where it has to be waited for.
    async fn free(turns: &Turns, name: &str) -> Option<Turn> {
        let taken = timeout(Duration::from_millis(100), turns.take(name, 100)).await;
        taken.ok().map(|turn| turn.expect("few wait"))
    }

    #[tokio::test]
    async fn who_waits_holds_up_no_other_and_has_its_turn_in_order() {
        let turns = Turns::new(1);
        let held = free(&turns, "ann").await.expect("free");
        let (sender, mut order) = tokio::sync::mpsc::unbounded_channel();
        for number in 0..3 {
            let (waiting, sender) = (turns.clone(), sender.clone());
            tokio::spawn(async move {
                let _turn = waiting.take("ann", 3).await.expect("three may wait");
                sender.send(number).expect("it is listened to");
            });
            while turns.lines.lock()["ann"].entered < number + 2 {
                tokio::task::yield_now().await;
            }
        }
        assert!(turns.take("ann", 3).await.is_none(), "too many wait");
        assert!(free(&turns, "bob").await.is_some());
        drop(held);
        for number in 0..3 {
            assert_eq!(order.recv().await, Some(number));
        }
    }

    #[tokio::test]
    async fn who_gives_up_leaves_its_place() {
        let turns = Turns::new(2);
        let first = free(&turns, "ann").await.expect("free");
        let second = free(&turns, "ann").await.expect("free");
        for _ in 0..3 {
            assert!(free(&turns, "ann").await.is_none());
        }
        assert_eq!(turns.lines.lock()["ann"].entered, 2);
        drop((first, second));
        assert!(free(&turns, "ann").await.is_some());
        assert!(turns.lines.lock().is_empty());
    }
}
