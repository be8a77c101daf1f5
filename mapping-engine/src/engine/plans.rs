//! Plans that mappings share.
//!
//! A plan says nothing about whose values enter it: series of like machines have one plan together, which is in the
//! processor's cache when the next of them has a value, and takes memory once.

use std::{
    hash::{DefaultHasher, Hash as _, Hasher as _},
    sync::{Arc, Weak},
};

use hashbrown::HashTable;

use crate::{mapping::Mapping, transform::Plan};

/// The plans in use.
#[derive(Debug, Default)]
pub(super) struct Plans {
    /// By the hash of what they were made of.
    known: HashTable<(u64, Weak<Plan>)>,
}

impl Plans {
    /// The plan of a mapping: that of another one with the same functions, where there is one.
    pub fn shared(&mut self, mapping: &Mapping, plan: Arc<Plan>) -> Arc<Plan> {
        let hash = hash_of(mapping);
        let is_it =
            |(_, known): &(u64, Weak<Plan>)| known.upgrade().is_some_and(|plan| is_alike(&plan.made_for, mapping));
        if let Some(known) = self.known.find(hash, is_it).and_then(|(_, known)| known.upgrade()) {
            return known;
        }
        if self.known.len() == self.known.capacity() {
            self.known.retain(|(_, known)| known.strong_count() > 0);
        }
        self.known.insert_unique(hash, (hash, Arc::downgrade(&plan)), |(hash, _)| *hash);
        plan
    }
}

fn hash_of(mapping: &Mapping) -> u64 {
    let mut hasher = DefaultHasher::new();
    mapping.inputs.iter().for_each(|input| input.name.hash(&mut hasher));
    serde_json::to_string(&mapping.steps).unwrap_or_default().hash(&mut hasher);
    hasher.finish()
}

/// Whether two mappings differ at most in whose values they take and for which field.
fn is_alike(one: &Mapping, other: &Mapping) -> bool {
    one.target_type == other.target_type
        && one.target_unit == other.target_unit
        && one.target_value_rank == other.target_value_rank
        && one.late_values == other.late_values
        && one.steps == other.steps
        && one.inputs.len() == other.inputs.len()
        && one.inputs.iter().zip(&other.inputs).all(|(one, other)| {
            (&one.name, one.value_type, &one.unit, one.triggers)
                == (&other.name, other.value_type, &other.unit, other.triggers)
        })
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::transform::compile;

    fn mapping(field: &str, node: &str, factor: f64) -> Arc<Mapping> {
        let json = json!({ "mappingId": field, "targetType": "Double",
            "target": { "operationNetworkId": "n", "operationId": "o", "dynamicDataRequestId": "r", "fieldName": field },
            "inputs": [{ "name": "a", "sourceId": "press", "nodeId": format!("nsu=urn:press;s={node}") }],
            "steps": [{ "function": "scale", "factor": factor }] });
        Arc::new(serde_json::from_value(json).expect("a mapping"))
    }

    #[test]
    fn like_mappings_share_a_plan_and_others_do_not() {
        let mut plans = Plans::default();
        let mut shared = |mapping: &Arc<Mapping>| {
            let plan = compile(mapping).0.expect("compiles");
            plans.shared(mapping, Arc::new(plan))
        };
        let one = shared(&mapping("one", "One", 0.1));
        assert!(Arc::ptr_eq(&one, &shared(&mapping("other", "Other", 0.1))));
        assert!(!Arc::ptr_eq(&one, &shared(&mapping("one", "One", 0.2))), "another function");
        let mut whole = mapping("one", "One", 0.1);
        Arc::make_mut(&mut whole).target_type = serde_json::from_value(json!("Int32")).expect("a type");
        assert!(!Arc::ptr_eq(&one, &shared(&whole)), "another field's type");
    }

    #[test]
    fn plans_that_nobody_uses_are_forgotten() {
        let mut plans = Plans::default();
        for factor in 1..1000 {
            let mapping = mapping("one", "One", factor.into());
            drop(plans.shared(&mapping, Arc::new(compile(&mapping).0.expect("compiles"))));
        }
        assert!(plans.known.len() < 100, "{}", plans.known.len());
    }
}
