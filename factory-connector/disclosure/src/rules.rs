//! Standing rules: decisions that the engineer makes once for a kind of field of certain partners.
//!
//! A rule matches requested fields. The connector's state applies its action.

use std::sync::Arc;

use asi_model::{
    BuiltInType, FieldName, OrganisationId,
    messages::ValueSource,
    network::{DynamicDataRequest, ReportField},
};
use serde::{Deserialize, Serialize};

use super::{DisclosurePolicy, DocumentId, PolicyFault, documents::NAME_CHARS_MAX};

/// Most entries of one list in a rule.
const ENTRIES_MAX: usize = 100;
/// Longest reason, unit, semantic or pattern, in characters.
const TEXT_CHARS_MAX: usize = 400;

/// Action of a rule for the fields that it matches.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Serialize,
    Deserialize,
    utoipa::ToSchema,
)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum RuleAction {
    /// Values are disclosed in the rule's precision, when a source for them is known.
    Accept,
    /// The rule's precision is offered to the engineer, who decides.
    Prefill,
    /// No values; the partner gets the rule's reason.
    Refuse,
}

/// A standing rule.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Rule {
    /// Name for people, 1 to 120 characters.
    pub name: String,
    /// True when it is applied to new requests.
    #[serde(default)]
    pub is_enabled: bool,
    /// Selection of fields.
    pub when: RuleCondition,
    pub action: RuleAction,
    /// Source of the values, with `ACCEPT`: `MANUAL`, `EXTERNAL`, or `MAPPING` - the mapping of the
    /// field before a change of its request, or that of an equal field of the same operation; without
    /// one the engineer decides.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value_source: Option<ValueSource>,
    /// The precision, with `ACCEPT` and `PREFILL`. A rule that accepts needs it, where it may be
    /// empty, or a named policy.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disclosure: Option<DisclosurePolicy>,
    /// A named policy that applies as well: the strictest of both.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub policy_id: Option<DocumentId>,
    /// Reason for the partner, with `REFUSE`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// Selection of fields: those that every list contains. An empty list matches all.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields, default)]
pub struct RuleCondition {
    /// Organisations. A rule that accepts or pre-fills matches requests of which the requester and
    /// *every* recipient are listed; a rule that refuses, requests of which any is.
    pub partners: Vec<OrganisationId>,
    /// Built-in types by name.
    pub data_types: Vec<String>,
    /// Semantics as requested.
    pub semantics: Vec<String>,
    /// Units as requested.
    pub units: Vec<String>,
    /// Pattern of the field's name, in which `*` matches any text; case does not matter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name_pattern: Option<String>,
}

/// Reason why a rule is refused, with its place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RuleFault {
    /// JSON pointer into the rule.
    pub pointer: String,
    /// The fault and its remedy.
    pub message: String,
}

impl Rule {
    /// Returns whether the rule matches a requested field.
    #[must_use]
    pub fn matches(&self, request: &DynamicDataRequest, field: &ReportField) -> bool {
        let when = &self.when;
        let is_listed = |organisation: &OrganisationId| when.partners.contains(organisation);
        let mut organisations =
            std::iter::once(&request.requester_id).chain(&request.recipient_list);
        let is_partner = when.partners.is_empty()
            || if self.action == RuleAction::Refuse {
                organisations.any(is_listed)
            } else {
                organisations.all(is_listed)
            };
        let names = |list: &[String], found: Option<&str>| {
            list.is_empty() || found.is_some_and(|found| list.iter().any(|entry| entry == found))
        };
        is_partner
            && names(&when.data_types, Some(field.field_type.0.name()))
            && names(&when.semantics, field.semantic.as_ref().map(|semantic| semantic.as_str()))
            && names(&when.units, field.unit.as_deref())
            && when
                .name_pattern
                .as_deref()
                .is_none_or(|pattern| matches_pattern(&field.name, pattern))
    }

