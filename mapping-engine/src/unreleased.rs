//! Answers with values as machines and scripts made them, which no disclosure gate released.

/// Right to see values that no disclosure gate released. The API that answers people gives it to a proof
/// of who they are.
pub trait SeesUnreleased {}

/// Answer with values that no disclosure gate released. It is not shown as it is:
///
/// ```compile_fail,E0277
/// fn show(status: mapping_engine::Unreleased<mapping_engine::MappingStatus>) -> serde_json::Value {
///     serde_json::to_value(status).unwrap()
/// }
/// ```
///
/// Only with the right to see them is it taken out:
///
/// ```
/// use mapping_engine::{MappingStatus, SeesUnreleased, Unreleased};
/// fn show(status: Unreleased<MappingStatus>, user: impl SeesUnreleased) -> MappingStatus {
///     status.seen_by(user)
/// }
/// ```
///
/// ```compile_fail,E0277
/// use mapping_engine::{MappingStatus, Unreleased};
/// fn show(status: Unreleased<MappingStatus>) -> MappingStatus {
///     status.seen_by("anybody")
/// }
/// ```
///
/// ```compile_fail,E0616
/// use mapping_engine::{MappingStatus, Unreleased};
/// fn show(status: Unreleased<MappingStatus>) -> MappingStatus {
///     status.answer
/// }
/// ```
#[derive(Clone, PartialEq)]
pub struct Unreleased<T> {
    answer: T,
}

impl<T> Unreleased<T> {
    pub(crate) const fn new(answer: T) -> Self {
        Self { answer }
    }

    /// Returns the answer for a person or program with the right to see it.
    pub fn seen_by(self, _right: impl SeesUnreleased) -> T {
        self.answer
    }
}

/// Without the values: what is debugged ends up in logs.
impl<T> std::fmt::Debug for Unreleased<T> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("Unreleased")
    }
}
