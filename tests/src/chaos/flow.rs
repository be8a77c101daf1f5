//! Reports that keep coming: each writer that sent before has to send again after each round.

use std::{
    collections::BTreeMap,
    time::{Duration, Instant},
};

use super::{findings::breach, stage::Stage};
use crate::{
    frame_order::{HAMBURG, MUNICH},
    harness::Api,
    scenario::load,
};

/// Time for everything to work again after a round. A peer that is gone without a word is
/// noticed after the link's own patience, and a login throttle or a backoff may add to it.
pub(super) const RECOVERY: Duration = Duration::from_secs(120);
/// Reports after a round by which a writer that is kept busy is seen to send again.
const NEWER: u64 = 2;

/// Number of reports of each request.
type Counts = BTreeMap<String, u64>;

/// Returns the requests to which no newer reports have come. Those of the order itself have a report now and then.
fn silent(factory: &str, before: &Counts, now: &Counts) -> Vec<String> {
    let busy = load::requests(factory);
    let count =
        |counts: &Counts, request: &String| counts.get(request).copied().unwrap_or_default();
    let is_silent = |request: &&String| {
        let wanted = if busy.contains(request) { NEWER } else { 1 };
        count(now, request) < count(before, request) + wanted
    };
    let others = before.iter().filter(|(request, count)| **count > 0 && !busy.contains(request));
    let all = busy.iter().chain(others.map(|(request, _)| request));
    all.filter(is_silent).cloned().collect()
}

/// Waits until newer reports of each writer of both factories arrive that had any.
pub(super) async fn flows(stage: &mut Stage) -> anyhow::Result<()> {
    stage.supervise()?;
    let mut platform = stage.world.platform_api().await?;
    let deadline = Instant::now() + RECOVERY;
    let mut before = Vec::new();
    for factory in [MUNICH, HAMBURG] {
        before.push((factory, received_by(deadline, stage, &mut platform, factory).await?));
    }
    for (factory, before) in before {
        loop {
            let now = received_by(deadline, stage, &mut platform, factory).await?;
            let silent = silent(factory, &before, &now);
            if silent.is_empty() {
                break;
            }
            if Instant::now() > deadline {
                let fault = format!("no reports of {factory} to {silent:?} for {RECOVERY:?}");
                return Err(breach(vec![fault]));
            }
            stage.supervise()?;
            tokio::time::sleep(Duration::from_millis(50)).await;
        }
    }
    stage.note_room().await?;
    Ok(())
}

/// Asks until the platform answers: a clock that jumps ends sessions, too.
async fn received_by(
    deadline: Instant,
    stage: &mut Stage,
    platform: &mut Api,
    factory: &str,
) -> anyhow::Result<Counts> {
    loop {
        if let Ok(counts) = received(platform, factory).await {
            return Ok(counts);
        }
        anyhow::ensure!(Instant::now() < deadline, "no answer about {factory}");
        *platform = stage.world.platform_api().await?;
    }
}

/// Returns the number of reports that the platform has of each request to a factory.
async fn received(platform: &Api, factory: &str) -> anyhow::Result<Counts> {
    let writers = platform.list(&format!("/api/v1/factories/{factory}/writers")).await?;
    let mut counts = Counts::new();
    for writer in &writers {
        if let Some(request) = writer["dynamicDataRequestId"].as_str() {
            let count = writer["received"].as_u64().unwrap_or_default();
            *counts.entry(request.to_owned()).or_default() += count;
        }
    }
    Ok(counts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_writer_that_sends_no_more_is_seen() {
        let counts = |busy: u64, other: u64| -> Counts {
            let busy = load::requests(MUNICH).into_iter().map(|request| (request, busy));
            busy.chain([("other".to_owned(), other)]).collect()
        };
        let found = |before: &Counts, now: &Counts| silent(MUNICH, before, now);
        assert_eq!(found(&counts(3, 4), &counts(5, 5)), [""; 0]);
        assert_eq!(found(&counts(3, 4), &counts(4, 5)).len(), load::requests(MUNICH).len());
        assert_eq!(found(&counts(3, 4), &counts(5, 4)), ["other"]);
        assert_eq!(found(&counts(3, 0), &counts(5, 0)), [""; 0], "it never had any");
        assert_eq!(found(&Counts::new(), &Counts::new()), load::requests(MUNICH));
    }
}
