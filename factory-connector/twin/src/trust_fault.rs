//! Fault of a certificate or revocation list, for the engineer who adds it.

/// A fault with its remedy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TrustFault {
    /// Stable name in upper case, for programs.
    pub code: &'static str,
    /// The fault and its remedy, for people.
    pub message: String,
}

impl TrustFault {
    pub(crate) fn new(code: &'static str, message: impl Into<String>) -> Self {
        Self { code, message: message.into() }
    }
}
