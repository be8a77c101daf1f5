//! Conversion of the AMQP library's errors into faults.

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
    transport::connection::{ConnectionFault, EndpointFault},
};

pub(super) fn open_fault(error: OpenError) -> ConnectionFault {
    match error {
        OpenError::SaslError { code: SaslCode::Auth, .. } => {
            ConnectionFault::permanent("the broker refused the user or password")
        }
        OpenError::SaslError { code, .. } => ConnectionFault::transient(format!(
            "the broker could not check the credentials: {code:?}"
        )),
        OpenError::RemoteClosedWithError(error) => closed_fault(&error),
        OpenError::ProtocolHeaderMismatch(_) => ConnectionFault::permanent(
            "the peer does not speak AMQP 1.0 with SASL; is the port right?",
        ),
        other => ConnectionFault::transient(format!("the connection could not be opened: {other}")),
    }
}

pub(super) fn end_fault(ended: Result<(), fe2o3_amqp::connection::Error>) -> ConnectionFault {
    match ended {
        Ok(()) => ConnectionFault::transient("the broker closed the connection"),
        Err(fe2o3_amqp::connection::Error::RemoteClosedWithError(error)) => closed_fault(&error),
        Err(error) => ConnectionFault::transient(format!("the connection was lost: {error}")),
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
        _ => ConnectionFault::transient(reason),
    }
}

/// Converts an AMQP error; the code is the symbolic error condition.
pub(super) fn rejection(error: &definitions::Error) -> Rejection {
    Rejection {
        code: codec::condition_text(&error.condition),
        reason: error.description.clone().unwrap_or_else(|| "the broker gave no reason".to_owned()),
    }
}

pub(super) fn sender_attach_fault(error: SenderAttachError) -> EndpointFault {
    match error {
        SenderAttachError::RemoteClosedWithError(error)
        | SenderAttachError::SessionStopped(SessionStopReason::RemoteEndedWithError(error)) => {
            EndpointFault::Refused(rejection(&error))
        }
        other => EndpointFault::Broken(format!("the broker did not attach a sender: {other}")),
    }
}

pub(super) fn receiver_attach_fault(error: ReceiverAttachError) -> EndpointFault {
    match error {
        ReceiverAttachError::RemoteClosedWithError(error)
        | ReceiverAttachError::SessionStopped(SessionStopReason::RemoteEndedWithError(error)) => {
            EndpointFault::Refused(rejection(&error))
        }
        other => EndpointFault::Broken(format!("the broker did not attach a receiver: {other}")),
    }
}

pub(super) fn send_fault(error: SendError) -> EndpointFault {
    match error {
        SendError::LinkStateError(state) => state_fault(state),
        other => EndpointFault::Broken(format!("a message could not be sent: {other}")),
    }
}

pub(super) fn recv_fault(error: RecvError) -> EndpointFault {
    match error {
        RecvError::LinkStateError(state) => state_fault(state),
        other => EndpointFault::Broken(format!("a message could not be received: {other}")),
    }
}

pub(super) fn state_fault(state: LinkStateError) -> EndpointFault {
    match state {
        LinkStateError::RemoteClosedWithError(error)
        | LinkStateError::RemoteDetachedWithError(error) => {
            EndpointFault::Refused(rejection(&error))
        }
        // Some brokers end the whole session where one link is refused.
        LinkStateError::SessionStopped(SessionStopReason::RemoteEndedWithError(error)) => {
            EndpointFault::Refused(rejection(&error))
        }
        other => EndpointFault::Broken(format!("the link has ended: {other}")),
    }
}

pub(super) fn settle_fault(error: impl std::fmt::Debug) -> EndpointFault {
    EndpointFault::Broken(format!("a settlement could not be sent: {error:?}"))
}
