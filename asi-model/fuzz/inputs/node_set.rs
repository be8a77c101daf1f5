//! Any document is read or refused, and what is read is written and read alike.

use asi_model::{instance, node_set, validation::parse_any_platform_message};

/// Plays one input.
pub fn node_set(bytes: &[u8]) {
    let _ = parse_any_platform_message(bytes);
    if let Ok(nodes) = node_set::read(bytes) {
        let _ = instance::to_json(&nodes, "m");
        let written = node_set::write(&nodes);
        assert!(
            node_set::read(written.as_bytes()).is_ok(),
            "our own document is not read: {written}"
        );
    }
}
