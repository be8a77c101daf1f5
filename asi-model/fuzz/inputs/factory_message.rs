//! Any message from a factory is accepted or has faults.

use asi_model::validation::parse_factory_message;

/// Plays one input.
pub fn factory_message(bytes: &[u8]) {
    if let Err(rejection) = parse_factory_message(bytes) {
        assert!(!rejection.faults.is_empty());
    }
}
