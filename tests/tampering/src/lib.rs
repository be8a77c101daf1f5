//! Tampering with an audit file by somebody who does not have the key of its log: every kind is tried
//! at every place, on files that tests make and on those of a real connector.

mod checkpoint;
mod file;
mod kinds;
mod members;
mod order;
mod signer;
mod tail;
mod values;

pub use file::AuditFile;
pub use kinds::Kinds;

/// Number of faults that an audit of these lines finds against this checkpoint. What an audit does not
/// begin with is a fault, too.
pub type Audit<'a> = &'a dyn Fn(&[String], &str) -> u64;

/// Tries every kind of tampering.
///
/// # Panics
/// Where the file is none that can be tampered with.
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