    /// Returns all faults of the rule.
    #[must_use]
    pub fn faults(&self) -> Vec<RuleFault> {
        let mut faults = Vec::new();
        let mut fault = |pointer: &str, message: &str| {
            faults.push(RuleFault { pointer: pointer.to_owned(), message: message.to_owned() });
        };
        if self.name.trim().is_empty() || self.name.chars().count() > NAME_CHARS_MAX {
            fault("/name", "A name has 1 to 120 characters.");
        }
        let lists = [&self.when.data_types, &self.when.semantics, &self.when.units];
        let is_long = |text: &String| text.chars().count() > TEXT_CHARS_MAX;
        if self.when.partners.len() > ENTRIES_MAX
            || lists.iter().any(|list| list.len() > ENTRIES_MAX)
        {
            fault("/when", "A list has at most 100 entries.");
        }
        if lists.into_iter().flatten().chain(&self.when.name_pattern).any(is_long) {
            fault("/when", "An entry has at most 400 characters.");
        }
        let is_type = |name: &String| {
            (1..=25).any(|id| BuiltInType::from_id(id).is_some_and(|t| t.name() == name))
        };
        if !self.when.data_types.iter().all(is_type) {
            fault(
                "/when/dataTypes",
                "Types are built-in types by name, as Int32, Double or String.",
            );
        }
        let is_accepting = self.action == RuleAction::Accept;
        if is_accepting && self.when.partners.is_empty() {
            fault("/when/partners", "A rule that accepts names its partners.");
        }
        if is_accepting && self.value_source.is_none() {
            fault("/valueSource", "A rule that accepts says where values come from.");
        }
        let has_reason = self.reason.as_ref().is_some_and(|reason| !reason.trim().is_empty());
        if self.action == RuleAction::Refuse && !has_reason {
            fault("/reason", "A rule that refuses tells the partner why.");
        }
        if self.reason.as_ref().is_some_and(is_long) {
            fault("/reason", "A reason has at most 400 characters.");
        }
        if is_accepting && self.disclosure.is_none() && self.policy_id.is_none() {
            fault("/disclosure", "A rule that accepts says in which precision.");
        }
        for found in self.disclosure.iter().flat_map(DisclosurePolicy::own_faults) {
            faults.push(RuleFault {
                pointer: format!("/disclosure/{}", found.member),
                message: format!("{}.", found.message),
            });
        }
        faults
    }
}

/// Returns whether a name matches a pattern in which `*` matches any text. Linear in both.
fn matches_pattern(name: &FieldName, pattern: &str) -> bool {
    let (name, pattern) = (name.as_str().to_ascii_lowercase(), pattern.to_ascii_lowercase());
    let mut parts = pattern.split('*');
    let Some(first) = parts.next() else { return false };
    let Some(mut rest) = name.strip_prefix(first) else { return false };
    let parts: Vec<&str> = parts.collect();
    let Some((last, middle)) = parts.split_last() else { return rest.is_empty() };
    for part in middle {
        let Some(index) = rest.find(part) else { return false };
        rest = &rest[index + part.len()..];
    }
    rest.ends_with(last)
}

/// Combined result of the rules that match a field: the most cautious action, and the strictest
/// precision of the rules that disclose values.
#[derive(Debug, Clone, PartialEq)]
pub struct RuleOutcome<'r, K> {
    pub action: RuleAction,
    /// The rules of this action. The first one determines reason and source.
    pub rules: Vec<(&'r K, &'r Rule)>,
    pub disclosure: Arc<DisclosurePolicy>,
}

/// Applies rules to a field, in their order; `named` returns named policies.
pub fn outcome<'r, K: 'r>(
    rules: impl Iterator<Item = (&'r K, &'r Rule)>,
    named: impl Fn(&DocumentId) -> Option<DisclosurePolicy>,
    request: &DynamicDataRequest,
    field: &ReportField,
) -> Option<RuleOutcome<'r, K>> {
    let mut matching: Vec<(&K, &Rule)> =
        rules.filter(|(_, rule)| rule.matches(request, field)).collect();
    let action = matching.iter().map(|(_, rule)| rule.action).max()?;
    let disclosing = matching.iter().filter(|(_, rule)| rule.action != RuleAction::Refuse);
    let policies = disclosing
        .flat_map(|(_, rule)| [rule.disclosure.clone(), rule.policy_id.as_ref().and_then(&named)]);
    let strictest = policies.flatten().reduce(|strict, other| strict.strictest(&other));
    let disclosure = strictest.unwrap_or_default();
    matching.retain(|(_, rule)| rule.action == action);
    let disclosure = Arc::new(disclosure.fitted_to(field.field_type.0, field.value_rank >= 0));
    Some(RuleOutcome { action, rules: matching, disclosure })
}

