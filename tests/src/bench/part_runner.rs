//! Runs one part of the measurements in this process.

use super::{links, part::Part, twin};
use crate::harness::say;

/// Runs one part in this process and prints what it finds as JSON.
///
/// # Errors
/// When it fails.
pub async fn run(part: Part) -> anyhow::Result<()> {
    let found = match part {
        Part::Fields => twin::own::fields_and_restore()?,
        Part::Restore => twin::restore::measure().await?,
        Part::Readers => twin::own::readers().await?,
        Part::Latency => twin::own::latency().await?,
        Part::Burst => twin::own::burst().await?,
        Part::Serve => return twin::server::serve().await,
        Part::Traffic => links::traffic().await?,
    };
    say(&serde_json::to_string(&found)?);
    Ok(())
}
