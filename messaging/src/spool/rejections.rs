//! What a broker's refusal means for a message: never drop it, and never try the impossible again
//! and again.

use crate::inbox::Rejection;

/// A message that was rejected so often is set aside.
pub const ATTEMPTS_MAX: u32 = 5;

/// What to do with a rejected message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RejectionVerdict {
    /// It would be rejected again: set it aside with the reason.
    Park,
    /// Try it again later; counts as an attempt.
    Retry,
    /// Not the message's fault: let the address rest, then go on. Does not count as an attempt.
    RestAddress,
}

/// Decides after a rejection, the `attempts`-th before it not counted.
#[must_use]
pub fn after_rejection(rejection: &Rejection, attempts: u32) -> RejectionVerdict {
    match rejection.code.as_str() {
        "amqp:link:message-size-exceeded"
        | "amqp:decode-error"
        | "amqp:invalid-field"
        | "amqp:not-allowed"
        | "amqp:not-implemented" => RejectionVerdict::Park,
        "amqp:resource-limit-exceeded"
        | "amqp:unauthorized-access"
        | "amqp:not-found"
        | "amqp:precondition-failed" => RejectionVerdict::RestAddress,
        _ if attempts + 1 >= ATTEMPTS_MAX => RejectionVerdict::Park,
        _ => RejectionVerdict::Retry,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_follow_the_condition() {
        for (code, attempts, expected) in [
            ("amqp:link:message-size-exceeded", 0, RejectionVerdict::Park),
            ("amqp:resource-limit-exceeded", 99, RejectionVerdict::RestAddress),
            ("amqp:internal-error", 0, RejectionVerdict::Retry),
            ("amqp:internal-error", 3, RejectionVerdict::Retry),
            ("amqp:internal-error", 4, RejectionVerdict::Park),
            ("something-else", 4, RejectionVerdict::Park),
        ] {
            let rejection = Rejection { code: code.into(), reason: String::new() };
            assert_eq!(after_rejection(&rejection, attempts), expected, "{code} after {attempts}");
        }
    }
}