impl From<PolicyFault> for RuleFault {
    fn from(fault: PolicyFault) -> Self {
        Self {
            pointer: format!("/disclosure/{}", fault.member),
            message: format!("{}.", fault.message),
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn request(recipients: &[&str]) -> DynamicDataRequest {
        serde_json::from_value(
            json!({ "dynamicDataRequestId": "R", "requesterId": "acme", "recipientList": recipients,
            "purpose": "Plan", "reportDataFormat": { "reportName": "r", "reportFieldList": [] } }),
        )
        .expect("a request")
    }

    fn rule(action: &str, when: serde_json::Value) -> Rule {
        let rule = json!({ "name": "n", "when": when, "action": action, "valueSource": "MANUAL", "reason": "no",
            "disclosure": {} });
        serde_json::from_value(rule).expect("a rule")
    }

    #[test]
    fn a_rule_matches_fields_that_all_its_lists_contain() {
        let field: ReportField =
            serde_json::from_value(json!({ "name": "spindle_Temp", "type": 11, "unit": "CEL" }))
                .expect("a field");
        let check = |action: &str, when: serde_json::Value, recipients: &[&str], expected: bool| {
            assert_eq!(
                rule(action, when.clone()).matches(&request(recipients), &field),
                expected,
                "{action} {when}"
            );
        };
        check("PREFILL", json!({}), &["acme"], true);
        check("ACCEPT", json!({ "partners": ["acme"] }), &["acme"], true);
        check("ACCEPT", json!({ "partners": ["acme"] }), &["acme", "spy"], false);
        check("REFUSE", json!({ "partners": ["spy"] }), &["acme", "spy"], true);
        check(
            "ACCEPT",
            json!({ "partners": ["acme"], "dataTypes": ["Double"], "units": ["CEL"] }),
            &["acme"],
            true,
        );
        check("ACCEPT", json!({ "dataTypes": ["Int32"] }), &["acme"], false);
        check("ACCEPT", json!({ "semantics": ["SCRAP_QUANTITY"] }), &["acme"], false);
        for (pattern, expected) in [
            ("*temp", true),
            ("spindle*", true),
            ("s*_t*p", true),
            ("spindle", false),
            ("*temp*x", false),
            ("*", true),
        ] {
            check("PREFILL", json!({ "namePattern": pattern }), &["acme"], expected);
        }
    }

    #[test]
    fn the_most_cautious_rule_wins_and_the_strictest_precision_applies() {
        let field: ReportField =
            serde_json::from_value(json!({ "name": "made", "type": 9 })).expect("a field");
        let mut rules = [
            (1, rule("ACCEPT", json!({ "partners": ["acme"] }))),
            (2, rule("ACCEPT", json!({ "partners": ["acme", "hull"] }))),
            (3, rule("REFUSE", json!({ "partners": ["spy"] }))),
        ];
        let interval =
            |ms| DisclosurePolicy { minimum_interval_ms: Some(ms), ..Default::default() };
        rules[0].1.disclosure = Some(interval(5));
        rules[1].1.disclosure = Some(interval(9));
        let asked = |recipients: &[&str]| {
            let rules = rules.iter().map(|(id, rule)| (id, rule));
            outcome(rules, |_| None, &request(recipients), &field).map(|found| {
                (found.action, found.rules.len(), found.disclosure.minimum_interval_ms)
            })
        };
        assert_eq!(asked(&["acme"]), Some((RuleAction::Accept, 2, Some(9))));
        assert_eq!(asked(&["acme", "hull"]), Some((RuleAction::Accept, 1, Some(9))));
        assert_eq!(asked(&["acme", "spy"]), Some((RuleAction::Refuse, 1, None)));
        assert_eq!(asked(&["other"]), None);
    }

    #[test]
    fn all_faults_are_returned_at_once() {
        let mut rule = rule("ACCEPT", json!({ "dataTypes": ["Integer"] }));
        rule.name = " ".to_owned();
        rule.value_source = None;
        rule.disclosure = Some(DisclosurePolicy { delay_ms: Some(0), ..Default::default() });
        let pointers: Vec<String> = rule.faults().into_iter().map(|fault| fault.pointer).collect();
        assert_eq!(
            pointers,
            ["/name", "/when/dataTypes", "/when/partners", "/valueSource", "/disclosure/delayMs"]
        );
    }

    #[test]
    fn a_rule_that_accepts_opens_nothing_without_a_precision() {
        let accept = rule("ACCEPT", json!({ "partners": ["acme"] }));
        assert_eq!(accept.faults(), []);
        let unsaid = Rule { disclosure: None, ..accept };
        assert_eq!(unsaid.faults().first().map(|fault| &fault.pointer[..]), Some("/disclosure"));
        let named = Rule { policy_id: Some("coarse".parse().expect("an id")), ..unsaid };
        assert_eq!(named.faults(), []);
        let refuse = Rule { disclosure: None, ..rule("REFUSE", json!({})) };
        assert_eq!(refuse.faults(), []);
    }
}
