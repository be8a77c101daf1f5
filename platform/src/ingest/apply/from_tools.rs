//! Data requests of partners' tools.

use std::time::Duration;

use asi_model::messages::{AcknowledgementResult, Fault};

use crate::{
    clock::{new_message_id, new_opaque_id},
    ingest::unit::IngestUnit,
    networks::{self, Author, ChangeError},
    store::{
        AuditAgent, AuditAgentKind, AuditFact, AuditFactKind, AuditOutcome, AuditSubject,
        NewAuditEntry, Scope, StoreError,
    },
    tools::{DataRequestMessage, ToolAcknowledgement},
};

/// Adds a tool's request as a request of its organisation and answers it. Returns true if the
/// network's requests may have changed.
pub(super) async fn add_request(
    unit: &mut IngestUnit<'_>,
    message: &DataRequestMessage,
    resend_after: Duration,
) -> Result<bool, StoreError> {
    let Some(tool) = unit.work.tools().lookup(&Scope::Platform, &message.tool_id).await? else {
        return Ok(false);
    };
    let agent = AuditAgent {
        kind: AuditAgentKind::Tool,
        name: tool.tool_id.to_string(),
        organisation_id: Some(tool.organisation_id.clone()),
        is_administrator: false,
    };
    let author = Author::tool(&tool.tool_id, tool.organisation_id, unit.now);
    let mut request = message.dynamic_data_request.clone();
    request.dynamic_data_request_publisher_id = Some(message.tool_id.clone());
    let (network, operation) = (&message.operation_network_id, &message.operation_id);
    let added =
        networks::add_request(unit.work, network, operation, request, &author, resend_after).await;
    let is_added = added.is_ok();
    let (result, revision, fault_list) = match added {
        Ok(outcome) => {
            let id = &message.dynamic_data_request.dynamic_data_request_id;
            let path = format!("operation-networks/{network}/operations/{operation}/requests/{id}");
            let entry = NewAuditEntry {
                entry_id: new_opaque_id(),
                recorded_at: unit.now,
                agent: &agent,
                operation: "addDynamicDataRequest",
                subject: &AuditSubject::shared(path),
                outcome: AuditOutcome::of(outcome.is_changed),
                facts: &[AuditFact::new(AuditFactKind::Revision, outcome.revision)],
            };
            unit.work.audit().add(&entry).await?;
            unit.effects.notifications.extend(outcome.notifications);
            unit.effects.has_outgoing = true;
            let result = match outcome.is_changed {
                true => AcknowledgementResult::Accepted,
                false => AcknowledgementResult::Unchanged,
            };
            (result, Some(outcome.revision), Vec::new())
        }
        Err(ChangeError::Store(error)) => return Err(error),
        Err(ChangeError::Faulty(faults)) => (AcknowledgementResult::Rejected, None, faults),
        Err(error) => {
            let fault = Fault {
                pointer: String::new(),
                code: "NOT_POSSIBLE".to_owned(),
                message: format!("{error}."),
            };
            (AcknowledgementResult::Rejected, None, vec![fault])
        }
    };
    let answer = ToolAcknowledgement {
        message_type: "acknowledgement",
        message_id: new_message_id(),
        tool_id: message.tool_id.clone(),
        correlation_id: message.message_id.clone(),
        operation_network_id: network.clone(),
        revision,
        result,
        fault_list,
    };
    unit.answer(&answer).await?;
    Ok(is_added)
}
