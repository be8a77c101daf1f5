//! Rejections of messages: which are retried, which park the message, which back the address off.

/// Reason for which a receiver or a broker rejected a message.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{code}: {reason}")]
pub struct Rejection {
    /// A stable code; an AMQP error condition where the broker gave it.
    pub code: String,
    /// A sentence for people. Never contains plant values.
    pub reason: String,
}

/// Rejections after which a message is parked.
pub const ATTEMPTS_MAX: u32 = 5;

/// Treatment of a rejected message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RejectionAction {
    /// Every further attempt would be rejected: park the message with the reason.
    Park,
    /// Send the message again later; counts as an attempt.
    Retry,
    /// The address is at fault, not the message: back off from the address, then continue. Does not
    /// count as an attempt.
    BackOffAddress,
}

/// Chooses the treatment of a rejection that follows `attempts` earlier ones of the same message.
///
/// A message is never dropped; one that can never be accepted is not sent again and again.
#[must_use]
pub fn after_rejection(rejection: &Rejection, attempts: u32) -> RejectionAction {
    match rejection.code.as_str() {
        "amqp:link:message-size-exceeded"
        | "amqp:decode-error"
        | "amqp:invalid-field"
        | "amqp:not-allowed"
        | "amqp:not-implemented" => RejectionAction::Park,
        "amqp:resource-limit-exceeded"
        | "amqp:unauthorized-access"
        | "amqp:not-found"
        | "amqp:precondition-failed" => RejectionAction::BackOffAddress,
        _ if attempts + 1 >= ATTEMPTS_MAX => RejectionAction::Park,
        _ => RejectionAction::Retry,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_action_follows_the_error_condition_and_the_attempts() {
        for (code, attempts, expected) in [
            ("amqp:link:message-size-exceeded", 0, RejectionAction::Park),
            ("amqp:resource-limit-exceeded", 99, RejectionAction::BackOffAddress),
            ("amqp:internal-error", 0, RejectionAction::Retry),
            ("amqp:internal-error", 3, RejectionAction::Retry),
            ("amqp:internal-error", 4, RejectionAction::Park),
            ("something-else", 4, RejectionAction::Park),
        ] {
            let rejection = Rejection { code: code.into(), reason: String::new() };
            assert_eq!(after_rejection(&rejection, attempts), expected, "{code} after {attempts}");
        }
    }
}
