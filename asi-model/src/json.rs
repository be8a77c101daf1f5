//! JSON as foreign bytes arrive and as ours leave: a bounded reader and a plain writer.
//!
//! [`Tape`] reads a text once, without recursion, into one flat list of tokens, so that hostile
//! input costs time and memory linear in its size and nothing more. It keeps numbers as text
//! (64-bit integers stay exact) and reports member names that occur twice, which general-purpose
//! readers pass over.

mod error;
mod escapes;
mod node;
mod reader;
mod tape;
mod token;
pub mod write;

pub use error::{JsonError, Limits};
pub use node::{Elements, JsonNode, Members};
pub use tape::Tape;
pub use token::Kind;

/// Appends a member as it came to the text of an object, with the comma it needs.
pub(crate) fn push_separated(json: &mut String, name: JsonNode<'_, '_>, value: JsonNode<'_, '_>) {
    if !json.ends_with('{') {
        json.push(',');
    }
    json.push_str(name.raw());
    json.push(':');
    json.push_str(value.raw());
}
