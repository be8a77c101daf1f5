//! Faults of networks that the platform finds.

use asi_model::messages::Fault;

/// Makes a fault; `pointer` is a JSON pointer into the author's document.
pub(super) fn fault(pointer: String, code: &str, message: String) -> Fault {
    Fault { pointer, code: code.to_owned(), message }
}
