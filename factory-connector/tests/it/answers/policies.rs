//! Named policies, standing rules, leak budgets, alliances and caps.

use serde_json::json;

use super::Answers;

pub async fn policies(answers: &mut Answers<'_>) {
    let policy = |step: f64| json!({ "name": "Coarse", "disclosure": { "roundingStep": step } });
    answers.put("putPolicy", "/policies/coarse", policy(10.0)).await;
    answers.get("listPolicyVersions", "/policies/coarse/versions").await;
    let body = json!({ "policyId": "coarse" });
    answers.put("putRecipientPolicy", "/recipients/acme/policy", body).await;
    answers.get("listRecipients", "/recipients").await;
    answers.post("previewPolicy", "/policies/coarse/preview", policy(100.0)).await;
    answers.get("listPolicies", "/policies").await;
}

pub async fn rules(answers: &mut Answers<'_>) {
    let rule = json!({ "name": "Power of acme", "isEnabled": true, "action": "ACCEPT",
        "valueSource": "EXTERNAL", "when": { "partners": ["acme"], "units": ["WTT"] },
        "policyId": "coarse" });
    answers.post("previewRule", "/rules/preview", rule.clone()).await;
    answers.put("putRule", "/rules/power", rule).await;
    answers.get("listRules", "/rules").await;
    answers.get("listRuleVersions", "/rules/power/versions").await;
    answers.post("applyRules", "/rules/apply", json!({})).await;
    let decisions = answers.get("listRuleDecisions", "/rule-decisions").await;
    let id = decisions["items"][0]["id"].as_str().expect("an id");
    answers.post("undoRuleDecision", &format!("/rule-decisions/{id}/undo"), json!({})).await;
}

pub async fn leak_budgets(answers: &mut Answers<'_>) {
    let measured = &["measured", "valuesPerHourMeasured"];
    answers.without(measured).get("listLeakBudgets", "/leak-budgets").await;
    answers.without(measured).get("summariseLeakBudgets", "/leak-budgets/summary").await;
}

pub async fn caps(answers: &mut Answers<'_>) {
    let measured = &["measured", "valuesPerHourMeasured"];
    let alliance = json!({ "name": "The yard", "memberList": ["acme", "hull"] });
    answers.put("putAlliance", "/alliances/yard", alliance).await;
    answers.get("listAlliances", "/alliances").await;
    answers.get("listAllianceVersions", "/alliances/yard/versions").await;
    answers.without(measured).get("listAllianceBudgets", "/leak-budgets/alliances").await;
    // Without an effect, so that the operations after it find what they need.
    let cap = json!({ "name": "The yard", "subject": { "allianceId": "yard" },
        "variable": { "sourceId": "none", "nodeId": "nsu=urn:x;i=1" }, "bitsPerHourMax": 0.5 });
    answers.post("previewCap", "/caps/yard/preview", cap.clone()).await;
    answers.put("putCap", "/caps/yard", cap).await;
    answers.get("listCaps", "/caps").await;
    answers.get("listCapVersions", "/caps/yard/versions").await;
}
