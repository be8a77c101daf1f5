//! Bounds on messages.

use crate::{
    json::Limits,
    messages::{MESSAGE_BYTES_MAX, REQUEST_BYTES_MAX},
};

/// Bounds on a message to a factory.
pub const REQUEST_LIMITS: Limits =
    Limits { bytes_max: REQUEST_BYTES_MAX, depth_max: 32, tokens_max: 300_000 };
/// Bounds on a message from a factory.
pub const MESSAGE_LIMITS: Limits =
    Limits { bytes_max: MESSAGE_BYTES_MAX, depth_max: 32, tokens_max: 100_000 };

/// Most operations of a network.
pub const OPERATIONS_MAX: usize = 5_000;
/// Most relations of a network.
pub const RELATIONS_MAX: usize = 20_000;
/// Most elements of any list inside an operation, request or relation.
pub const LIST_MAX: usize = 500;
/// Longest name or foreign identifier, in characters.
pub const NAME_CHARS_MAX: usize = 256;
/// Longest description, purpose or comment, in characters.
pub const TEXT_CHARS_MAX: usize = 8_192;
/// Highest revision: the largest integer that every JSON reader reads exactly.
pub const REVISION_MAX: u64 = (1 << 53) - 1;
