//! Checks of the stores of both sides after everything has stopped.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
};

use anyhow::Context as _;

use super::{
    control::{self, Taken},
    counted, kinds,
    stage::Stage,
    stores::{self, Left, ReportKey, given_up},
};
use crate::{frame_order::HAMBURG, scenario::load};

/// Faults shown at most to people.
const SHOWN_MAX: usize = 20;

/// Breaches of what is promised, as the error of a run. `tests/mutants/run.sh` looks for a fault among all of them, and
/// nowhere else.
#[derive(Debug)]
pub struct Breach(Vec<String>);

impl Breach {
    /// Adds the faults that it does not have.
    pub(super) fn add(&mut self, faults: &[String]) {
        for fault in faults {
            if !self.0.contains(fault) {
                self.0.push(fault.clone());
            }
        }
    }

    /// Returns all faults, each as a line.
    #[must_use]
    pub fn lines(&self) -> String {
        self.0.iter().map(|fault| fault.replace('\n', " ") + "\n").collect()
    }
}

impl fmt::Display for Breach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} faults:", self.0.len())?;
        self.0.iter().take(SHOWN_MAX).try_for_each(|fault| write!(f, "\n  {fault}"))
    }
}

impl std::error::Error for Breach {}

/// Result of the checks.
#[derive(Debug, Default)]
pub(super) struct Findings {
    /// Reports that left the factories.
    pub left: usize,
    /// Number of these that the platform stored.
    pub arrived: usize,
    /// Number of reports that were given up, and announced so.
    pub given_up: usize,
    /// Number of reports that came with the backlog after an outage.
    pub replayed: usize,
    /// Breaches of what is promised.
    pub faults: Vec<String>,
}

impl Findings {
    /// Adds what machines or scripts counted and no report has.
    pub async fn of_machines(&mut self, stage: &Stage, factory: &str) -> anyhow::Result<()> {
        let left = stores::left(&stage.world.places.folder, factory).await?;
        let end = stage.machines_stopped.context("the machines were stopped")?;
        self.faults.extend(counted::faults(factory, &left, &stage.disturbed, end));
        self.faults.extend(kinds::faults(factory, &left));
        Ok(())
    }
}

/// Returns breaches of what is promised as the error of a run.
pub(super) fn breach(faults: Vec<String>) -> anyhow::Error {
    Breach(faults).into()
}

/// Compares what left one factory with what arrived, and adds to the findings.
pub(super) async fn of_factory(
    stage: &Stage,
    factory: &str,
    taken: Option<&Taken>,
    findings: &mut Findings,
) -> anyhow::Result<()> {
    let folder = &stage.world.places.folder;
    let left = stores::left(folder, factory).await?;
    let arrived = stores::arrived(folder, factory).await?;
    let announced = given_up::gaps(folder, factory).await?;
    let given_up = given_up::given_up(folder, factory).await?;
    let mut faults = Vec::new();

    let held: BTreeMap<&ReportKey, &stores::Arrived> =
        arrived.iter().map(|(key, report)| (key, report)).collect();
    if held.len() != arrived.len() {
        faults.push(format!("{factory}: {} reports are held twice", arrived.len() - held.len()));
    }
    for (key, report) in &left {
        match held.get(key) {
            None if announced.contains_key(key) => {}
            None => faults.push(format!("{} is lost: {key:?}", report.state)),
            Some(_) if report.state == "PARKED" => {
                faults.push(format!("rejected and yet held: {key:?}"))
            }
            Some(there) => {
                let differences = report.content.differences(&there.content);
                faults.extend(differences.into_iter().map(|what| format!("{key:?}: {what}")));
            }
        }
    }
    faults.extend(
        held.keys()
            .filter(|key| !left.contains_key(**key) && !stage.former.contains_key(**key))
            .map(|key| format!("never left: {key:?}")),
    );
    faults.extend(of_former(&stage.former, &left, &held));
    let toggled = load::toggled_request(factory);
    let reasons = given_up::Reasons {
        left: &left,
        toggled: &toggled,
        interruptions: (factory == HAMBURG).then_some(&stage.interruptions),
    };
    faults.extend(given_up::faults(&announced, [&given_up, &stage.former_given_up], &reasons));
    let held_gaps = announced.keys().filter(|key| held.contains_key(key));
    faults.extend(held_gaps.map(|key| format!("announced as given up, and is held: {key:?}")));
    faults.extend(holes(left.keys()));
    faults.extend(control::faults(folder, factory, &stage.lost_controls, taken).await?);
    faults.extend(disorder(&arrived, &stage.set_back));
    let recipients: usize = left.values().map(|report| report.recipients).sum();
    let entries = stores::ledger_entries(folder, factory).await?;
    if entries != recipients {
        faults.push(format!("{factory}: {entries} ledger entries for {recipients} disclosures"));
    }

    findings.faults.extend(faults);
    findings.given_up += announced.len();
    findings.left += left.len();
    findings.arrived += arrived.len();
    findings.replayed += arrived.iter().filter(|(_, report)| report.is_replay).count();
    Ok(())
}

/// Returns what of the reports of a replaced store is held otherwise, and which of their numbers the store in its place
/// has given again. What was still waiting in that store is lost with it.
fn of_former(
    former: &BTreeMap<ReportKey, Left>,
    left: &BTreeMap<ReportKey, Left>,
    held: &BTreeMap<&ReportKey, &stores::Arrived>,
) -> Vec<String> {
    let mut faults = Vec::new();
    for (key, report) in former {
        match (left.get(key), held.get(key)) {
            (Some(again), _) if !report.content.differences(&again.content).is_empty() => {
                faults.push(format!("an older store has given a number again: {key:?}"));
            }
            (None, Some(there)) => {
                let differences = report.content.differences(&there.content);
                faults.extend(differences.into_iter().map(|what| format!("{key:?}: {what}")));
            }
            _ => {}
        }
    }
    faults
}

