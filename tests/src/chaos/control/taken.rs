//! Changes that the programs answered as taken: each has to be stored in the end, or one that came after it.

use std::collections::{BTreeMap, BTreeSet};

use crate::chaos::stores::control::{Controls, FieldId, Toggled};

/// Changes that the programs answered as taken.
#[derive(Debug, Default)]
pub(in crate::chaos) struct Taken {
    decisions: u64,
    revisions: u64,
    /// Reasons of the refusals, by factory and field.
    refusals: BTreeMap<(&'static str, FieldId), String>,
    /// Factory and id of each.
    revocations: BTreeSet<(&'static str, String)>,
    /// Revision and number of the change of the network that was taken last.
    last_revision: Option<(i64, u64)>,
    /// States that a factory's toggled field may have: the last one that was taken, or one that was asked for since
    /// without an answer.
    toggles: BTreeMap<&'static str, Vec<Toggled>>,
}

impl Taken {
    /// Adds a decision about the toggled field of a factory.
    pub(super) fn toggled(&mut self, factory: &'static str, to: Toggled, is_taken: bool) {
        if is_taken {
            self.toggles.insert(factory, vec![to]);
            self.decisions += u64::from(to != Toggled::Closed);
        } else if let Some(possible) = self.toggles.get_mut(factory) {
            possible.push(to);
        }
    }

    /// Adds the revocation of the toggled field of a factory; without an id it was not answered.
    pub(super) fn revoked(&mut self, factory: &'static str, id: Option<&str>) {
        self.toggled(factory, Toggled::Closed, id.is_some());
        self.revocations.extend(id.map(|id| (factory, id.to_owned())));
    }

    /// Adds a refusal.
    pub(super) fn refused(&mut self, factory: &'static str, field: FieldId, reason: String) {
        self.refusals.insert((factory, field), reason);
    }

    /// Adds a revision of the network, by the number of its change.
    pub(super) fn revised(&mut self, revision: i64, number: u64) {
        self.revisions += 1;
        self.last_revision = Some((revision, number));
    }

    /// Adds what another person did.
    pub(super) fn add(&mut self, other: Self) {
        self.decisions += other.decisions;
        self.revisions += other.revisions;
        self.refusals.extend(other.refusals);
        self.revocations.extend(other.revocations);
        self.last_revision = self.last_revision.max(other.last_revision);
        self.toggles.extend(other.toggles);
    }

    /// Returns the numbers for people.
    ///
    /// # Errors
    /// When one of them is zero: then the run proves nothing about it.
    pub fn said(&self) -> anyhow::Result<String> {
        let Self { decisions, revisions, .. } = self;
        let (refusals, revocations) = (self.refusals.len(), self.revocations.len());
        let is_any = *decisions > 0 && refusals > 0 && revocations > 0 && *revisions > 0;
        anyhow::ensure!(is_any, "not all of decisions, refusals, revocations, revisions: {self:?}");
        Ok(format!(
            "; {decisions} decisions, {refusals} refusals, {revocations} revocations, {revisions} revisions"
        ))
    }

    /// Returns what a factory's connector or the platform answered as taken, and has not stored.
    pub(super) fn missing(&self, factory: &str, controls: &Controls) -> Vec<String> {
        let Controls { here, there, toggled } = controls;
        let of_factory = |whose: &str| whose == factory;
        let refusals = self.refusals.iter().filter(|((whose, _), _)| of_factory(whose));
        let refusals = refusals.filter_map(|((_, field), reason)| {
            let found = here.decisions.get(field);
            let is_same = found.and_then(|found| found.reason.as_ref()) == Some(reason);
            (!is_same).then(|| {
                format!(
                    "{factory}: {field:?} is decided otherwise than was taken: {reason}, {found:?}"
                )
            })
        });
        let revocations = self.revocations.iter().filter(|(whose, _)| of_factory(whose));
        let revocations = revocations.filter(|(_, id)| !here.revocations.contains(id));
        let revocations = revocations
            .map(|(_, id)| format!("{factory}: revocation {id} was taken, and is not stored"));
        let mut missing: Vec<String> = refusals.chain(revocations).collect();
        let possible = self.toggles.get(factory);
        if let Some(possible) = possible.filter(|possible| !possible.contains(toggled)) {
            missing.push(format!(
                "{factory}: the toggled field is {toggled:?}, and was taken as {possible:?}"
            ));
        }
        if let Some((revision, number)) = self.last_revision {
            let (stored, description) = &there.network;
            let is_stored = *stored >= revision
                && number_of(description).is_some_and(|stored| stored >= number);
            if !is_stored {
                missing.push(format!(
                    "{factory}: revision {revision} with change {number} was taken, the platform has {:?}",
                    there.network
                ));
            }
        }
        missing
    }
}

/// Words of a description before the number of its change.
const CHANGE: &str = "As of change ";

/// Returns the description of the network by a change.
pub(super) fn description(number: u64) -> String {
    CHANGE.to_owned() + &number.to_string()
}

/// Returns the number of the change that a description is of.
fn number_of(description: &str) -> Option<u64> {
    description.strip_prefix(CHANGE)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        chaos::stores::control::{Decided, Side},
        frame_order::{HAMBURG, MUNICH},
    };

    fn field(name: &str) -> FieldId {
        FieldId { request: "r".to_owned(), field: name.to_owned() }
    }

    fn side(reason: &str, revocation: &str, network: (i64, &str)) -> Side {
        let reason = Some(reason.to_owned());
        let decided = Decided { state: "REFUSED".to_owned(), reason, at: Some(1) };
        Side {
            decisions: BTreeMap::from([(field("f1"), decided)]),
            revocations: BTreeSet::from([revocation.to_owned()]),
            network: (network.0, network.1.to_owned()),
        }
    }

    /// Returns both sides with a refusal and a revocation.
    fn decided(reason: &str, revocation: &str) -> Controls {
        let side = || side(reason, revocation, (1, ""));
        Controls { here: side(), there: side(), toggled: Toggled::Closed }
    }

    #[test]
    fn what_was_taken_has_to_be_stored() {
        let mut taken = Taken::default();
        taken.refused(MUNICH, field("f1"), "Refusal 1".to_owned());
        taken.revoked(MUNICH, Some("one"));
        assert_eq!(taken.missing(MUNICH, &decided("Refusal 1", "one")), [""; 0]);
        assert_eq!(taken.missing(MUNICH, &decided("Refusal 0", "one")).len(), 1);
        assert_eq!(taken.missing(MUNICH, &decided("Refusal 1", "two")).len(), 1);
        assert_eq!(taken.missing(HAMBURG, &decided("Refusal 0", "two")), [""; 0]);
    }

    #[test]
    fn a_revision_that_was_taken_has_to_be_stored_though_both_sides_are_the_same() {
        let mut taken = Taken::default();
        taken.revised(8, 3);
        let found = |network| {
            let side = || side("", "", network);
            let controls = Controls { here: side(), there: side(), toggled: Toggled::Closed };
            taken.missing(MUNICH, &controls).len()
        };
        assert_eq!(found((8, "As of change 3")), 0);
        assert_eq!(found((9, "As of change 4")), 0, "a later one came without an answer");
        assert_eq!(found((7, "As of change 2")), 1);
        assert_eq!(found((7, "As of change 3")), 1, "its number is that of a former one");
        assert_eq!(found((8, "As of change 2")), 1, "its content is that of a former one");
        assert_eq!(found((8, "Frames")), 1, "nothing of it is there");
    }

    #[test]
    fn the_toggled_field_is_as_it_was_taken_last_or_asked_for_since() {
        let mut taken = Taken::default();
        let found = |taken: &Taken, toggled| {
            let controls = Controls { toggled, ..decided("", "one") };
            taken.missing(MUNICH, &controls).len()
        };
        let (open, rounded) = (Toggled::Open(None), Toggled::Open(Some(5.0)));
        taken.toggled(MUNICH, open, false);
        assert_eq!(found(&taken, Toggled::Closed), 0, "nothing was taken");
        taken.toggled(MUNICH, open, true);
        assert_eq!(found(&taken, open), 0);
        assert_eq!(found(&taken, rounded), 1);
        taken.toggled(MUNICH, rounded, false);
        assert_eq!([open, rounded].map(|toggled| found(&taken, toggled)), [0, 0]);
        assert_eq!(found(&taken, Toggled::Closed), 1);
        taken.revoked(MUNICH, Some("one"));
        assert_eq!([open, rounded].map(|toggled| found(&taken, toggled)), [1, 1]);
        assert_eq!(found(&taken, Toggled::Closed), 0);
    }
}
