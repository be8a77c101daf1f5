//! Tampering with an audit file without the key of its log: every kind is tried at every
//! place, on files that tests make and on those of a real connector.

mod checkpoint;
mod file;
mod kinds;
mod members;
mod order;
mod signer;
mod tail;
mod values;

pub use file::AuditFile;
pub use kinds::{Audit, Kinds};

/// Tries every kind of tampering.
///
/// # Panics
/// For a file that no connector writes.
#[must_use]
pub fn try_all<'a>(file: &AuditFile, audit: Audit<'a>) -> Kinds<'a> {
    let mut kinds = Kinds::new(audit);
    members::try_all(file, &mut kinds);
    order::try_all(file, &mut kinds);
    values::try_all(file, &mut kinds);
    checkpoint::try_all(file, &mut kinds);
    tail::try_all(file, &mut kinds);
    kinds
}
