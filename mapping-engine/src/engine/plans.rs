//! Plans that mappings share.
//!
//! A plan says nothing about whose values enter it: series of like machines have one plan together,
//! which is in the processor's cache when the next of them has a value, and takes memory once.

use mapping::{Mapping, transform::Plan};
use std::{
    hash::{DefaultHasher, Hash as _, Hasher as _},
    sync::{Arc, Weak},
};

use hashbrown::HashTable;

/// The plans in use.
#[derive(Debug, Default)]
pub(super) struct Plans {
    /// By the hash of what they were made of.
    known: HashTable<(u64, Weak<Plan>)>,
}

impl Plans {
    /// The plan of a mapping: that of another one with the same functions, where there is one.
    pub fn shared(&mut self, mapping: &Mapping, plan: Arc<Plan>) -> Arc<Plan> {
        let made_of = made_of(mapping);
        let hash = hash_of(&made_of);
        let is_it = |(known_hash, known): &(u64, Weak<Plan>)| {
            *known_hash == hash
                && known.upgrade().is_some_and(|plan| self::made_of(&plan.made_for) == made_of)
        };
        if let Some(known) = self.known.find(hash, is_it).and_then(|(_, known)| known.upgrade()) {
            return known;
        }
        if self.known.len() == self.known.capacity() {
            self.known.retain(|(_, known)| known.strong_count() > 0);
            // Twice what is alive, so that this is not done again before as many have come.
            self.known.reserve(self.known.len() + 1, |(hash, _)| *hash);
        }
        self.known.insert_unique(hash, (hash, Arc::downgrade(&plan)), |(hash, _)| *hash);
        plan
    }
}

/// All of a mapping but whose values it takes and for which field. As text, in which 1 and 1.0
/// differ: they are equal numbers, but one makes integers and the other does not.
fn made_of(mapping: &Mapping) -> String {
    let Mapping { target_type, target_unit, target_value_rank, steps, late_values, .. } = mapping;
    let inputs = mapping
        .inputs
        .iter()
        .map(|input| (&input.name, input.value_type, &input.unit, input.triggers));
    let parts = (
        target_type,
        target_unit,
        target_value_rank,
        steps,
        late_values,
        inputs.collect::<Vec<_>>(),
    );
    serde_json::to_string(&parts).expect("mappings have text keys and finite numbers")
}

fn hash_of(text: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use mapping::transform::compile;

    fn mapping(field: &str, node: &str, factor: impl Into<serde_json::Value>) -> Arc<Mapping> {
        let factor = factor.into();
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
        assert!(!Arc::ptr_eq(&one, &shared(&mapping("one", "One", 1))));
        let (whole, real) =
            (shared(&mapping("one", "One", 2)), shared(&mapping("one", "One", 2.0)));
        assert_eq!(
            (whole.made_for.steps == real.made_for.steps, Arc::ptr_eq(&whole, &real)),
            (true, false)
        );
        let mut whole = mapping("one", "One", 0.1);
        Arc::make_mut(&mut whole).target_type =
            serde_json::from_value(json!("Int32")).expect("a type");
        assert!(!Arc::ptr_eq(&one, &shared(&whole)), "another field's type");
    }

    #[test]
    fn plans_that_nobody_uses_are_forgotten() {
        let mut plans = Plans::default();
        for factor in 1..1000_i32 {
            let mapping = mapping("one", "One", factor);
            drop(plans.shared(&mapping, Arc::new(compile(&mapping).0.expect("compiles"))));
        }
        assert!(plans.known.len() < 100, "{}", plans.known.len());
    }
}
