//! Commands: each becomes part of the transaction that is being made.

use messaging::Settlement;

use super::{
    handle::{CommandKind, CoordinatorCommand, Reply},
    incoming, outcomes,
    unit_of_work::UnitOfWork,
    witnessing,
};
use crate::{clock::now, store::StoreError};

/// Runs a command on the state. Returns the answer to give when the transaction ends; none where
/// the caller has it already.
pub(super) async fn handle_command(
    work: &mut UnitOfWork,
    CoordinatorCommand(command): CoordinatorCommand,
) -> Result<Option<Reply>, StoreError> {
    let now = now();
    let reply: Reply = match command {
        CommandKind::Deliver(deliveries, reply) => {
            let count = deliveries.len();
            incoming::deliver(work, deliveries, now).await?;
            Box::new(move |is_written| {
                // Messages of a failed transaction are delivered again.
                let settlement = if is_written { Settlement::Accept } else { Settlement::Release };
                drop(reply.send(vec![settlement; count]));
            })
        }
        CommandKind::RecordOutcomes(outcomes, sent, reply) => {
            outcomes::record(work, &outcomes, sent, now).await?;
            Box::new(move |is_written| _ = reply.send(is_written))
        }
        CommandKind::BeginLog(decision, reply) => {
            let is_begun = witnessing::begin_log(work, &decision, now).await?;
            Box::new(move |is_written| _ = reply.send(is_written.then_some(is_begun)))
        }
        CommandKind::Read(query) => {
            // It may see what is not committed yet; a caller that needs certainty runs a use case.
            query(&work.state);
            return Ok(None);
        }
        CommandKind::Execute(use_case) => {
            let (changes, reply) = use_case(&mut work.state, now);
            // Nothing was changed, so there is no transaction to wait for.
            let Some(changes) = changes else {
                reply(true);
                return Ok(None);
            };
            work.pending.merge(changes);
            reply
        }
    };
    Ok(Some(reply))
}
