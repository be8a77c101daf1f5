//! Clients of a connector's OPC UA server that mean harm, before they have signed in.

use std::time::{Duration, Instant};

use anyhow::Context as _;
use testkit::opcua::{
    NO_HEADER, chunk_header, claiming, framed, get_endpoints, hello, nested_header, open_channel,
    opening,
};
use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    net::TcpStream,
    time::timeout,
};

/// Time in which the server has to answer or to close.
const PATIENCE: Duration = Duration::from_secs(20);
/// Bytes that a server may take of what was only claimed.
const TAKEN_MAX: usize = 32 << 20;

async fn connect(port: u16) -> anyhow::Result<TcpStream> {
    Ok(TcpStream::connect(("127.0.0.1", port)).await?)
}

/// Reads one message of the server.
async fn message(stream: &mut TcpStream) -> anyhow::Result<Vec<u8>> {
    let reading = async {
        let mut head = [0; 8];
        stream.read_exact(&mut head).await?;
        let length = u32::from_le_bytes([head[4], head[5], head[6], head[7]]);
        let mut body = vec![0; (length as usize).saturating_sub(8)];
        stream.read_exact(&mut body).await?;
        anyhow::Ok([&head[..], &body].concat())
    };
    timeout(PATIENCE, reading).await.context("no answer")?
}

/// Says hello.
async fn greeted(port: u16) -> anyhow::Result<TcpStream> {
    let mut stream = connect(port).await?;
    stream.write_all(&hello(&format!("opc.tcp://127.0.0.1:{port}"), 65_535)).await?;
    anyhow::ensure!(message(&mut stream).await?.starts_with(b"ACKF"), "no acknowledgement");
    Ok(stream)
}

/// Opens a channel without security, as for discovery; returns its id, too.
async fn channel(port: u16) -> anyhow::Result<(TcpStream, u32)> {
    let mut stream = greeted(port).await?;
    stream.write_all(&open_channel()).await?;
    let opened = message(&mut stream).await?;
    anyhow::ensure!(opened.starts_with(b"OPNF") && opened.len() > 12, "no channel");
    let id = u32::from_le_bytes([opened[8], opened[9], opened[10], opened[11]]);
    Ok((stream, id))
}

/// Opens a channel and asks for the endpoints, and returns the time that it took.
pub(super) async fn discover(port: u16) -> anyhow::Result<Duration> {
    let begun = Instant::now();
    let (mut stream, id) = channel(port).await?;
    let url = format!("opc.tcp://127.0.0.1:{port}");
    stream.write_all(&framed(b"MSGF", &get_endpoints(&url, id, 2, &NO_HEADER))).await?;
    anyhow::ensure!(message(&mut stream).await?.starts_with(b"MSG"), "no endpoints");
    Ok(begun.elapsed())
}

/// Writes blocks until the server reads no more. Returns the number of bytes that it took.
async fn flood(stream: &mut TcpStream, block: &[u8], most: usize) -> usize {
    let mut taken = 0;
    while taken < most {
        match timeout(Duration::from_secs(3), stream.write_all(block)).await {
            Ok(Ok(())) => taken += block.len(),
            _ => break,
        }
    }
    taken
}

/// Messages that claim four gigabytes.
pub(super) async fn claimed_sizes(port: u16) -> anyhow::Result<String> {
    let mut taken = 0;
    for kind in [b"HELF", b"OPNF", b"MSGF"] {
        let mut stream = connect(port).await?;
        stream.write_all(&claiming(kind, u32::MAX)).await?;
        let answer = message(&mut stream).await?;
        anyhow::ensure!(answer.starts_with(b"ERRF"), "not refused: {answer:02x?}");
        let (mut stream, _) = channel(port).await?;
        stream.write_all(&claiming(b"MSGC", u32::MAX)).await?;
        taken = flood(&mut stream, &vec![0; 1 << 20], 2 * TAKEN_MAX).await.max(taken);
    }
    anyhow::ensure!(taken < TAKEN_MAX, "the server took {taken} bytes");
    Ok(format!("refused by their headers, {} MiB taken", taken >> 20))
}

/// Intermediate chunks without end.
pub(super) async fn endless_chunks(port: u16) -> anyhow::Result<String> {
    let (mut stream, id) = channel(port).await?;
    let mut taken = 0;
    for sequence in 2..1002_u32 {
        let mut body = chunk_header(id, sequence, 2);
        body.resize(60_000, 0);
        if flood(&mut stream, &framed(b"MSGC", &body), 1).await == 0 {
            break;
        }
        taken += 1;
    }
    anyhow::ensure!(taken < 1000, "all of {taken} chunks were taken");
    Ok(format!("closed after {taken} chunks"))
}

/// Requests for channels with PKCS#1 v1.5 and with what was never a policy: one answer for all, and never soon.
pub(super) async fn deprecated_policies(port: u16) -> anyhow::Result<String> {
    let mut answers = Vec::new();
    let mut soonest = Duration::MAX;
    for policy in ["Basic128Rsa15", "Basic256", "Nonsense", "Basic256Sha256"] {
        let uri = format!("http://opcfoundation.org/UA/SecurityPolicy#{policy}");
        let mut stream = greeted(port).await?;
        let begun = Instant::now();
        stream.write_all(&opening(&uri, b"no certificate", &[0; 20], 256)).await?;
        answers.push(message(&mut stream).await?);
        soonest = soonest.min(begun.elapsed());
    }
    anyhow::ensure!(answers.iter().all(|answer| answer.starts_with(b"ERRF")), "not refused");
    anyhow::ensure!(answers.windows(2).all(|two| two[0] == two[1]), "the answers differ");
    anyhow::ensure!(soonest >= Duration::from_millis(150), "answered after {soonest:?}");
    Ok(format!("one refusal for all, after {} ms at the soonest", soonest.as_millis()))
}

/// Values in values in the header of a request that anybody may send.
pub(super) async fn nested_headers(port: u16) -> anyhow::Result<String> {
    let url = format!("opc.tcp://127.0.0.1:{port}");
    let headers = [
        nested_header(25, &[0x40], 60_000),
        nested_header(23, &[0x01, 23], 30_000),
        nested_header(24, &[24], 60_000),
    ];
    for header in headers {
        let (mut stream, id) = channel(port).await?;
        stream.write_all(&framed(b"MSGF", &get_endpoints(&url, id, 2, &header))).await?;
        message(&mut stream).await?;
    }
    Ok("answered with an error each".to_owned())
}
