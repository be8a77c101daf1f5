//! The command `enrol`, as a process of its own: what it takes from its environment, and what it says.

use std::{
    io::{ErrorKind, Read as _, Write as _},
    net::{SocketAddr, TcpListener},
    process::{Command, Output},
    thread,
};

const PROXY_VARIABLES: [&str; 6] =
    ["HTTP_PROXY", "http_proxy", "HTTPS_PROXY", "https_proxy", "ALL_PROXY", "all_proxy"];

/// Answers one enrolment, and returns what was sent.
fn platform() -> (SocketAddr, thread::JoinHandle<String>) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("bound");
    let answered = thread::spawn(move || {
        let (mut stream, _) = listener.accept().expect("a connector");
        let (mut request, mut part) = (String::new(), [0; 4096]);
        while !request.ends_with('}') {
            let length = stream.read(&mut part).expect("a request");
            assert!(length > 0, "it ended in {request}");
            request.push_str(std::str::from_utf8(&part[..length]).expect("text"));
        }
        let body = serde_json::json!({
            "factoryId": "F", "brokerUrl": "amqps://broker.example", "profile": "embedded",
            "userName": "factory.F", "password": "canary", "rootCertificatePem": null,
        })
        .to_string();
        let length = body.len();
        let head = "HTTP/1.1 201 Created\r\nconnection: close\r\ncontent-type: application/json";
        write!(stream, "{head}\r\ncontent-length: {length}\r\n\r\n{body}").expect("answered");
        request
    });
    (address, answered)
}

/// Enrols with a token that names no certificate, in an environment that names a proxy.
fn enrol(platform: &str, proxy: SocketAddr) -> Output {
    let folder = tempfile::tempdir().expect("a folder");
    let (config, token) = (folder.path().join("connector.toml"), folder.path().join("token"));
    let data = folder.path().join("data");
    std::fs::write(&config, format!("data_directory = {data:?}\n")).expect("written");
    std::fs::write(&token, "the-secret").expect("written");
    let mut command = Command::new(env!("CARGO_BIN_EXE_factory-connector"));
    command.arg("--config").arg(config).args(["enrol", "--platform", platform]);
    command.arg("--token-file").arg(token).env_remove("NO_PROXY").env_remove("no_proxy");
    for name in PROXY_VARIABLES {
        command.env(name, format!("http://{proxy}"));
    }
    command.output().expect("it runs")
}

/// A proxy that takes connections and answers nobody.
fn proxy() -> (TcpListener, SocketAddr) {
    let proxy = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = proxy.local_addr().expect("bound");
    (proxy, address)
}

#[test]
fn no_proxy_of_the_environment_gets_a_token_in_clear() {
    let (proxy, proxy_address) = proxy();
    let (address, answered) = platform();
    let output = enrol(&format!("http://{address}"), proxy_address);
    let complaint = String::from_utf8_lossy(&output.stderr);
    // First, since a platform that nobody reached waits for ever.
    proxy.set_nonblocking(true).expect("ours");
    let met = proxy.accept().map(drop).map_err(|error| error.kind());
    assert_eq!(met, Err(ErrorKind::WouldBlock), "the proxy was reached");
    assert!(output.status.success(), "{complaint}");
    assert!(answered.join().expect("answered").contains("the-secret"));
    assert!(
        !complaint.contains("names no certificate"),
        "on this machine it needs none: {complaint}"
    );
}

#[test]
fn a_token_that_names_no_certificate_is_called_so_before_it_is_sent() {
    let (closed, address) = proxy();
    drop(closed);
    let output = enrol(&format!("https://{address}"), address);
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success(), "nobody is there");
    assert!(complaint.contains("web.public_certificate"), "{complaint}");
    let said = complaint.find("names no certificate").expect("it is said");
    let failed = complaint.find("reaching the platform").expect("it was tried");
    assert!(said < failed, "{complaint}");
}
