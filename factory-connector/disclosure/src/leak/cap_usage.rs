//! Sums of information under caps: whether a change of what is disclosed stays within all of them.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use asi_model::{DateTime, OrganisationId};

use super::{
    alliance::{Alliance, readers},
    cap::{Cap, CapExcess},
    variable::VariableKey,
};
use crate::{DisclosurePolicy, DocumentId, Versioned};

/// Exactness of sums beside their size, in bits per hour.
const TOLERANCE: f64 = 1e-6;
/// Exactness of sums as a share of the cap: adding and subtracting many figures is not exact.
const TOLERANCE_SHARE: f64 = 1e-9;

/// A cap and who counts towards it.
#[derive(Debug, Clone, PartialEq)]
pub struct CapInForce {
    pub cap: Versioned<Cap>,
    /// The organisations whose information counts together.
    pub readers: BTreeSet<OrganisationId>,
}

impl CapInForce {
    /// Returns a cap with those whom it counts together, unless it is retired.
    #[must_use]
    pub fn new<'a>(
        cap: &Versioned<Cap>,
        alliances: impl Iterator<Item = &'a Versioned<Alliance>>,
    ) -> Option<Self> {
        let readers = readers(&cap.document.subject, alliances);
        (!cap.document.is_retired).then(|| Self { cap: cap.clone(), readers })
    }

    fn covers(&self, used: &FieldUse) -> bool {
        let is_read = used.readers.iter().any(|reader| self.readers.contains(reader));
        is_read
            && self.cap.document.variable.as_ref().is_none_or(|own| used.variables.contains(own))
    }

    /// Returns what the cap counts of one field, of its use and its former ones: those that no other
    /// one implies. A cap counts from the time on at which it was set.
    fn sum_of_field(&self, used: Option<&FieldUse>, former: &[FormerUse]) -> BitSum {
        let former = former.iter().filter(|former| former.ended_at > self.cap.changed_at);
        let all = former.map(|former| &former.used).chain(used);
        let covered: Vec<&FieldUse> = all.filter(|used| self.covers(used)).collect();
        let mut sum = BitSum::default();
        for (index, used) in covered.iter().enumerate() {
            let is_implied = covered.iter().enumerate().any(|(other_index, other)| {
                other_index != index
                    && other.implies(used)
                    && (other_index < index || !used.implies(other))
            });
            if !is_implied {
                sum.add(used.bits_per_hour);
            }
        }
        sum
    }

    fn is_exceeded_by(&self, sum: BitSum) -> bool {
        let most = self.cap.document.bits_per_hour_max;
        sum.bits().is_none_or(|bits| bits > most + TOLERANCE + most * TOLERANCE_SHARE)
    }
}

/// Information of one field, as caps count it.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldUse {
    /// Number of the field. A field that is requested again has another one, and another gate.
    pub field: i64,
    /// The policy in force.
    pub policy: Arc<DisclosurePolicy>,
    /// Most bits per hour; none without a bound.
    pub bits_per_hour: Option<f64>,
    /// The organisations that get the field's values.
    pub readers: Vec<OrganisationId>,
    /// The variables that the field rests on.
    pub variables: BTreeSet<VariableKey>,
}

impl FieldUse {
    /// Returns true where everything that another use of the same gate lets out satisfies this
    /// one, too: both together tell no more than this one, for intervals and rates of a gate go on
    /// from consent to consent.
    fn implies(&self, other: &Self) -> bool {
        let has_bits = match (self.bits_per_hour, other.bits_per_hour) {
            (None, _) => true,
            (Some(_), None) => false,
            (Some(bits), Some(others)) => bits >= others,
        };
        has_bits && self.policy.allows_all_of(&other.policy)
    }
}

/// Information of one field until its consent ended.
#[derive(Debug, Clone, PartialEq)]
pub struct FormerUse {
    pub used: FieldUse,
    pub ended_at: DateTime,
}

/// The information of one field before and after a change; none while it is not disclosed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Exchange {
    pub before: Option<FieldUse>,
    pub after: Option<FieldUse>,
}

/// A sum of bits per hour, of which some terms may have no bound.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BitSum {
    bounded: f64,
    unbounded: usize,
}

impl BitSum {
    /// Returns the sum; `None` where a term has no bound.
    #[must_use]
    pub fn bits(self) -> Option<f64> {
        (self.unbounded == 0).then_some(self.bounded)
    }

    const fn add(&mut self, bits: Option<f64>) {
        match bits {
            Some(bits) => self.bounded += bits,
            None => self.unbounded += 1,
        }
    }

    const fn add_sum(&mut self, other: Self) {
        self.bounded += other.bounded;
        self.unbounded += other.unbounded;
    }

    const fn subtract_sum(&mut self, other: Self) {
        self.bounded = (self.bounded - other.bounded).max(0.0);
        self.unbounded = self.unbounded.saturating_sub(other.unbounded);
    }

