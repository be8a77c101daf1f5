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
