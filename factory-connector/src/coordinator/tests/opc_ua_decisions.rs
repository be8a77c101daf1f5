//! Decisions of OPC UA clients.

use asi_model::messages::MappingState;
use twin::{FieldWriter as _, TwinUser};

use super::*;
use crate::twin_adapter::CoordinatorWriter;

async fn map_by_opc_ua(running: &Running) -> StatusCode {
    let user = TwinUser { name: "eve".into(), role: twin::Role::Engineer };
    let decision = twin::TwinDecision { mapping_state: MappingState::Mapped, reason: None };
    CoordinatorWriter(running.coordinator.clone()).decide(&field("made"), decision, &user).await
}

async fn policy(running: &Running) -> Option<DisclosurePolicy> {
    let read = |state: &connector_state::ConnectorState| {
        let field = state.field(&field("made")).expect("a field");
        field.decision().is_mapped().then(|| (**field.gate().policy()).clone())
    };
    running.coordinator.read(read).await.expect("read")
}

#[tokio::test]
async fn the_decide_method_opens_no_field_without_a_policy() {
    let running = Running::open().await;
    running.receive("operation-network", network(1)).await;
    assert_eq!(map_by_opc_ua(&running).await, StatusCode::BAD_INVALID_ARGUMENT);
    assert_eq!(policy(&running).await, None);
    let coarse = DisclosurePolicy { delay_ms: Some(60_000), ..Default::default() };
    let command = DecisionCommand::Map {
        value_source: ValueSource::Manual,
        mapping: None,
        policy: coarse.clone(),
    };
    decide_field(&running.coordinator, field("made"), command).await;
    assert_eq!(map_by_opc_ua(&running).await, StatusCode::GOOD);
    assert_eq!(policy(&running).await, Some(coarse), "as a person set it");
}

/// Returns the policy that the page suggests for the next consent.
async fn suggestion(running: &Running) -> DisclosurePolicy {
    let read = |state: &connector_state::ConnectorState| {
        (*state.field(&field("made")).expect("a field").decision().policy).clone()
    };
    running.coordinator.read(read).await.expect("read")
}

/// A policy that a person chose for certain recipients and a certain purpose opens nothing for
/// others.
#[tokio::test]
async fn the_decide_method_reopens_no_field_with_the_policy_of_a_former_consent() {
    let running = Running::open().await;
    running.receive("operation-network", network(1)).await;
    let coarse = DisclosurePolicy { delay_ms: Some(60_000), ..Default::default() };
    let consent = || DecisionCommand::Map {
        value_source: ValueSource::Manual,
        mapping: None,
        policy: coarse.clone(),
    };
    let changes = [("recipientList", json!(["acme", "hull", "rival"])), ("purpose", json!("Sell"))];
    let mut changed = network(1);
    for (revision, (member, value)) in (2_u64..).zip(changes) {
        decide_field(&running.coordinator, field("made"), consent()).await;
        let operation = &mut changed["operationNetwork"]["operationList"][0];
        operation["dynamicDataRequestList"][0][member] = value;
        (changed["revision"], changed["messageId"]) = (json!(revision), json!(new_message_id()));
        running.receive("operation-network", changed.clone()).await;
        assert_eq!(policy(&running).await, None, "{member}: the consent has ended");
        assert_eq!(map_by_opc_ua(&running).await, StatusCode::BAD_INVALID_ARGUMENT, "{member}");
        assert_eq!(policy(&running).await, None, "{member}");
        assert_eq!(suggestion(&running).await, coarse, "{member}: the page suggests it");
    }
    decide_field(&running.coordinator, field("made"), consent()).await;
    running.revoke(None).await;
    assert_eq!(map_by_opc_ua(&running).await, StatusCode::BAD_INVALID_ARGUMENT, "revoked");
    assert_eq!(policy(&running).await, None);
}
