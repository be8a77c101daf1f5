//! Former disclosures: what was disclosed of fields until their consents ended. A partner that asks
//! for the same in another form gets neither a fresh interval nor room under a cap by it.

use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    sync::Arc,
    time::Duration,
};

use asi_model::{DateTime, FieldKey, OrganisationId, network::Semantic};
use disclosure::{DisclosurePolicy, FieldUse, FormerUse, VariableKey};
use serde::{Deserialize, Serialize};

use crate::{operator::OperationKey, writes::FormerDisclosureRow};

/// Shortest time for which a former disclosure is kept: sums under caps are per hour.
pub(crate) const HOUR: Duration = Duration::from_secs(3_600);

/// Disclosure of a field until its consent ended.
#[derive(Debug, Clone, PartialEq)]
pub struct FormerDisclosure {
    pub(crate) key: FieldKey,
    pub(crate) semantic: Option<Semantic>,
    pub(crate) used: FieldUse,
    pub(crate) ended_at: DateTime,
}

/// Form in which a former disclosure is stored.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Document {
    field: i64,
    key: FieldKey,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    semantic: Option<Semantic>,
    policy: DisclosurePolicy,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    bits_per_hour: Option<f64>,
    reader_list: Vec<OrganisationId>,
    variable_list: BTreeSet<VariableKey>,
}

impl FormerDisclosure {
    /// Returns true where it tells of the same as another one, whenever they ended.
    pub(crate) fn is_of_same(&self, other: &Self) -> bool {
        self.key == other.key && self.semantic == other.semantic && self.used == other.used
    }

    fn row(&self, id: i64) -> FormerDisclosureRow {
        let FieldUse { field, policy, bits_per_hour, readers, variables } = self.used.clone();
        let document = Document {
            field,
            key: self.key.clone(),
            semantic: self.semantic.clone(),
            policy: (*policy).clone(),
            bits_per_hour,
            reader_list: readers,
            variable_list: variables,
        };
        let document =
            serde_json::to_string(&document).expect("documents have text keys and finite numbers");
        FormerDisclosureRow { id, ended_at: self.ended_at, document }
    }

    fn read(row: &FormerDisclosureRow) -> serde_json::Result<Self> {
        let Document {
            field,
            key,
            semantic,
            policy,
            bits_per_hour,
            reader_list: readers,
            variable_list: variables,
        } = serde_json::from_str(&row.document)?;
        let policy = Arc::new(policy);
        let used = FieldUse { field, policy, bits_per_hour, readers, variables };
        Ok(Self { key, semantic, used, ended_at: row.ended_at })
    }
}

/// Owner of the former disclosures, found by operation, by variable and by time.
#[derive(Debug, Default)]
pub struct FormerDisclosureRegistry {
    all: BTreeMap<i64, FormerDisclosure>,
    by_end: BTreeSet<(DateTime, i64)>,
    by_operation: HashMap<OperationKey, BTreeSet<i64>>,
    by_variable: HashMap<VariableKey, BTreeSet<i64>>,
    last_id: i64,
}

impl FormerDisclosureRegistry {
    /// Reads what was stored. What ended later than now ended by a clock that was set back.
    ///
    /// # Errors
    /// Text that is no former disclosure.
    pub(crate) fn load(rows: &[FormerDisclosureRow], now: DateTime) -> serde_json::Result<Self> {
        let mut registry = Self::default();
        for row in rows {
            registry.insert(row.id, FormerDisclosure::read(row)?);
        }
        registry.set_clock_back(now);
        Ok(registry)
    }

    /// Returns the greatest number of a field of which something ended. Until that is forgotten no
    /// other field may get its number.
    pub(crate) fn last_field(&self) -> i64 {
        self.all.values().map(|former| former.used.field).max().unwrap_or_default()
    }

    /// Notes what ended, and returns its row. Where the same ended before, the later time counts.
    pub(crate) fn note(&mut self, former: FormerDisclosure) -> FormerDisclosureRow {
        let known = self.by_operation.get(&OperationKey::of(&former.key)).into_iter().flatten();
        let known = known.copied().find(|id| self.all[id].is_of_same(&former));
        let id = known.unwrap_or(self.last_id + 1);
        self.remove(id);
        let row = former.row(id);
        self.insert(id, former);
        row
    }

    /// Forgets what ended longer ago than this, and returns the numbers of the rows.
    pub(crate) fn forget(&mut self, period: Duration, now: DateTime) -> Vec<i64> {
        let old = self.by_end.iter().take_while(|(ended_at, _)| ended_at.after(period) <= now);
        let old: Vec<i64> = old.map(|(_, id)| *id).collect();
        old.iter().for_each(|id| self.remove(*id));
        old
    }

    /// Follows the machine's clock where it was set back to `now`.
    pub(crate) fn set_clock_back(&mut self, now: DateTime) {
        while let Some(&(ended_at, id)) = self.by_end.last().filter(|(at, _)| *at > now) {
            self.by_end.remove(&(ended_at, id));
            self.by_end.insert((now, id));
            if let Some(former) = self.all.get_mut(&id) {
                former.ended_at = now;
            }
        }
    }

    /// Returns the uses that ended within the last hour.
    pub(crate) fn uses_of_last_hour(&self, now: DateTime) -> impl Iterator<Item = FormerUse> {
        let ended = self.by_end.iter().rev();
        let recent = ended.take_while(move |(ended_at, _)| ended_at.after(HOUR) > now);
        let found = recent.filter_map(|(_, id)| self.all.get(id));
        found.map(|former| FormerUse { used: former.used.clone(), ended_at: former.ended_at })
    }

    /// Returns what ended of fields of an operation.
    pub(crate) fn of_operation<'r>(
        &'r self,
        operation: &OperationKey,
    ) -> impl Iterator<Item = &'r FormerDisclosure> + use<'r> {
        let ids = self.by_operation.get(operation).into_iter().flatten();
        ids.filter_map(|id| self.all.get(id))
    }

    /// Returns what ended of fields that rested on a variable.
    pub(crate) fn of_variable(
        &self,
        variable: &VariableKey,
    ) -> impl Iterator<Item = &FormerDisclosure> {
        let ids = self.by_variable.get(variable).into_iter().flatten();
        ids.filter_map(|id| self.all.get(id))
    }

    fn insert(&mut self, id: i64, former: FormerDisclosure) {
        self.last_id = self.last_id.max(id);
        self.by_end.insert((former.ended_at, id));
        self.by_operation.entry(OperationKey::of(&former.key)).or_default().insert(id);
        for variable in &former.used.variables {
            self.by_variable.entry(variable.clone()).or_default().insert(id);
        }
        self.all.insert(id, former);
    }

    fn remove(&mut self, id: i64) {
        let Some(former) = self.all.remove(&id) else { return };
        self.by_end.remove(&(former.ended_at, id));
        let operation = OperationKey::of(&former.key);
        if let Some(ids) = self.by_operation.get_mut(&operation) {
            ids.remove(&id);
            if ids.is_empty() {
                self.by_operation.remove(&operation);
            }
        }
        for variable in &former.used.variables {
            let Some(ids) = self.by_variable.get_mut(variable) else { continue };
            ids.remove(&id);
            if ids.is_empty() {
                self.by_variable.remove(variable);
            }
        }
    }
}
