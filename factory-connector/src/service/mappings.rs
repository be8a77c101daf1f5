//! Publishes mappings at the engine, in the order of the decisions.

use connector_state::EngineCommand;
use mapping_engine::{MappingEngineHandle, PublishRequest};
use tokio::sync::mpsc;
use tokio_util::sync::CancellationToken;

/// Runs until shutdown.
pub(super) async fn publish(
    mut work: mpsc::Receiver<Vec<EngineCommand>>,
    engine: MappingEngineHandle,
    shutdown: CancellationToken,
) {
    while let Some(Some(batch)) = shutdown.run_until_cancelled(work.recv()).await {
        let mut ready: Vec<PublishRequest> = Vec::new();
        for piece in batch {
            match piece {
                EngineCommand::Put(published) => ready.push(published),
                EngineCommand::Remove(id) => {
                    // What was decided before the removal comes first: it may be about the same
                    // mapping.
                    put(&engine, std::mem::take(&mut ready)).await;
                    if engine.remove(&id).await.is_err() {
                        return;
                    }
                }
            }
        }
        put(&engine, ready).await;
    }
}

async fn put(engine: &MappingEngineHandle, mappings: Vec<PublishRequest>) {
    if mappings.is_empty() {
        return;
    }
    let ids: Vec<_> =
        mappings.iter().map(|published| published.mapping.mapping_id.clone()).collect();
    let Ok(outcomes) = engine.put_many(mappings).await else { return };
    for (id, outcome) in ids.into_iter().zip(outcomes) {
        if let Err(error) = outcome {
            // The mapping was checked before the decision; what is wrong now has come since.
            tracing::warn!(mapping.id = %id, error = &error as &dyn std::error::Error, "A mapping could not be published.");
        }
    }
}
