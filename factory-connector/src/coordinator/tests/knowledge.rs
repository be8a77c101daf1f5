//! Knowledge of partners about a plant: random policies, changes of them, other mappings, statuses,
//! types, recipients, restarts and steps of the clock on one side; on the other side everything that
//! can be seen from outside: messages with their envelopes, keep-alives, nodes, live events, log,
//! metrics, ledger, receipts and spool, and the pages and exports of viewers and operators.
//!
//! Two plants are played at once. They get the same events, but that the values of the second
//! differ *below* what the policies let through ([`below`]), come later within a time step, and are
//! fewer or more while a state withholds them. Both must yield the same bytes (non-interference). A second model ([`knower`]), which knows candidates and policies only, says
//! what may be known; each message is compared with it when it leaves.
//!
//! `VERBUND_KNOWLEDGE_CASES` sets the number of histories and `VERBUND_KNOWLEDGE_SEED` their seed;
//! `VERBUND_KNOWLEDGE_SHRINKS` the attempts to make one that fails smaller.

mod acts;
mod below;
mod checks;
mod fields;
mod file;
mod knower;
mod link;
mod offers;
mod pages;
mod past;
mod plant;
mod possible;
mod telemetry;

use acts::{Act, acts};
use knower::Knower;
use offers::Varied;
use pages::Pages;
use plant::Plant;
use proptest::{
    prelude::ProptestConfig,
    test_runner::{RngAlgorithm, TestRng, TestRunner},
};
use telemetry::RecordedTelemetry;

use super::*;
use crate::store::Role;

const CASES: u32 = 16;
/// Number of histories of which one looks at all pages, which takes longer than its acts.
const HISTORIES_PER_LOOK: usize = 4;
/// Number of acts between two looks at all pages.
const ACTS_PER_LOOK: usize = 20;
const SEED: u64 = 20_261_124;

/// Amount of what the histories of a run did, so that none proves something about nothing.
#[derive(Debug, Default)]
struct Amount {
    reports: usize,
    varied: usize,
    /// Batches that came later to the other plant.
    later: usize,
    /// Values that newer ones replaced before they could leave.
    superseded: usize,
    taken_back: usize,
    /// Reports that a recipient was shown after they had left for others.
    past_reports: usize,
    pages: usize,
}

impl Amount {
    fn add(&mut self, varied: &Varied) {
        self.varied += varied.count;
        self.superseded += varied.superseded;
        self.reports += varied.reports;
        self.past_reports += varied.past_reports;
        self.later += usize::from(varied.later_ms > 0);
    }
}

#[test]
fn partners_learn_what_policies_let_through_and_nothing_below() {
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    let seed = number("VERBUND_KNOWLEDGE_SEED").unwrap_or(SEED);
    let cases = number("VERBUND_KNOWLEDGE_CASES").and_then(|cases| u32::try_from(cases).ok());
    let shrinks = number("VERBUND_KNOWLEDGE_SHRINKS").and_then(|count| u32::try_from(count).ok());
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed.to_be_bytes());
    let config = ProptestConfig {
        cases: cases.unwrap_or(CASES),
        max_shrink_iters: shrinks.unwrap_or(200),
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.expect("a runtime");
    let folder = tempfile::tempdir().expect("a folder");
    // A twin writes only what changes: with one of both plants the second would find nothing to write. They
    // have one certificate.
    let twins = [(); 2].map(|()| runtime.block_on(async { plant::twin(folder.path()) }));
    let handles = twins.each_ref().map(|(_, handle)| handle);
    let pages = Pages::of_description();
    let amount = std::cell::RefCell::new(Amount::default());
    let result = TestRunner::new_with_rng(config, rng).run(&acts(), |acts| {
        runtime.block_on(play(handles, &pages, &acts, &amount));
        Ok(())
    });
    if let Err(error) = result {
        panic!("seed {seed}: {error}");
    }
    let amount = amount.into_inner();
    let cases = usize::try_from(cases.unwrap_or(CASES)).expect("small");
    assert!(amount.reports > 3 * cases && amount.varied > 4 * cases, "{amount:?}");
    assert!(amount.later > cases / 8, "seed {seed}: {amount:?}");
    assert!(amount.superseded > cases / 4, "seed {seed}: {amount:?}");
    assert!(amount.taken_back > cases / 4 && amount.pages > 0, "seed {seed}: {amount:?}");
    assert!(amount.past_reports > 0, "seed {seed}: {amount:?}");
}

/// Plays a history at both plants, and compares what can be seen after each act.
async fn play(
    twins: [&twin::TwinHandle; 2],
    pages: &Pages,
    acts: &[Act],
    amount: &std::cell::RefCell<Amount>,
) {
    let mut plant = Plant::open(twins[0].clone()).await;
    let mut other = Plant::open(twins[1].clone()).await;
    let (mut knower, mut of_other) = (Knower::default(), Knower::default());
    let is_looked_at = amount.borrow().pages == 0 || acts.len().is_multiple_of(HISTORIES_PER_LOOK);
    for (place, act) in acts.iter().enumerate() {
        let varied;
        (plant, varied) = watched(plant, act, &mut knower, None).await;
        (other, _) = watched(other, act, &mut of_other, Some(&varied)).await;
        amount.borrow_mut().add(&varied);
        let (mut seen, mut others) = (plant.take_seen(), other.take_seen());
        if varied.later_ms > 0 {
            // What comes and what passes meanwhile changed places.
            seen.sort_unstable();
            others.sort_unstable();
        }
        compare(&seen, &others, &format!("act {place}, {act:?},"));
        let is_last = place + 1 == acts.len();
        if is_looked_at && (is_last || place % ACTS_PER_LOOK == ACTS_PER_LOOK - 1) {
            for (user, role) in [("vera", Role::Viewer), ("otto", Role::Operator)] {
                let count = plant.read(pages, user, role).await;
                other.read(pages, user, role).await;
                assert!(count > 30, "only {count} pages");
                amount.borrow_mut().pages += count;
                compare(&plant.take_seen(), &other.take_seen(), "a page");
            }
        }
    }
    let stored = file::stored(plant.folder.path()).await;
    let others = file::stored(other.folder.path()).await;
    amount.borrow_mut().taken_back += stored.iter().filter(|row| row.contains("PURGED")).count();
    compare(&stored, &others, "what is stored");
    plant.close().await;
    other.close().await;
}

/// Plays an act, and notes log and metrics meanwhile.
async fn watched(
    plant: Plant,
    act: &Act,
    knower: &mut Knower,
    of_other: Option<&Varied>,
) -> (Plant, Varied) {
    let telemetry = RecordedTelemetry::default();
    let _log = tracing::subscriber::set_default(telemetry.clone());
    let _metrics = metrics::set_default_local_recorder(&telemetry);
    let (mut plant, varied) = plant.act(act, knower, of_other).await;
    plant.seen.extend(telemetry.take());
    (plant, varied)
}

fn compare(seen: &[String], others: &[String], what: &str) {
    for (seen, others) in seen.iter().zip(others) {
        assert_eq!(seen, others, "{what} tells what is below the policy");
    }
    assert_eq!(seen.len(), others.len(), "{what} tells what is below the policy");
}
