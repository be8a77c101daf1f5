//! Contents of withheld values: which values they are, without the values.

use std::collections::{BTreeMap, BTreeSet};

use asi_model::{DateTime, FactoryId, RequestKey};

/// Values of one request of one factory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Contents {
    /// The factory that reported the values.
    pub factory_id: FactoryId,
    /// The request that they answer.
    pub request: RequestKey,
    /// Names of their fields.
    pub fields: BTreeSet<String>,
    /// Earliest and latest time of a value; absent where none has a time.
    pub span: Option<(DateTime, DateTime)>,
    pub value_count: u64,
}

/// Answer or message that has values of factories.
pub trait Values {
    /// Returns which values it has; nothing where it has none.
    fn contents(&self) -> Vec<Contents>;
}

impl Contents {
    /// Gathers single values: factory, request, name of the field, time of the value.
    #[must_use]
    pub fn gather<'v>(
        values: impl IntoIterator<Item = (&'v FactoryId, &'v RequestKey, &'v str, Option<DateTime>)>,
    ) -> Vec<Self> {
        let mut gathered: BTreeMap<(&FactoryId, &RequestKey), Self> = BTreeMap::new();
        for (factory, request, field, at) in values {
            let contents = gathered.entry((factory, request)).or_insert_with(|| Self {
                factory_id: factory.clone(),
                request: request.clone(),
                fields: BTreeSet::new(),
                span: None,
                value_count: 0,
            });
            if !contents.fields.contains(field) {
                contents.fields.insert(field.to_owned());
            }
            contents.span = joined(contents.span, at.map(|at| (at, at)));
            contents.value_count += 1;
        }
        gathered.into_values().collect()
    }

    /// Adds values of the same request and factory.
    pub fn add(&mut self, other: &Self) {
        self.fields.extend(other.fields.iter().cloned());
        self.span = joined(self.span, other.span);
        self.value_count += other.value_count;
    }
}

fn joined(
    one: Option<(DateTime, DateTime)>,
    other: Option<(DateTime, DateTime)>,
) -> Option<(DateTime, DateTime)> {
    match (one, other) {
        (Some((from, to)), Some((other_from, other_to))) => {
            Some((from.min(other_from), to.max(other_to)))
        }
        (one, other) => one.or(other),
    }
}
