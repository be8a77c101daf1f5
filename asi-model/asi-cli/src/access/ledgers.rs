//! Audit files of a factory's ledger, proven by the checkpoint that each has, and read for what left.

use std::path::Path;

use ::ledger::{
    LogStart,
    audit::{Audit, AuditStart, Auditor},
};
use anyhow::{Context as _, bail};
use asi_model::FactoryId;
use transparency_log::VerifierKey;

use super::left_values::LeftValues;
use crate::{
    audit_lines::take_all,
    left::LeftEntry,
    lines::{next_line, open},
};

/// Reads an audit file of this factory into `left`, and returns its audit. One of `keys` has to have
/// signed it: the key of any of the factory's logs, which differ in their names only.
///
/// # Errors
/// When the file cannot be read, is no audit file of the factory, or is signed by none of the keys.
pub(super) fn read(
    file: &Path,
    factory: &FactoryId,
    keys: &[VerifierKey],
    left: &mut LeftValues,
) -> anyhow::Result<Audit> {
    let context = || format!("{}", file.display());
    let mut lines = open(file)?;
    let first = next_line(&mut lines)?.unwrap_or_default();
    let begin: AuditStart = serde_json::from_str(&first)
        .context("the first line does not begin the audit file of a ledger")
        .with_context(context)?;
    let start: LogStart = serde_json::from_str(&begin.log_start).with_context(context)?;
    if start.factory_id != *factory {
        bail!("{}: the log is one of {}", file.display(), start.factory_id);
    }
    let Some(checkpoint) = &begin.checkpoint else {
        bail!("{}: the file has no checkpoint over its entries", file.display());
    };
    let begun = keys.iter().find_map(|key| {
        let key = start.verifier(key.public_key()).ok()?;
        Auditor::new(checkpoint, &key, &first, None).ok()
    });
    let Some(mut auditor) = begun else {
        bail!("{}: the file is not signed with this key", file.display());
    };
    let viewer = left.begin(&start.recipient, begin.number > 0);
    take_all(&mut auditor, &mut lines, &LeftEntry::read, |entry| left.take(viewer, entry))?;
    Ok(auditor.finish())
}
