//! A client that sends any bytes to the web server, for the fuzz target and for the test that replays its
//! corpus.

use std::{
    io::{Read as _, Write as _},
    net::{Shutdown, SocketAddr, TcpStream},
    sync::OnceLock,
    time::Duration,
};

use axum::{Router, extract::DefaultBodyLimit, http::StatusCode, routing::post};
use daemon::web::{
    ApiJson, ApiPath, ApiQuery,
    server::{self, ListenerLimits},
    session::{PasswordChange, SecondFactorBegin, SecondFactorCode, SecondFactorRemoval, SignIn},
};
use tokio::runtime::Runtime;
use tokio_util::sync::CancellationToken;

/// Time for a connection to end after its client has.
const END_TIMEOUT: Duration = Duration::from_secs(20);
/// Largest body that is taken: less than the largest input, so that larger ones are sent, too.
const BODY_BYTES_MAX: usize = 1024;
/// Paths of operations with a body each.
const PATHS: [&str; 5] = ["/sign-in", "/password", "/begin", "/code", "/removal"];

/// Filter and page, as lists have them.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "what counts is that it is read")]
struct Query {
    limit: Option<u32>,
    text: Option<String>,
    newest: Option<bool>,
}

/// Sends bytes as one client. The first byte says if they are a connection's, or the body or the path of a
/// request.
pub fn client(bytes: &[u8]) {
    static SERVER: OnceLock<(Runtime, SocketAddr)> = OnceLock::new();
    let (_, address) = SERVER.get_or_init(start);
    let Some((mode, rest)) = bytes.split_first() else { return };
    let path = PATHS[usize::from(*mode >> 2) % PATHS.len()];
    let head = |path: &str, length: usize| {
        format!(
            "POST {path} HTTP/1.1\r\nHost: h\r\nContent-Type: application/json\r\nConnection: close\r\n\
             Content-Length: {length}\r\n\r\n"
        )
    };
    let sent = match mode & 3 {
        0 | 1 => [head(path, rest.len()).as_bytes(), rest].concat(),
        2 => {
            // Bytes that end a path end the request.
            let path: String = rest.iter().map(|byte| char::from(*byte)).collect();
            head(&format!("/list/{path}"), 0).into_bytes()
        }
        _ => rest.to_vec(),
    };
    let answers = talk(*address, &sent);
    for line in answers.split(|byte| *byte == b'\n') {
        assert!(!line.starts_with(b"HTTP/1.1 5"), "{}", String::from_utf8_lossy(&answers));
    }
}

fn talk(address: SocketAddr, sent: &[u8]) -> Vec<u8> {
    let mut stream = TcpStream::connect(address).expect("it listens");
    stream.set_read_timeout(Some(END_TIMEOUT)).expect("set");
    // Ports of closed connections must not run out.
    rustix::net::sockopt::set_socket_linger(&stream, Some(Duration::ZERO)).expect("set");
    // The server may have closed before all was sent.
    let _ = stream.write_all(sent);
    let _ = stream.shutdown(Shutdown::Write);
    let mut answers = Vec::new();
    match stream.read_to_end(&mut answers) {
        Err(error) if error.kind() == std::io::ErrorKind::WouldBlock => {
            panic!("a connection ends with its client")
        }
        _ => answers,
    }
}

fn start() -> (Runtime, SocketAddr) {
    let runtime = Runtime::new().expect("a runtime");
    let router = Router::new()
        .route("/sign-in", post(async |_: ApiJson<SignIn>| StatusCode::NO_CONTENT))
        .route("/password", post(async |_: ApiJson<PasswordChange>| StatusCode::NO_CONTENT))
        .route("/begin", post(async |_: ApiJson<SecondFactorBegin>| StatusCode::NO_CONTENT))
        .route("/code", post(async |_: ApiJson<SecondFactorCode>| StatusCode::NO_CONTENT))
        .route("/removal", post(async |_: ApiJson<SecondFactorRemoval>| StatusCode::NO_CONTENT))
        .route(
            "/list/{number}/{name}",
            post(async |_: ApiPath<(u16, String)>, _: ApiQuery<Query>| StatusCode::NO_CONTENT),
        )
        .layer(DefaultBodyLimit::max(BODY_BYTES_MAX));
    let address = runtime.block_on(async {
        let listener = server::listen(([127, 0, 0, 1], 0).into()).await.expect("a free port");
        let address = listener.local_addr().expect("bound");
        let (limits, shutdown) = (ListenerLimits::default(), CancellationToken::new());
        tokio::spawn(server::serve(listener, None, router, limits, shutdown));
        address
    });
    (runtime, address)
}
