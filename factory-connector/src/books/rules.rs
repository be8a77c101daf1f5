//! Standing rules at work: what they would do, what they do, and undoing it.

use disclosure::DecisionBasis;
use std::sync::Arc;

use asi_model::{DateTime, FieldKey, OperationNetworkId, messages::ValueSource};
use mapping_engine::Mapping;

use super::{Books, ConnectorEvent, DecisionError, DocumentError, Verdict, policies::keep};
use crate::store::RuleDecisionRow;
use disclosure::{
    DisclosurePolicy, DocumentId, DocumentVersion, Rule, RuleAction, RuleFault, RuleOutcome,
    outcome,
};

/// Who is named as having decided, where rules did.
const DECIDED_BY: &str = "standing rule";

/// What rules would do with a field.
#[derive(Debug, Clone, PartialEq)]
pub struct RuleOffer {
    /// What they come to; `ACCEPT` without a known source of values becomes `PREFILL`.
    pub action: RuleAction,
    /// The rules, the one that gives reason and source first.
    pub rules: Vec<(DocumentVersion, String)>,
    /// The precision.
    pub disclosure: Arc<DisclosurePolicy>,
    /// The named policy of the rules, where they name one: when it becomes stricter, so does what
    /// was accepted. Where it becomes less strict, an engineer has to decide anew, for the consent
    /// was for the precision of then.
    pub policy_id: Option<DocumentId>,
    /// Where values would come from.
    pub value_source: Option<ValueSource>,
    /// The mapping, with the source `MAPPING`.
    pub mapping: Option<Mapping>,
    /// What the partner would be told.
    pub reason: Option<String>,
}

impl RuleOffer {
    /// The rules decide by themselves.
    #[must_use]
    pub fn decides(&self) -> bool {
        self.action != RuleAction::Prefill
    }
}

impl Books {
    /// Keeps a new version of a rule. It is applied to what comes; [`Self::apply_rules`] applies it
    /// to what is there.
    ///
    /// # Errors
    /// [`DocumentError`]; then nothing is changed.
    pub fn put_rule(
        &mut self,
        id: &DocumentId,
        rule: Rule,
        expected: Option<u32>,
        by: &str,
        now: DateTime,
    ) -> Result<DocumentVersion, DocumentError> {
        let mut faults = rule.faults();
        if let Some(policy_id) =
            rule.policy_id.as_ref().filter(|id| self.named_policy(id).is_none())
        {
            let message = format!("There is no policy {policy_id} that could be applied.");
            faults.push(RuleFault { pointer: "/policyId".to_owned(), message });
        }
        if !faults.is_empty() {
            return Err(DocumentError::Faults(faults));
        }
        let key = keep(&mut self.rules, &mut self.changes.rules, id, rule, expected, (by, now))?;
        self.aftermath.events.push(ConnectorEvent::Policies);
        Ok(key)
    }

    /// What the enabled rules say about a field, whatever was decided about it.
    #[must_use]
    pub fn rule_offer(&self, key: &FieldKey) -> Option<RuleOffer> {
        let enabled = self.rules.values().filter(|rule| rule.document.is_enabled);
        self.offer_of(key, enabled.map(|rule| (&rule.key, &rule.document)))
    }

    /// What one rule, enabled or not, says about the fields it means.
    #[must_use]
    pub fn rule_preview(&self, rule: &Rule) -> Vec<(FieldKey, RuleOffer)> {
        let key = DocumentVersion { id: "draft".parse().expect("an id"), version: 0 };
        let mut found: Vec<(FieldKey, RuleOffer)> = self
            .fields
            .iter()
            .map(|field| &field.key)
            .filter_map(|field| {
                Some((field.clone(), self.offer_of(field, std::iter::once((&key, rule)))?))
            })
            .collect();
        found.sort_by(|left, right| left.0.cmp(&right.0));
        found
    }

