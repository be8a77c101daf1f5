//! Clients of a connector's OPC UA server that mean harm, before they have signed in.

mod channel;
mod sign_ins;

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use anyhow::Context as _;
use base64::{Engine as _, engine::general_purpose::STANDARD as BASE64};
pub(super) use channel::Client;
use opcua_stack::opcua::crypto::{SecurityPolicy, X509};
use serde_json::{Value, json};
pub(super) use sign_ins::{guesses_beside_an_honest_sign_in, names_typed_by_mistake};
use testkit::opcua::{
    NO_HEADER, chunk_header, claiming, framed, get_endpoints, hello, nested_header, open_channel,
    opening,
};
use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    net::TcpStream,
    time::timeout,
};

use super::route::Route;
use crate::harness::Api;

/// Time in which the server has to answer or to close.
const PATIENCE: Duration = Duration::from_secs(20);
/// Bytes that a server may take of what was only claimed.
const TAKEN_MAX: usize = 32 << 20;

async fn connect(route: Route) -> anyhow::Result<TcpStream> {
    Ok(route.connect().await?)
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
async fn greeted(route: Route) -> anyhow::Result<TcpStream> {
    let mut stream = connect(route).await?;
    stream.write_all(&hello(&route.opcua_url(), 65_535)).await?;
    anyhow::ensure!(message(&mut stream).await?.starts_with(b"ACKF"), "no acknowledgement");
    Ok(stream)
}

/// Opens a channel without security, as for discovery; returns its id, too.
async fn channel(route: Route) -> anyhow::Result<(TcpStream, u32)> {
    let mut stream = greeted(route).await?;
    stream.write_all(&open_channel()).await?;
    let opened = message(&mut stream).await?;
    anyhow::ensure!(opened.starts_with(b"OPNF") && opened.len() > 12, "no channel");
    let id = u32::from_le_bytes([opened[8], opened[9], opened[10], opened[11]]);
    Ok((stream, id))
}

/// Opens a channel and asks for the endpoints, and returns the time that it took.
pub(super) async fn discover(route: Route) -> anyhow::Result<Duration> {
    let begun = Instant::now();
    let (mut stream, id) = channel(route).await?;
    let url = route.opcua_url();
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
pub(super) async fn claimed_sizes(route: Route) -> anyhow::Result<String> {
    let mut taken = 0;
    for kind in [b"HELF", b"OPNF", b"MSGF"] {
        let mut stream = connect(route).await?;
        stream.write_all(&claiming(kind, u32::MAX)).await?;
        let answer = message(&mut stream).await?;
        anyhow::ensure!(answer.starts_with(b"ERRF"), "not refused: {answer:02x?}");
        let (mut stream, _) = channel(route).await?;
        stream.write_all(&claiming(b"MSGC", u32::MAX)).await?;
        taken = flood(&mut stream, &vec![0; 1 << 20], 2 * TAKEN_MAX).await.max(taken);
    }
    anyhow::ensure!(taken < TAKEN_MAX, "the server took {taken} bytes");
    Ok(format!("refused by their headers, {} MiB taken", taken >> 20))
}

/// Intermediate chunks without end.
pub(super) async fn endless_chunks(route: Route) -> anyhow::Result<String> {
    let (mut stream, id) = channel(route).await?;
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

/// Returns the certificate that the server shows with its endpoints.
async fn server_certificate(route: Route) -> anyhow::Result<X509> {
    let (mut stream, id) = channel(route).await?;
    let url = route.opcua_url();
    stream.write_all(&framed(b"MSGF", &get_endpoints(&url, id, 2, &NO_HEADER))).await?;
    let answer = message(&mut stream).await?;
    // A byte string is its length and its bytes; a certificate is a sequence (0x30) with a length of two bytes (0x82).
    for at in 4..answer.len().saturating_sub(4) {
        let [0x30, 0x82, high, low] = answer[at..at + 4] else { continue };
        let length = usize::from(u16::from_be_bytes([high, low])) + 4;
        let claimed = u32::from_le_bytes(answer[at - 4..at].try_into()?);
        if claimed as usize == length && at + length <= answer.len() {
            let der = &answer[at..at + length];
            return X509::from_der(der).map_err(|error| anyhow::anyhow!("{error}"));
        }
    }
    anyhow::bail!("the endpoints have no certificate")
}

const POLICY: &str = "http://opcfoundation.org/UA/SecurityPolicy#";

/// Sends a request for a channel. Returns the answer and the time that it took.
async fn opened(route: Route, opening: &[u8]) -> anyhow::Result<(Vec<u8>, Duration)> {
    let mut stream = greeted(route).await?;
    let begun = Instant::now();
    stream.write_all(opening).await?;
    Ok((message(&mut stream).await?, begun.elapsed()))
}

/// Requests for channels with PKCS#1 v1.5 and with what was never a policy, of a client that is trusted, and encrypted
/// for the server's key: one answer for all, and never soon. By a policy that is offered the same client gets a channel.
pub(super) async fn deprecated_policies(engineer: Api, route: Route) -> anyhow::Result<String> {
    let server = server_certificate(route).await?;
    let client = Client::named("probe of policies")?;
    trust(&engineer, &client).await?;
    let by = |policy: SecurityPolicy, uri: &str| client.opening(policy, uri, &server);
    let offered = by(SecurityPolicy::Basic256Sha256, SecurityPolicy::Basic256Sha256.to_uri())?;
    let (answer, _) = opened(route, &offered).await?;
    anyhow::ensure!(answer.starts_with(b"OPNF"), "no channel by a policy that is offered");
    let pkcs1 = |name: &str| by(SecurityPolicy::Basic128Rsa15, &format!("{POLICY}{name}"));
    let basic_256 = by(SecurityPolicy::Basic256, &format!("{POLICY}Basic256"))?;
    let noise = opening(&format!("{POLICY}Basic256Sha256"), b"no certificate", &[0; 20], 256);
    let mut answers = Vec::new();
    let mut soonest = Duration::MAX;
    for opening in [pkcs1("Basic128Rsa15")?, basic_256, pkcs1("Nonsense")?, noise] {
        let (answer, took) = opened(route, &opening).await?;
        answers.push(answer);
        soonest = soonest.min(took);
    }
    anyhow::ensure!(answers.iter().all(|answer| answer.starts_with(b"ERRF")), "not refused");
    anyhow::ensure!(answers.windows(2).all(|two| two[0] == two[1]), "the answers differ");
    anyhow::ensure!(soonest >= ANSWERED_AFTER, "answered after {soonest:?}");
    Ok(format!("one refusal for all, after {} ms at the soonest", soonest.as_millis()))
}

/// Pairs of requests, one with a sound padding and one with a broken one, that are compared.
const PAIRS: usize = 24;
/// Time that a refusal takes at least, whatever is wrong.
const ANSWERED_AFTER: Duration = Duration::from_millis(150);
/// Difference between the medians of both kinds, at most. A server that decrypted and answered at once was two thirds
/// of a refusal's time faster or slower; one that answers on a clock of its own differs by the scheduler alone.
const DIFFERENCE_MAX: Duration = Duration::from_millis(30);

/// Requests with a padding that is sound and with one that is not, by turns, by a policy that is not offered and by one
/// that is: neither the answers nor their times show which it was.
pub(super) async fn paddings(engineer: Api, route: Route) -> anyhow::Result<String> {
    let server = server_certificate(route).await?;
    let client = Client::named("probe of paddings")?;
    trust(&engineer, &client).await?;
    let mut differences = Vec::new();
    let offered = SecurityPolicy::Basic256Sha256.to_uri().to_owned();
    for (policy, uri) in [
        (SecurityPolicy::Basic128Rsa15, format!("{POLICY}Basic128Rsa15")),
        (SecurityPolicy::Basic256Sha256, offered),
    ] {
        let mut sound = client.opening(policy, &uri, &server)?;
        let is_offered = policy == SecurityPolicy::Basic256Sha256;
        if is_offered {
            // Well encrypted, and signed by nobody: what is wrong comes to light after the padding.
            sound = client.another("probe of another key")?.forged(policy, &uri, &server)?;
        }
        let mut broken = sound.clone();
        *broken.last_mut().context("a request")? ^= 1;
        let (mut of_sound, mut of_broken) = (Vec::new(), Vec::new());
        for _ in 0..PAIRS {
            let (answer, took) = opened(route, &sound).await?;
            of_sound.push(took);
            let (other, took) = opened(route, &broken).await?;
            of_broken.push(took);
            anyhow::ensure!(
                answer.starts_with(b"ERRF"),
                "a forged request is answered {answer:02x?}"
            );
            anyhow::ensure!(answer == other, "the answers show the padding");
        }
        let (sound, broken) = (median(of_sound), median(of_broken));
        let soonest = sound.min(broken);
        anyhow::ensure!(soonest >= ANSWERED_AFTER, "answered after {soonest:?}");
        let difference = sound.abs_diff(broken);
        anyhow::ensure!(difference <= DIFFERENCE_MAX, "{uri}: {sound:?} against {broken:?}");
        differences.push(format!("{:.1} ms", difference.as_secs_f64() * 1000.0));
    }
    Ok(format!("one answer, medians of {PAIRS} pairs differ by {}", differences.join(" and ")))
}

fn median(mut times: Vec<Duration>) -> Duration {
    times.sort_unstable();
    times.get(times.len() / 2).copied().unwrap_or_default()
}

/// Certificates that are unknown, after one that an engineer denied.
const STRANGERS: usize = 220;

/// Sends many unknown certificates, so that the one that was denied is forgotten: it is not.
pub(super) async fn denied_certificate(engineer: Api, route: Route) -> anyhow::Result<String> {
    let folder = tempfile::tempdir()?;
    let denied = Client::named("probe that is denied")?;
    trust(&engineer, &denied).await?;
    anyhow::ensure!(
        denied.has_session(folder.path(), &route.opcua_url()).await?,
        "not trusted at first"
    );
    let thumbprint = denied.certificate.thumbprint().as_hex_string();
    let path = format!("/api/v1/client-certificates/{thumbprint}");
    let _: Value = engineer.put(&path, &json!({ "isTrusted": false })).await?;
    // Of one key, which is not that of the denied: any other certificate of that is denied, too.
    let strangers = Client::named("probe of a stranger")?;
    for number in 0..STRANGERS {
        let stranger = strangers.another(&format!("stranger {number}"))?;
        let has_session = stranger.has_session(folder.path(), &route.opcua_url()).await?;
        anyhow::ensure!(!has_session, "a stranger got a session");
    }
    anyhow::ensure!(
        !denied.has_session(folder.path(), &route.opcua_url()).await?,
        "the denied got a session"
    );
    let known: Value = engineer.get("/api/v1/client-certificates").await?;
    let shown = known.to_string();
    let is_known = shown.contains("probe that is denied") && shown.contains("stranger");
    anyhow::ensure!(is_known, "the engineer does not see the denied and the strangers: {shown}");
    let count = known["items"].as_array().map_or(0, Vec::len);
    Ok(format!("denied still, after {STRANGERS} strangers; {count} certificates are listed"))
}

/// Comes to an OPC UA server that trusts any certificate, as one in development does. Returns the client, which is let in.
pub(super) async fn comes_in_development(route: Route) -> anyhow::Result<Client> {
    let folder = tempfile::tempdir()?;
    let newcomer = Client::named("probe of development")?;
    let is_in = newcomer.has_session(folder.path(), &route.opcua_url()).await?;
    anyhow::ensure!(is_in, "a server in development lets nobody in");
    Ok(newcomer)
}

/// Comes again after the setting was taken out: nothing of the trust is left.
pub(super) async fn trusted_in_development(
    newcomer: Arc<Client>,
    route: Route,
) -> anyhow::Result<String> {
    let folder = tempfile::tempdir()?;
    let is_in = newcomer.has_session(folder.path(), &route.opcua_url()).await?;
    anyhow::ensure!(!is_in, "who came while all were trusted is trusted still");
    Ok("let in while the setting was on, and not since".to_owned())
}

pub(super) async fn trust(engineer: &Api, client: &Client) -> anyhow::Result<()> {
    let content = BASE64.encode(client.der()?);
    let body = json!({ "kind": "CERTIFICATE", "content": content });
    engineer.post::<Option<Value>>("/api/v1/client-certificates", &body).await.map(drop)
}

/// Values in values in the header of a request that anybody may send.
pub(super) async fn nested_headers(route: Route) -> anyhow::Result<String> {
    let url = route.opcua_url();
    let headers = [
        nested_header(25, &[0x40], 60_000),
        nested_header(23, &[0x01, 23], 30_000),
        nested_header(24, &[24], 60_000),
    ];
    for header in headers {
        let (mut stream, id) = channel(route).await?;
        stream.write_all(&framed(b"MSGF", &get_endpoints(&url, id, 2, &header))).await?;
        refused(&message(&mut stream).await?)?;
    }
    Ok("answered with an error each".to_owned())
}

/// Fails unless an answer is an error, or a fault of the service.
fn refused(answer: &[u8]) -> anyhow::Result<()> {
    // Behind the headers of message, channel and sequence: ServiceFault_Encoding_DefaultBinary.
    let is_fault = answer.get(24..28) == Some(&[1, 0, 0x8D, 0x01]);
    anyhow::ensure!(answer.starts_with(b"ERRF") || is_fault, "not refused: {answer:02x?}");
    Ok(())
}

/// Arguments in the header of a request whose value rank claims gigabytes of dimensions.
pub(super) async fn claimed_ranks(route: Route) -> anyhow::Result<String> {
    let url = route.opcua_url();
    for rank in [1_000_000, 0x14A9_0000, i32::MAX] {
        // No name, no data type, the rank, no dimension, no description.
        let mut argument = vec![0xFF, 0xFF, 0xFF, 0xFF, 0, 0];
        argument.extend(rank.to_le_bytes());
        argument.extend([0, 0, 0, 0, 0]);
        // Argument_Encoding_DefaultBinary.
        let mut header = vec![1, 0];
        header.extend(298_u16.to_le_bytes());
        header.push(1);
        header.extend(u32::try_from(argument.len())?.to_le_bytes());
        header.extend(argument);
        let (mut stream, id) = channel(route).await?;
        stream.write_all(&framed(b"MSGF", &get_endpoints(&url, id, 2, &header))).await?;
        refused(&message(&mut stream).await?)?;
    }
    Ok("answered with an error each".to_owned())
}
