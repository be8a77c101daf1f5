//! Texts that many mappings have in common are held once.

use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
};

use asi_model::{FieldKey, values::Namespace};
use mapping_engine::Mapping;
use shop_floor::SourceId;

use disclosure::DisclosurePolicy;

/// The sources and namespaces that mappings name - there are few of them, whatever comes and goes -
/// and the policies of fields.
#[derive(Debug, Default)]
pub(crate) struct Shared {
    sources: HashSet<SourceId>,
    namespaces: HashSet<Arc<str>>,
    /// By their JSON: many fields have the same, most of them none.
    policies: HashMap<String, Arc<DisclosurePolicy>>,
}

impl Shared {
    /// A mapping of a field that shares what it has in common with the field's key and with other
    /// mappings.
    pub fn share(&mut self, mapping: &mut Mapping, key: &FieldKey) {
        if mapping.target == *key {
            mapping.target = key.clone();
        }
        for input in &mut mapping.inputs {
            one_of(&mut self.sources, &mut input.source_id);
            if let Namespace::Uri(uri) = &mut input.node_id.namespace {
                one_of(&mut self.namespaces, uri);
            }
            input.name.shrink_to_fit();
        }
        mapping.inputs.shrink_to_fit();
        mapping.steps.shrink_to_fit();
    }

    /// A stored policy.
    pub fn policy(&mut self, json: String) -> serde_json::Result<Arc<DisclosurePolicy>> {
        if let Some(known) = self.policies.get(&json) {
            return Ok(Arc::clone(known));
        }
        let policy: Arc<DisclosurePolicy> = Arc::new(serde_json::from_str(&json)?);
        self.forget_unused();
        self.policies.insert(json, Arc::clone(&policy));
        Ok(policy)
    }

    /// The policy that holds for a field, given the field's own.
    pub fn one_policy(
        &mut self,
        effective: Arc<DisclosurePolicy>,
        own: &Arc<DisclosurePolicy>,
    ) -> Arc<DisclosurePolicy> {
        if effective == *own {
            return Arc::clone(own);
        }
        let json =
            serde_json::to_string(&*effective).expect("policies have text keys and finite numbers");
        self.forget_unused();
        Arc::clone(self.policies.entry(json).or_insert(effective))
    }

    /// Every figure that was ever typed would be a policy: those that no field has any more go
    /// before the table grows.
    fn forget_unused(&mut self) {
        if self.policies.len() == self.policies.capacity() {
            self.policies.retain(|_, policy| Arc::strong_count(policy) > 1);
            self.policies.reserve(self.policies.len() + 1);
        }
    }
}

fn one_of<T: std::hash::Hash + Eq + Clone>(known: &mut HashSet<T>, text: &mut T) {
    match known.get(text) {
        Some(known) => text.clone_from(known),
        None => drop(known.insert(text.clone())),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::books::tests::field;

    #[test]
    fn alike_policies_are_held_once_and_unused_ones_forgotten() {
        let mut shared = Shared::default();
        let used = shared.policy("{}".to_owned()).expect("a policy");
        assert!(Arc::ptr_eq(&used, &shared.policy("{}".to_owned()).expect("a policy")));
        for delay in 1..1000 {
            let policy = DisclosurePolicy { delay_ms: Some(delay), ..Default::default() };
            let held = shared.one_policy(Arc::new(policy.clone()), &used);
            assert_eq!(*held, policy);
        }
        assert!(shared.policies.len() < 100, "{}", shared.policies.len());
        assert!(
            Arc::ptr_eq(&used, &shared.policy("{}".to_owned()).expect("a policy")),
            "one in use stays"
        );
    }

    #[test]
    fn what_mappings_have_in_common_is_held_once() {
        let key = field("made");
        let mut shared = Shared::default();
        let mut mapping = |node: &str| {
            let json = json!({ "mappingId": node, "target": field("made"), "targetType": "UInt64",
                "inputs": [{ "name": "a", "sourceId": "press", "nodeId": format!("nsu=urn:press;s={node}") }] });
            let mut mapping: Mapping = serde_json::from_value(json).expect("a mapping");
            let before = mapping.clone();
            shared.share(&mut mapping, &key);
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
