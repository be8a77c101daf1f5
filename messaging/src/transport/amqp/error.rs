//! Faults from the errors of the AMQP library.

use fe2o3_amqp::{
    connection::OpenError,
    link::{
        LinkStateError, ReceiverAttachError, RecvError, SendError, SenderAttachError,
        SessionStopReason,
    },
    types::{
        definitions::{self, AmqpError, ConnectionError, ErrorCondition},
        sasl::SaslCode,
    },
};

use super::codec;
use crate::{
    spool::Rejection,
    transport::connection::{ConnectionFault, LaneFault},
};

pub(super) fn open_fault(error: OpenError) -> ConnectionFault {
    match error {
        OpenError::SaslError { code: SaslCode::Auth, .. } => {
            ConnectionFault::permanent("the broker refused the user or password")
        }
        OpenError::SaslError { code, .. } => ConnectionFault::passing(format!(
            "the broker could not check the credentials: {code:?}"
        )),
        OpenError::RemoteClosedWithError(error) => closed_fault(&error),
        OpenError::ProtocolHeaderMismatch(_) => ConnectionFault::permanent(
            "the peer does not speak AMQP 1.0 with SASL; is the port right?",
        ),
        other => ConnectionFault::passing(format!("the connection could not be opened: {other}")),
    }
}

pub(super) fn end_fault(ended: Result<(), fe2o3_amqp::connection::Error>) -> ConnectionFault {
    match ended {
        Ok(()) => ConnectionFault::passing("the broker closed the connection"),
        Err(fe2o3_amqp::connection::Error::RemoteClosedWithError(error)) => closed_fault(&error),
        Err(error) => ConnectionFault::passing(format!("the connection was lost: {error}")),
    }
}

pub(super) fn closed_fault(error: &definitions::Error) -> ConnectionFault {
    let reason = format!("the broker closed the connection: {}", rejection(error));
    match error.condition {
        ErrorCondition::AmqpError(AmqpError::UnauthorizedAccess | AmqpError::NotAllowed) => {
            ConnectionFault::permanent(reason)
        }
        ErrorCondition::ConnectionError(ConnectionError::Redirect) => {
            ConnectionFault::permanent(reason)
        }
        _ => ConnectionFault::passing(reason),
    }
}

/// Converts an AMQP error; the code is the symbolic error condition.
pub(super) fn rejection(error: &definitions::Error) -> Rejection {
    Rejection {
        code: codec::condition_text(&error.condition),
        reason: error.description.clone().unwrap_or_else(|| "the broker gave no reason".to_owned()),
    }
}

pub(super) fn sender_attach_fault(error: SenderAttachError) -> LaneFault {
    match error {
        SenderAttachError::RemoteClosedWithError(error)
        | SenderAttachError::SessionStopped(SessionStopReason::RemoteEndedWithError(error)) => {
            LaneFault::Refused(rejection(&error))
        }
        other => LaneFault::Broken(format!("the broker did not attach a sender: {other}")),
    }
}

pub(super) fn receiver_attach_fault(error: ReceiverAttachError) -> LaneFault {
    match error {
        ReceiverAttachError::RemoteClosedWithError(error)
        | ReceiverAttachError::SessionStopped(SessionStopReason::RemoteEndedWithError(error)) => {
            LaneFault::Refused(rejection(&error))
        }
        other => LaneFault::Broken(format!("the broker did not attach a receiver: {other}")),
    }
}

pub(super) fn send_fault(error: SendError) -> LaneFault {
    match error {
        SendError::LinkStateError(state) => state_fault(state),
        other => LaneFault::Broken(format!("a message could not be sent: {other}")),
    }
}

pub(super) fn recv_fault(error: RecvError) -> LaneFault {
    match error {
        RecvError::LinkStateError(state) => state_fault(state),
        other => LaneFault::Broken(format!("a message could not be received: {other}")),
    }
}

pub(super) fn state_fault(state: LinkStateError) -> LaneFault {
    match state {
        LinkStateError::RemoteClosedWithError(error)
        | LinkStateError::RemoteDetachedWithError(error) => LaneFault::Refused(rejection(&error)),
        // Some brokers end the whole session where one link is refused.
        LinkStateError::SessionStopped(SessionStopReason::RemoteEndedWithError(error)) => {
            LaneFault::Refused(rejection(&error))
        }
        other => LaneFault::Broken(format!("the link has ended: {other}")),
    }
}

pub(super) fn settle_fault(error: impl std::fmt::Debug) -> LaneFault {
    LaneFault::Broken(format!("a settlement could not be sent: {error:?}"))
}