/// Sequence numbers of a writer's epoch begin at zero and miss none.
fn holes<'k>(keys: impl Iterator<Item = &'k ReportKey>) -> Vec<String> {
    let mut writers: BTreeMap<(&str, i64, i64), BTreeSet<i64>> = BTreeMap::new();
    for key in keys {
        writers.entry((&key.factory, key.writer, key.epoch)).or_default().insert(key.sequence);
    }
    let mut faults = Vec::new();
    for (writer, sequences) in writers {
        let (first, last) =
            (sequences.first().copied().unwrap_or(0), sequences.last().copied().unwrap_or(-1));
        let count = i64::try_from(sequences.len()).unwrap_or(i64::MAX);
        if first != 0 || count != last + 1 {
            faults.push(format!("{writer:?}: {count} sequence numbers from {first} to {last}"));
        }
    }
    faults
}

/// Within each lane a writer's reports arrive in their order, but for those that the broker lost.
fn disorder(
    arrived: &[(ReportKey, stores::Arrived)],
    set_back: &BTreeSet<ReportKey>,
) -> Vec<String> {
    let mut newest: BTreeMap<(i64, i64, bool), i64> = BTreeMap::new();
    let mut faults = Vec::new();
    for (key, report) in arrived.iter().filter(|(key, _)| !set_back.contains(key)) {
        let newest = newest.entry((key.writer, key.epoch, report.is_replay)).or_insert(0);
        if key.sequence < *newest {
            let lane = if report.is_replay { "replay" } else { "live" };
            faults.push(format!("{key:?} came after {newest} in the {lane} lane"));
        }
        *newest = key.sequence.max(*newest);
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chaos::{content::Content, stores::Arrived};

    fn key(sequence: i64) -> ReportKey {
        ReportKey { factory: "F".into(), writer: 1, epoch: 1, sequence }
    }

    #[test]
    fn all_faults_of_a_run_are_listed_and_the_first_ones_shown() {
        let faults = (0..SHOWN_MAX + 5).map(|number| format!("fault {number}\nand why")).collect();
        let error = breach(faults).context("a step of the run");
        let breach = error.downcast_ref::<Breach>().expect("faults");
        assert_eq!(breach.lines().lines().count(), SHOWN_MAX + 5);
        assert!(breach.lines().ends_with("fault 24 and why\n"));
        let shown = breach.to_string();
        assert!(shown.starts_with("25 faults:\n  fault 0\n"), "{shown}");
        assert!(shown.contains("fault 19") && !shown.contains("fault 20"), "{shown}");
    }

    #[test]
    fn what_was_noticed_before_a_run_broke_off_is_among_its_faults() {
        let mut error = breach(vec!["no reports".to_owned()]).context("a step of the run");
        let faults = ["no reports", "a program ended"].map(str::to_owned);
        error.downcast_mut::<Breach>().expect("faults").add(&faults);
        let lines = error.downcast_ref::<Breach>().expect("faults").lines();
        assert_eq!(lines, "no reports\na program ended\n");
    }

    #[test]
    fn a_hole_and_a_late_start_are_seen() {
        let all: Vec<_> = [0, 1, 2].map(key).to_vec();
        assert!(holes(all.iter()).is_empty());
        assert_eq!(holes(all[1..].iter()).len(), 1);
        let with_hole = [all[0].clone(), all[2].clone()];
        assert_eq!(holes(with_hole.iter()).len(), 1);
    }

    #[test]
    fn an_older_store_gives_no_number_again() {
        let content = |request: &str| Content { request: request.to_owned(), ..Content::default() };
        let left = |request: &str| Left {
            id: 1,
            state: "DONE".to_owned(),
            recipients: 1,
            content: content(request),
        };
        let arrived = stores::Arrived { is_replay: false, content: content("r") };
        let number = key(1);
        let former = BTreeMap::from([(number.clone(), left("r"))]);
        let held = BTreeMap::from([(&number, &arrived)]);
        let again = |request: &str| BTreeMap::from([(key(1), left(request))]);
        assert_eq!(of_former(&former, &again("r"), &held), [""; 0], "the copy had it");
        assert_eq!(of_former(&former, &again("other"), &held).len(), 1, "another one");
        assert_eq!(of_former(&former, &BTreeMap::new(), &held), [""; 0], "it had left");
        assert_eq!(of_former(&former, &BTreeMap::new(), &BTreeMap::new()), [""; 0], "lost with it");
        let other = stores::Arrived { is_replay: false, content: content("other") };
        let held = BTreeMap::from([(&number, &other)]);
        assert_eq!(of_former(&former, &BTreeMap::new(), &held).len(), 1, "held otherwise");
    }

    #[test]
    fn disorder_is_seen_per_lane_unless_the_broker_lost_it() {
        let content = Content { request: "r".to_owned(), ..Content::default() };
        let came =
            |sequence, is_replay| (key(sequence), Arrived { is_replay, content: content.clone() });
        let arrived =
            [came(1, false), came(5, false), came(2, true), came(3, true), came(6, false)];
        assert!(disorder(&arrived, &BTreeSet::new()).is_empty());
        let arrived = [came(2, false), came(1, false)];
        assert_eq!(disorder(&arrived, &BTreeSet::new()).len(), 1);
        assert!(disorder(&arrived, &BTreeSet::from([key(1)])).is_empty());
    }
}
