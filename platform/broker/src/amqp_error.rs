//! AMQP error conditions: made for peers, and read from them.

use fe2o3_amqp::types::{
    definitions::{Error, ErrorCondition},
    primitives::Symbol,
};

/// Builds an AMQP error; `description` is a sentence for people.
pub(crate) fn amqp_error(
    condition: impl Into<ErrorCondition>,
    description: impl Into<String>,
) -> Error {
    Error::new(condition, description.into(), None)
}

/// Returns the symbol of a condition as it is encoded, for example `amqp:link:detach-forced`.
pub(crate) fn condition_text(condition: &ErrorCondition) -> String {
    // The library keeps the symbols private; encoding is the only way to read one.
    serde_amqp::to_vec(condition)
        .ok()
        .and_then(|bytes| serde_amqp::from_slice::<Symbol>(&bytes).ok())
        .map_or_else(|| format!("{condition:?}"), |symbol| symbol.0)
}
