//! Tag of what a person sees who decides about a field.

use std::fmt::Write;

use asi_model::FieldKey;
use sha2::{Digest, Sha256};

use crate::ConnectorState;

/// Bytes of the tag: enough that no two states of one field share it.
const TAG_BYTES: usize = 8;

/// Returns a tag of everything on which a decision about a field rests: the decision in force, the
/// definition of the field, and who asks, for whom, why, how often and until when. It differs after
/// each change of any of these.
#[must_use]
pub fn shown_tag(state: &ConnectorState, key: &FieldKey) -> Option<String> {
    let field = state.field(key)?;
    let request = state.networks().request(&key.request).map(|(_, request)| {
        (
            (&request.requester_id, &request.recipient_list, &request.purpose),
            (
                &request.description,
                request.update_interval(),
                request.valid_from,
                request.valid_until,
            ),
        )
    });
    let shown = (field.decision().version, field.definition(), request);
    let mut hash = Sha256::new();
    serde_json::to_writer(&mut hash, &shown).ok()?;
    let mut tag = String::with_capacity(2 * TAG_BYTES);
    for byte in &hash.finalize()[..TAG_BYTES] {
        write!(tag, "{byte:02x}").ok()?;
    }
    Some(tag)
}
