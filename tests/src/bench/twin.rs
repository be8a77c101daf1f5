//! The twin's own figures, and the same scenario on a server written with node-opcua beside it.

mod beside;
mod client;
pub(super) mod own;
pub(super) mod restore;
pub(super) mod server;

use serde_json::Value;

use super::part::Part;

/// Measures everything about the twin.
///
/// # Errors
/// When a part fails or takes too long.
pub(super) async fn measure() -> anyhow::Result<Vec<Value>> {
    let mut results = Vec::new();
    for part in [Part::Fields, Part::Restore, Part::Readers, Part::Latency, Part::Burst] {
        results.extend(part.measure().await?);
    }
    results.extend(beside::measure().await?);
    Ok(results)
}
