//! What partners' tools ask.

use asi_model::messages::AcknowledgementResult;
use messaging::LogicalAddress;

use super::Applier;
use crate::{
    clock::new_message_id,
    networks::{Author, ChangeError, add_request},
    store::{Scope, StoreError},
    tools::{DataRequestMessage, ToolAcknowledgement},
};

impl Applier<'_> {
    /// A tool's request becomes a request of its organisation, or an answer says why not.
    pub(super) async fn data_request(
        &mut self,
        message: &DataRequestMessage,
    ) -> Result<(), StoreError> {
        let Some(tool) = self.work.tools().lookup(&Scope::Platform, &message.tool_id).await? else {
            return Ok(());
        };
        let author = Author::tool(&tool.tool_id, tool.organisation_id, self.now);
        let mut request = message.dynamic_data_request.clone();
        request.dynamic_data_request_publisher_id = Some(message.tool_id.clone());
        let (network, operation) = (&message.operation_network_id, &message.operation_id);
        let added =
            add_request(self.work, network, operation, request, &author, self.resend_after).await;
        let (result, revision, fault_list) = match added {
            Ok(outcome) => {
                self.asked.clear();
                self.effects.news.extend(outcome.news);
                self.effects.has_outgoing = true;
                let result = match outcome.is_changed {
                    true => AcknowledgementResult::Accepted,
                    false => AcknowledgementResult::Unchanged,
                };
                (result, Some(outcome.revision), Vec::new())
            }
            Err(ChangeError::Store(error)) => return Err(error),
            Err(ChangeError::Faulty(faults)) => (AcknowledgementResult::Rejected, None, faults),
            Err(error) => {
                let fault = asi_model::messages::Fault {
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
        let body = serde_json::to_vec(&answer).expect("an acknowledgement has text keys only");
        let address = LogicalAddress::ToolReports(message.tool_id.clone());
        let correlation = Some(message.message_id.clone());
        self.send(address, answer.message_id.clone(), "acknowledgement", correlation, body).await
    }
}
