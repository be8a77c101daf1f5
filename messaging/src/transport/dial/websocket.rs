//! Connection to a broker inside a WebSocket.

use websocket::{ConnectError, Endpoint, Subprotocol};

use super::{super::connection::ConnectionFault, stream::Stream};
use crate::config::BrokerUrl;

/// Most broker messages of the largest size in one message of the WebSocket.
const MESSAGES_TOGETHER_MAX: u64 = 4;

/// Opens a WebSocket to the broker on a stream to its HTTP server.
pub(super) async fn open(
    stream: Box<dyn Stream>,
    broker: &BrokerUrl,
    path: &str,
    message_bytes_max: u64,
) -> Result<Box<dyn Stream>, ConnectionFault> {
    let subprotocol = if broker.is_mqtt() { Subprotocol::Mqtt } else { Subprotocol::Amqp };
    let endpoint = Endpoint { authority: &broker.http_authority(), path };
    let bytes_max = usize::try_from(message_bytes_max.saturating_mul(MESSAGES_TOGETHER_MAX))
        .unwrap_or(usize::MAX);
    match websocket::connect(stream, endpoint, subprotocol, bytes_max).await {
        Ok(stream) => Ok(Box::new(stream)),
        Err(error) => Err(fault(broker, path, &error)),
    }
}

fn fault(broker: &BrokerUrl, path: &str, error: &ConnectError) -> ConnectionFault {
    let server = broker.http_authority();
    match error {
        ConnectError::Refused { status: status @ (408 | 425 | 429 | 500..) } => {
            ConnectionFault::transient(format!(
                "{server} answered {status} instead of opening a WebSocket"
            ))
        }
        ConnectError::Refused { status } => ConnectionFault::permanent(format!(
            "{server} answered {status} instead of opening a WebSocket; is the path {path} right?"
        )),
        ConnectError::Subprotocol { subprotocol } => ConnectionFault::permanent(format!(
            "{server} has a WebSocket at {path}, but not for {subprotocol}; are path and scheme right?"
        )),
        ConnectError::Protocol { reason } => ConnectionFault::permanent(format!(
            "{server} does not answer like a WebSocket server: {reason}; is the port right?"
        )),
        ConnectError::Address { .. } => ConnectionFault::permanent(error.to_string()),
        ConnectError::Io(cause) => {
            ConnectionFault::transient(format!("{server} broke off: {cause}"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_that_need_a_person_are_permanent() {
        let broker: BrokerUrl = "amqp+wss://broker.example/ws".parse().expect("an address");
        let refused = |status| ConnectError::Refused { status };
        for (error, is_permanent, words) in [
            (refused(503), false, "answered 503"),
            (refused(429), false, "answered 429"),
            (refused(404), true, "is the path /ws right?"),
            (refused(301), true, "is the path /ws right?"),
            (ConnectError::Subprotocol { subprotocol: Subprotocol::Amqp }, true, "not for amqp"),
            (ConnectError::Protocol { reason: "no HTTP".to_owned() }, true, "is the port right?"),
            (ConnectError::Io(std::io::ErrorKind::ConnectionReset.into()), false, "broke off"),
        ] {
            let fault = fault(&broker, "/ws", &error);
            assert_eq!(fault.is_permanent, is_permanent, "{error:?}");
            assert!(
                fault.reason.contains(words) && fault.reason.contains("broker.example"),
                "{}",
                fault.reason
            );
        }
    }
}