    fn is_above(self, other: Self) -> bool {
        self.unbounded > other.unbounded
            || (self.unbounded == other.unbounded && self.bounded > other.bounded + TOLERANCE)
    }
}

/// Sums under a cap.
#[derive(Debug, Clone)]
struct CapSums {
    cap: Arc<CapInForce>,
    /// Sum over the fields that are disclosed.
    open: BitSum,
    /// The same with the fields whose consents ended within the hour.
    hour: BitSum,
}

/// All caps in force, each with the sum of the fields that it covers: of those that are disclosed,
/// and of those that were within the hour.
#[derive(Debug, Clone, Default)]
pub struct CapUsage {
    sums: BTreeMap<DocumentId, CapSums>,
    /// Former uses by the number of the field.
    former: Arc<BTreeMap<i64, Vec<FormerUse>>>,
}

impl CapUsage {
    /// Begins with sums of nothing.
    #[must_use]
    pub fn new(caps: impl Iterator<Item = CapInForce>) -> Self {
        let entry = |cap: CapInForce| {
            let id = cap.cap.key.id.clone();
            let (open, hour) = (BitSum::default(), BitSum::default());
            (id, CapSums { cap: Arc::new(cap), open, hour })
        };
        Self { sums: caps.map(entry).collect(), former: Arc::default() }
    }

    /// Begins with consents that ended within the hour. They count beside what is disclosed, but
    /// where the same field is disclosed again and tells no more than before.
    #[must_use]
    pub fn after(mut self, former: impl Iterator<Item = FormerUse>) -> Self {
        let mut by_field: BTreeMap<i64, Vec<FormerUse>> = BTreeMap::new();
        former.for_each(|former| by_field.entry(former.used.field).or_default().push(former));
        for sums in self.sums.values_mut() {
            for former in by_field.values() {
                sums.hour.add_sum(sums.cap.sum_of_field(None, former));
            }
        }
        Self { former: Arc::new(by_field), ..self }
    }

    /// Returns true where no cap is in force.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.sums.is_empty()
    }

    /// Returns the organisations of all caps.
    #[must_use]
    pub fn readers(&self) -> BTreeSet<&OrganisationId> {
        self.sums.values().flat_map(|sums| &sums.cap.readers).collect()
    }

    /// Returns the sum of what is disclosed under a cap; `None` where it is not in force.
    #[must_use]
    pub fn sum(&self, cap: &DocumentId) -> Option<BitSum> {
        self.sums.get(cap).map(|sums| sums.open)
    }

    /// Adds a field that is disclosed already.
    pub fn add(&mut self, used: &FieldUse) {
        self.make(&Exchange { before: None, after: Some(used.clone()) });
    }

    /// Makes changes together, where they raise no sum above its cap. A change that lowers a sum is
    /// always made.
    ///
    /// # Errors
    /// All caps that the changes would exceed; then nothing is changed.
    pub fn exchange(&mut self, changes: &[Exchange]) -> Result<(), Vec<CapExcess>> {
        let mut after = self.clone();
        changes.iter().for_each(|change| after.make(change));
        let excesses = after.excesses_over(self);
        if excesses.is_empty() {
            *self = after;
            Ok(())
        } else {
            Err(excesses)
        }
    }

    fn make(&mut self, change: &Exchange) {
        let Exchange { before, after } = change;
        let field = before.as_ref().or(after.as_ref()).map(|used| used.field);
        let former = field.and_then(|field| self.former.get(&field));
        let former = former.map(Vec::as_slice).unwrap_or_default();
        for CapSums { cap, open, hour } in self.sums.values_mut() {
            hour.subtract_sum(cap.sum_of_field(before.as_ref(), former));
            hour.add_sum(cap.sum_of_field(after.as_ref(), former));
            open.subtract_sum(cap.sum_of_field(before.as_ref(), &[]));
            open.add_sum(cap.sum_of_field(after.as_ref(), &[]));
        }
    }

    /// Returns the caps that are exceeded here, and by more than in `before`.
    #[must_use]
    pub fn excesses_over(&self, before: &Self) -> Vec<CapExcess> {
        let excess = |(id, CapSums { cap, open, hour }): (&DocumentId, &CapSums)| {
            let former = before.sums.get(id);
            let (open_before, hour_before) =
                former.map(|sums| (sums.open, sums.hour)).unwrap_or_default();
            let mut sums = [(open_before, *open), (hour_before, *hour)].into_iter();
            let (now, then) =
                sums.find(|(now, then)| cap.is_exceeded_by(*then) && then.is_above(*now))?;
            Some(CapExcess {
                cap: cap.cap.key.clone(),
                name: cap.cap.document.name.clone(),
                variable: cap.cap.document.variable.clone(),
                bits_per_hour_max: cap.cap.document.bits_per_hour_max,
                bits_per_hour_now: now.bits(),
                bits_per_hour_then: then.bits(),
            })
        };
        self.sums.iter().filter_map(excess).collect()
    }
}

#[cfg(test)]
mod tests;
