//! Causes for which a client's certificate is not accepted.

/// Cause for which a certificate is not accepted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub(crate) enum CertificateError {
    #[error("it cannot be read")]
    Unreadable,
    #[error("an engineer rejected it")]
    Denied,
    #[error("it still waits for an approval")]
    Waiting,
    #[error("neither it nor its issuer is trusted; it waits for an approval now")]
    Unknown,
    #[error("it is not valid at this time")]
    OutOfTime,
    #[error("its key is too short or too long for the security policy")]
    KeyLength,
    #[error("it may not be used for signing")]
    Usage,
    #[error("its issuer revoked it")]
    Revoked,
    #[error("there is no current revocation list of its issuer in the `crl` folder")]
    RevocationUnknown,
    #[error("a file of the trust list cannot be read, so that nobody is let in")]
    TrustListUnreadable,
}
