//! A tunnel through an HTTP proxy: CONNECT (RFC 9110 §9.3.6) with Basic credentials (RFC 7617).

use base64::{Engine, engine::general_purpose::STANDARD};
use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    net::TcpStream,
};
use zeroize::Zeroizing;

use super::super::connection::ConnectionFault;
use crate::config::HttpProxy;

/// Longest answer of a proxy, in bytes.
const ANSWER_BYTES_MAX: usize = 16 * 1024;

/// Makes the proxy at the other end of the stream connect to a host.
pub(super) async fn tunnel(
    mut tcp: TcpStream,
    proxy: &HttpProxy,
    host: &str,
    port: u16,
) -> Result<TcpStream, ConnectionFault> {
    let broken = |e: std::io::Error| {
        ConnectionFault::transient(format!("the proxy {} broke off: {e}", proxy.host))
    };
    tcp.write_all(request(proxy, host, port).as_bytes()).await.map_err(broken)?;
    let mut answer = Vec::with_capacity(512);
    while !answer.ends_with(b"\r\n\r\n") {
        if answer.len() >= ANSWER_BYTES_MAX {
            return Err(ConnectionFault::transient(format!(
                "the proxy {} does not end its answer",
                proxy.host
            )));
        }
        // Byte by byte: the bytes after the answer belong to the broker.
        answer.push(tcp.read_u8().await.map_err(broken)?);
    }
    match status(&answer) {
        Some(200..=299) => Ok(tcp),
        Some(407) => Err(ConnectionFault::permanent(format!(
            "the proxy {} refused the user or password",
            proxy.host
        ))),
        Some(403) => Err(ConnectionFault::permanent(format!(
            "the proxy {} does not permit {host}:{port}",
            proxy.host
        ))),
        Some(code) => {
            Err(ConnectionFault::transient(format!("the proxy {} answered {code}", proxy.host)))
        }
        None => Err(ConnectionFault::permanent(format!(
            "{} does not answer like an HTTP proxy",
            proxy.host
        ))),
    }
}

fn request(proxy: &HttpProxy, host: &str, port: u16) -> Zeroizing<String> {
    let target =
        if host.contains(':') { format!("[{host}]:{port}") } else { format!("{host}:{port}") };
    let authorization = proxy.login.as_ref().map_or_else(String::new, |login| {
        let pair = Zeroizing::new(format!("{}:{}", login.user_name, login.password.as_str()));
        format!("Proxy-Authorization: Basic {}\r\n", STANDARD.encode(pair.as_bytes()))
    });
    Zeroizing::new(format!("CONNECT {target} HTTP/1.1\r\nHost: {target}\r\n{authorization}\r\n"))
}

/// Parses the status code of an answer.
fn status(answer: &[u8]) -> Option<u16> {
    let line = std::str::from_utf8(answer).ok()?.lines().next()?;
    let mut words = line.split(' ');
    words.next()?.strip_prefix("HTTP/1.")?;
    words.next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Login;

    #[test]
    fn the_request_names_target_and_user() {
        let proxy =
            HttpProxy::new("http://proxy.plant:3128", Some(Login::new("u", "p"))).expect("a proxy");
        assert_eq!(
            request(&proxy, "broker.example", 5671).as_str(),
            "CONNECT broker.example:5671 HTTP/1.1\r\nHost: broker.example:5671\r\nProxy-Authorization: Basic dTpw\r\n\r\n"
        );
        assert!(request(&proxy, "::1", 1).starts_with("CONNECT [::1]:1 "));
    }

    #[test]
    fn answers_are_understood() {
        for (answer, expected) in [
            ("HTTP/1.1 200 Connection established\r\n\r\n", Some(200)),
            ("HTTP/1.0 407 Proxy Authentication Required\r\n\r\n", Some(407)),
            ("SSH-2.0-OpenSSH\r\n\r\n", None),
            ("HTTP/1.1\r\n\r\n", None),
        ] {
            assert_eq!(status(answer.as_bytes()), expected, "{answer}");
        }
    }
}
