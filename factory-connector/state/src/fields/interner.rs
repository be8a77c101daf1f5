//! Interning: texts and policies that many fields have in common are stored once in memory.

use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
};

use asi_model::{FieldKey, values::Namespace};
use disclosure::DisclosurePolicy;
use mapping::Mapping;
use shop_floor_model::SourceId;

/// Interned sources, namespaces and policies. Sources and namespaces are few, so they are never
/// forgotten.
#[derive(Debug, Default)]
pub(super) struct Interner {
    sources: HashSet<SourceId>,
    namespaces: HashSet<Arc<str>>,
    /// Policies by their JSON text; most fields have the default one.
    policies: HashMap<String, Arc<DisclosurePolicy>>,
}

impl Interner {
    /// Replaces the parts of a field's mapping that the field's key or another mapping has, too.
    pub(super) fn share_mapping(&mut self, mapping: &mut Mapping, key: &FieldKey) {
        if mapping.target == *key {
            mapping.target = key.clone();
        }
        for input in &mut mapping.inputs {
            intern(&mut self.sources, &mut input.source_id);
            if let Namespace::Uri(uri) = &mut input.node_id.namespace {
                intern(&mut self.namespaces, uri);
            }
            input.name.shrink_to_fit();
        }
        mapping.inputs.shrink_to_fit();
        mapping.steps.shrink_to_fit();
    }

    /// Parses a stored policy; equal texts yield the same policy.
    pub(super) fn parse_policy(
        &mut self,
        json: String,
    ) -> serde_json::Result<Arc<DisclosurePolicy>> {
        if let Some(known) = self.policies.get(&json) {
            return Ok(Arc::clone(known));
        }
        let policy: Arc<DisclosurePolicy> = Arc::new(serde_json::from_str(&json)?);
        self.forget_unused();
        self.policies.insert(json, Arc::clone(&policy));
        Ok(policy)
    }

    /// Returns an equal policy that other fields use already; `own` is the field's own policy.
    pub(super) fn share_policy(
        &mut self,
        policy: Arc<DisclosurePolicy>,
        own: &Arc<DisclosurePolicy>,
    ) -> Arc<DisclosurePolicy> {
        if policy == *own {
            return Arc::clone(own);
        }
        let json =
            serde_json::to_string(&*policy).expect("policies have text keys and finite numbers");
        self.forget_unused();
        Arc::clone(self.policies.entry(json).or_insert(policy))
    }

    /// Forgets policies that no field has any more before the table grows: every figure that was
    /// ever typed would stay otherwise.
    fn forget_unused(&mut self) {
        if self.policies.len() == self.policies.capacity() {
            self.policies.retain(|_, policy| Arc::strong_count(policy) > 1);
            self.policies.reserve(self.policies.len() + 1);
        }
    }
}

fn intern<T: std::hash::Hash + Eq + Clone>(known: &mut HashSet<T>, text: &mut T) {
    match known.get(text) {
        Some(known) => text.clone_from(known),
        None => drop(known.insert(text.clone())),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::scene::field;

    #[test]
    fn equal_policies_are_stored_once_and_unused_ones_forgotten() {
        let mut interner = Interner::default();
        let own = Arc::new(DisclosurePolicy::default());
        let with_delay = |delay| {
            Arc::new(DisclosurePolicy { delay_ms: Some(delay), ..DisclosurePolicy::default() })
        };
        let used = interner.share_policy(with_delay(0), &own);
        for delay in 1..1000 {
            let shared = interner.share_policy(with_delay(delay), &own);
            assert_eq!(shared, with_delay(delay));
        }
        assert!(interner.policies.len() < 100, "{}", interner.policies.len());
        let again = interner.share_policy(with_delay(0), &own);
        assert!(Arc::ptr_eq(&used, &again), "a policy in use stays");
    }

    #[test]
    fn common_parts_of_mappings_are_stored_once() {
        let key = field("made");
        let mut interner = Interner::default();
        let mut mapping = |node: &str| {
            let json = json!({ "mappingId": node, "target": field("made"), "targetType": "UInt64",
                "inputs": [{ "name": "a", "sourceId": "press", "nodeId": format!("nsu=urn:press;s={node}") }] });
            let mut mapping: Mapping = serde_json::from_value(json).expect("a mapping");
            let before = mapping.clone();
            interner.share_mapping(&mut mapping, &key);
            assert_eq!(mapping, before);
            mapping
        };
        let (one, other) = (mapping("One"), mapping("Other"));
        assert!(std::ptr::eq(one.target.field_name.as_str(), key.field_name.as_str()));
        let (one, other) = (&one.inputs[0], &other.inputs[0]);
        assert!(std::ptr::eq(one.source_id.as_str(), other.source_id.as_str()));
        match (&one.node_id.namespace, &other.node_id.namespace) {
            (Namespace::Uri(one), Namespace::Uri(other)) => assert!(Arc::ptr_eq(one, other)),
            found => panic!("{found:?}"),
        }
    }
}
