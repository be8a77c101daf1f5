//! Handshakes that succeed, and the errors of the others.

use std::io::ErrorKind;

use tokio::io::{AsyncReadExt, AsyncWriteExt, DuplexStream, duplex};
use websocket::{AcceptError, ConnectError, Endpoint, Subprotocol, accept, connect};

use crate::raw::{ACCEPT, head, request};

const LIMIT: usize = 64 * 1024;

/// Connects to a server with a fixed answer. Returns the request and the client's result.
async fn connected(answer: &str) -> (String, Result<(), ConnectError>) {
    let (client, mut server) = duplex(64 * 1024);
    let answering = async {
        let request = head(&mut server).await;
        server.write_all(answer.as_bytes()).await.expect("written");
        drop(server);
        request
    };
    let endpoint = Endpoint { authority: "[::1]:8443", path: "/amqp?tenant=a" };
    let (request, opened) =
        tokio::join!(answering, connect(client, endpoint, Subprotocol::Amqp, LIMIT));
    (request, opened.map(drop))
}

#[tokio::test]
async fn the_client_requests_path_and_subprotocol_and_reports_the_answer() {
    let (request, refused) = connected("HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n").await;
    assert!(request.starts_with("GET /amqp?tenant=a HTTP/1.1\r\n"), "{request}");
    let lines = request.to_ascii_lowercase();
    for line in [
        "host: [::1]:8443",
        "upgrade: websocket",
        "sec-websocket-version: 13",
        "sec-websocket-protocol: amqp",
    ] {
        assert!(lines.contains(&format!("\r\n{line}\r\n")), "{line} in {request}");
    }
    assert!(!lines.contains("sec-websocket-extensions"), "{request}");
    assert!(matches!(refused, Err(ConnectError::Refused { status: 404 })), "{refused:?}");

    for (answer, is_expected) in [
        (
            "HTTP/1.1 503 Busy\r\nContent-Length: 4\r\n\r\nbusy",
            (|e| matches!(e, ConnectError::Refused { status: 503 })) as fn(&ConnectError) -> bool,
        ),
        ("SSH-2.0-OpenSSH_9.2\r\n\r\n", |e| matches!(e, ConnectError::Protocol { .. })),
        (
            "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: AAAA\r\n\r\n",
            |e| matches!(e, ConnectError::Protocol { .. }),
        ),
        (
            "HTTP/1.1 101 Swi",
            |e| matches!(e, ConnectError::Io(error) if error.kind() == ErrorKind::UnexpectedEof),
        ),
        ("", |e| matches!(e, ConnectError::Io(error) if error.kind() == ErrorKind::UnexpectedEof)),
    ] {
        let (_, opened) = connected(answer).await;
        let error = opened.expect_err(answer);
        assert!(is_expected(&error), "{answer}: {error:?}");
    }
}

#[tokio::test]
async fn a_server_that_agrees_to_nothing_or_to_something_else_is_left() {
    for (agreed, is_ours) in [
        ("", false),
        ("Sec-WebSocket-Protocol: mqtt\r\n", false),
        ("Sec-WebSocket-Protocol: amqp\r\n", true),
    ] {
        let (client, server) = duplex(64 * 1024);
        let endpoint = Endpoint { authority: "broker.example", path: "/" };
        let opening = connect(client, endpoint, Subprotocol::Amqp, LIMIT);
        let (opened, ()) = tokio::join!(opening, agreeing_to(server, agreed));
        match opened {
            Ok(_) => assert!(is_ours, "{agreed}"),
            Err(ConnectError::Subprotocol { subprotocol: Subprotocol::Amqp }) => {
                assert!(!is_ours, "{agreed}")
            }
            Err(other) => panic!("{agreed}: {other:?}"),
        }
    }
}

/// A server whose answer is right but for the subprotocol that it says.
async fn agreeing_to(mut client: DuplexStream, agreed: &str) {
    let request = head(&mut client).await;
    let (mut true_client, server) = duplex(64 * 1024);
    true_client.write_all(request.as_bytes()).await.expect("written");
    let (answer, _accepted) =
        tokio::join!(head(&mut true_client), accept(server, Subprotocol::Amqp, LIMIT));
    let is_kept = |line: &&str| {
        !line.is_empty() && !line.to_ascii_lowercase().starts_with("sec-websocket-protocol:")
    };
    let kept: String = answer.lines().filter(is_kept).map(|line| format!("{line}\r\n")).collect();
    client.write_all(format!("{kept}{agreed}\r\n").as_bytes()).await.expect("written");
}

#[tokio::test]
async fn the_server_takes_its_own_subprotocol_from_what_is_offered() {
    for (offers, is_taken) in [
        ("Sec-WebSocket-Protocol: amqp\r\n", true),
        ("Sec-WebSocket-Protocol: binary, AMQPWSB10,amqp\r\n", true),
        ("Sec-WebSocket-Protocol: mqtt\r\nSec-WebSocket-Protocol: amqp\r\n", true),
        ("Sec-WebSocket-Protocol: amqp\r\nSec-WebSocket-Extensions: permessage-deflate\r\n", true),
        ("Sec-WebSocket-Protocol: mqtt\r\n", false),
        ("Sec-WebSocket-Protocol: amqps, xamqp\r\n", false),
        ("", false),
    ] {
        let (mut client, server) = duplex(64 * 1024);
        let accepting = tokio::spawn(accept(server, Subprotocol::Amqp, LIMIT));
        client.write_all(request(offers).as_bytes()).await.expect("written");
        let answer = head(&mut client).await;
        let accepted = accepting.await.expect("no panic");
        if is_taken {
            assert!(answer.starts_with("HTTP/1.1 101 "), "{offers}: {answer}");
            assert!(answer.contains(ACCEPT), "{answer}");
            assert!(
                answer.to_ascii_lowercase().contains("\r\nsec-websocket-protocol: amqp\r\n"),
                "{answer}"
            );
            assert!(!answer.to_ascii_lowercase().contains("extensions"), "{answer}");
            accepted.expect(offers);
        } else {
            assert!(answer.starts_with("HTTP/1.1 400 "), "{offers}: {answer}");
            assert!(matches!(accepted, Err(AcceptError::Subprotocol { .. })), "{accepted:?}");
        }
    }
}

#[tokio::test]
async fn a_request_that_is_not_for_a_websocket_is_refused() {
    let long = format!("GET /{} HTTP/1.1\r\n", "x".repeat(200_000));
    let headers = format!("GET / HTTP/1.1\r\n{}\r\n", "A: b\r\n".repeat(500));
    for rubbish in [
        "GET / HTTP/1.1\r\nHost: a\r\n\r\n",
        "POST / HTTP/1.1\r\nHost: a\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\r\n",
        "AMQP\0\u{1}\0\0 and so on",
        &long,
        &headers,
    ] {
        let (mut client, server) = duplex(1 << 20);
        client.write_all(rubbish.as_bytes()).await.expect("written");
        client.shutdown().await.expect("shut down");
        let error = accept(server, Subprotocol::Amqp, LIMIT).await.expect_err("no WebSocket");
        let start: String = rubbish.chars().take(40).collect();
        assert!(
            matches!(error, AcceptError::Protocol { .. } | AcceptError::Io(_)),
            "{start}: {error:?}"
        );
        let mut answer = Vec::new();
        client.read_to_end(&mut answer).await.expect("the end");
        assert!(!answer.starts_with(b"HTTP/1.1 101"), "{start}");
    }
}
