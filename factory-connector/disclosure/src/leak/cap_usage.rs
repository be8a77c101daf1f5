//! Sums of information under caps: whether a change of what is disclosed stays within all of them.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use asi_model::OrganisationId;

use super::{
    alliance::{Alliance, readers},
    cap::{Cap, CapExcess},
    variable::VariableKey,
};
use crate::{DocumentId, Versioned};

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

    fn is_exceeded_by(&self, sum: BitSum) -> bool {
        let most = self.cap.document.bits_per_hour_max;
        sum.bits().is_none_or(|bits| bits > most + TOLERANCE + most * TOLERANCE_SHARE)
    }
}

/// Information of one field, as caps count it.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldUse {
    /// Most bits per hour; none without a bound.
    pub bits_per_hour: Option<f64>,
    /// The organisations that get the field's values.
    pub readers: Vec<OrganisationId>,
    /// The variables that the field rests on.
    pub variables: BTreeSet<VariableKey>,
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

    const fn subtract(&mut self, bits: Option<f64>) {
        match bits {
            Some(bits) => self.bounded = (self.bounded - bits).max(0.0),
            None => self.unbounded = self.unbounded.saturating_sub(1),
        }
    }

    fn is_above(self, other: Self) -> bool {
        self.unbounded > other.unbounded
            || (self.unbounded == other.unbounded && self.bounded > other.bounded + TOLERANCE)
    }
}

/// All caps in force, each with the sum of the fields that it covers.
#[derive(Debug, Clone, Default)]
pub struct CapUsage(BTreeMap<DocumentId, (Arc<CapInForce>, BitSum)>);

impl CapUsage {
    /// Begins with sums of nothing.
    #[must_use]
    pub fn new(caps: impl Iterator<Item = CapInForce>) -> Self {
        let entry = |cap: CapInForce| (cap.cap.key.id.clone(), (Arc::new(cap), BitSum::default()));
        Self(caps.map(entry).collect())
    }

    /// Returns true where no cap is in force.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the organisations of all caps.
    #[must_use]
    pub fn readers(&self) -> BTreeSet<&OrganisationId> {
        self.0.values().flat_map(|(cap, _)| &cap.readers).collect()
    }

    /// Returns the sum under a cap; `None` where it is not in force.
    #[must_use]
    pub fn sum(&self, cap: &DocumentId) -> Option<BitSum> {
        self.0.get(cap).map(|(_, sum)| *sum)
    }

    /// Adds a field that is disclosed already.
    pub fn add(&mut self, used: &FieldUse) {
        for (_, sum) in self.0.values_mut().filter(|(cap, _)| cap.covers(used)) {
            sum.add(used.bits_per_hour);
        }
    }

    /// Makes changes together, where they raise no sum above its cap. A change that lowers a sum is
    /// always made.
    ///
    /// # Errors
    /// All caps that the changes would exceed; then nothing is changed.
    pub fn exchange(&mut self, changes: &[Exchange]) -> Result<(), Vec<CapExcess>> {
        let mut after = self.clone();
        for Exchange { before, after: now } in changes {
            for (cap, sum) in after.0.values_mut() {
                if let Some(used) = before.as_ref().filter(|used| cap.covers(used)) {
                    sum.subtract(used.bits_per_hour);
                }
                if let Some(used) = now.as_ref().filter(|used| cap.covers(used)) {
                    sum.add(used.bits_per_hour);
                }
            }
        }
        let excesses = after.excesses_over(self);
        if excesses.is_empty() {
            *self = after;
            Ok(())
        } else {
            Err(excesses)
        }
    }

    /// Returns the caps that are exceeded here, and by more than in `before`.
    #[must_use]
    pub fn excesses_over(&self, before: &Self) -> Vec<CapExcess> {
        let excess = |(id, (cap, sum)): (&DocumentId, &(Arc<CapInForce>, BitSum))| {
            let former = before.sum(id).unwrap_or_default();
            let is_excess = cap.is_exceeded_by(*sum) && sum.is_above(former);
            is_excess.then(|| CapExcess {
                cap: cap.cap.key.clone(),
                name: cap.cap.document.name.clone(),
                variable: cap.cap.document.variable.clone(),
                bits_per_hour_max: cap.cap.document.bits_per_hour_max,
                bits_per_hour_now: former.bits(),
                bits_per_hour_then: sum.bits(),
            })
        };
        self.0.iter().filter_map(excess).collect()
    }
}

#[cfg(test)]
mod tests;