    fn offer_of<'r>(
        &self,
        key: &FieldKey,
        rules: impl Iterator<Item = (&'r DocumentVersion, &'r Rule)>,
    ) -> Option<RuleOffer> {
        let field = self.fields.get(key)?;
        let (_, request) = self.request(&key.request)?;
        let named = |id: &DocumentId| {
            self.named_policy(id).map(|policy| policy.document.disclosure.clone())
        };
        let found: RuleOutcome<'_, DocumentVersion> =
            outcome(rules, named, request, &field.definition)?;
        let (_, first) = found.rules.first()?;
        let value_source = first.value_source.filter(|_| found.action != RuleAction::Refuse);
        let mapping =
            if value_source == Some(ValueSource::Mapping) { self.mapping_for(key) } else { None };
        let is_sourceless = value_source == Some(ValueSource::Mapping) && mapping.is_none();
        let cannot_hold = !found
            .disclosure
            .faults(field.definition.field_type.0, field.definition.value_rank >= 0)
            .is_empty()
            || !self.withholding_faults(key, &found.disclosure).is_empty();
        let action = if found.action == RuleAction::Accept && (is_sourceless || cannot_hold) {
            RuleAction::Prefill
        } else {
            found.action
        };
        let mut named = found.rules.iter().filter_map(|(_, rule)| rule.policy_id.as_ref());
        let policy_id = named
            .next()
            .filter(|first| action != RuleAction::Refuse && named.all(|next| next == *first));
        Some(RuleOffer {
            action,
            policy_id: policy_id.cloned(),
            rules: found
                .rules
                .iter()
                .map(|(key, rule)| ((*key).clone(), rule.name.clone()))
                .collect(),
            disclosure: found.disclosure,
            value_source,
            mapping,
            reason: first.reason.clone().filter(|_| action == RuleAction::Refuse),
        })
    }

    /// The mapping that a field had, or that of an equal field of the same operation.
    fn mapping_for(&self, key: &FieldKey) -> Option<Mapping> {
        let field = self.fields.get(key)?;
        let definition = &field.definition;
        let is_alike = |mapping: &Mapping| {
            mapping.target_type.0 == definition.field_type.0
                && mapping.target_unit == definition.unit
                && mapping.target_value_rank == definition.value_rank
        };
        let own = field.decision.mapping.as_deref().filter(|mapping| is_alike(mapping));
        let equal = || {
            let (message, _) = self.request(&key.request)?;
            let mut operations = message.operation_network.operation_list.iter();
            let operation =
                operations.find(|operation| operation.operation_id == key.request.operation_id)?;
            operation.dynamic_data_request_list.iter().find_map(|request| {
                let mut other = key.clone();
                other.request.dynamic_data_request_id = request.dynamic_data_request_id.clone();
                let field = self.fields.get(&other)?;
                let is_equal = field.definition.semantic == definition.semantic
                    && field.decision.is_open_for(ValueSource::Mapping);
                field.decision.mapping.as_deref().filter(|mapping| is_equal && is_alike(mapping))
            })
        };
        let mut mapping = own.or_else(equal)?.clone();
        mapping.mapping_id = field.mapping_id();
        mapping.target = key.clone();
        Some(mapping)
    }

    /// Applies the enabled rules to the undecided fields of a network, or of all. How many were
    /// decided.
    pub fn apply_rules(&mut self, network: Option<&OperationNetworkId>, now: DateTime) -> usize {
        if !self.rules.values().any(|rule| rule.document.is_enabled) {
            return 0;
        }
        let mut undecided: Vec<FieldKey> = self
            .fields
            .iter()
            .filter(|field| {
                // What an engineer left open stays with the engineer.
                network.is_none_or(|network| field.key.request.operation_network_id == *network)
                    && field.is_undecided()
            })
            .map(|field| field.key.clone())
            .collect();
        undecided.sort();
        undecided.into_iter().filter(|key| self.apply_offer(key, now)).count()
    }

    fn apply_offer(&mut self, key: &FieldKey, now: DateTime) -> bool {
        let Some(offer) = self.rule_offer(key) else { return false };
        let grounds = DecisionBasis {
            policy_id: offer.policy_id,
            rules: offer.rules.iter().map(|(rule, _)| rule.clone()).collect(),
            policies: Vec::new(),
        };
        let verdict = match (offer.action, offer.value_source) {
            (RuleAction::Refuse, _) => Verdict::Refuse,
            (RuleAction::Accept, Some(value_source)) => Verdict::Map {
                value_source,
                mapping: offer.mapping.map(Box::new),
                policy: (*offer.disclosure).clone(),
            },
            _ => return false,
        };
        let rules = grounds.rules.clone();
        if let Err(error) = self.decide_on(key, verdict, offer.reason, DECIDED_BY, grounds, now) {
            tracing::warn!(field = %key, error = &error as &dyn std::error::Error, "A standing rule could not be applied; the field waits for an engineer.");
            return false;
        }
        let consent_version = self.fields.get(key).map_or(0, |field| field.decision.version);
        self.last_rule_decision += 1;
        self.aftermath.decisions.rule_count += 1;
        metrics::counter!("verbund_rule_decisions_total").increment(1);
        self.changes.rule_decisions.push(RuleDecisionRow {
            id: self.last_rule_decision,
            field: key.clone(),
            action: offer.action,
            rules,
            consent_version,
            decided_at: now,
        });
        true
    }

    /// Takes back what a rule decided, as long as nothing else was decided since. The field is the
    /// engineer's from then on.
    ///
    /// # Errors
    /// [`DecisionError`]; then nothing is changed.
    pub fn undo_rule_decision(
        &mut self,
        id: i64,
        key: &FieldKey,
        consent_version: u32,
        by: &str,
        now: DateTime,
    ) -> Result<(), DecisionError> {
        let field = self.fields.get(key).ok_or(DecisionError::UnknownField)?;
        if field.decision.version != consent_version || field.decision.grounds.rules.is_empty() {
            return Err(DecisionError::DecidedSince);
        }
        let reason = Some("A decision of a standing rule was taken back.".to_owned());
        self.decide(key, Verdict::LeavePending, reason, by, now)?;
        self.changes.undone_rule_decisions.push((id, by.to_owned(), now));
        Ok(())
    }
}
