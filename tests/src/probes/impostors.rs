//! Machines and brokers that mean harm to a connector that calls them, and machines that nobody has approved.

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    time::Duration,
};

use anyhow::Context as _;
use serde_json::{Value, json};
use testkit::{
    amqp::{AMQP, AMQP_HEADER, SASL, SASL_HEADER, described, entry, frame, nested, string, symbol},
    opcua::{claiming, framed},
};
use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    net::{TcpListener, TcpStream},
    time::timeout,
};
use tokio_util::task::AbortOnDropHandle;

use super::{
    amqp, files,
    plant::source_is,
    process::{Memory, mib},
};
use crate::{
    harness::{Api, Daemon, DaemonCommand, binary, eventually, write_private},
    world::{ENGINEER, PASSWORD},
};

const PATIENCE: Duration = Duration::from_secs(60);
/// Bytes that a client may take of what was only claimed.
const TAKEN_MAX: usize = 32 << 20;
/// Growth of a connector by what a broker claims, at most, and its memory.
const GROWTH_MAX: u64 = 96 << 20;
const MEMORY_MAX: u64 = 512 << 20;
/// Nesting of values in frames.
const LEVELS: usize = 30_000;

/// A program that lives as long as a probe.
fn started(name: &str, program: &str, arguments: &[&str], folder: &Path) -> anyhow::Result<Daemon> {
    Daemon::start(DaemonCommand {
        name: name.to_owned(),
        program: binary(program)?,
        arguments: arguments.iter().map(|&argument| argument.to_owned()).collect(),
        environment: Vec::new(),
        log: folder.join(format!("{name}.log")),
    })
}

async fn add_source(engineer: &Api, id: &str, port: u16, settings: Value) -> anyhow::Result<()> {
    let mut source = json!({ "sourceId": id, "name": id,
        "endpointUrl": format!("opc.tcp://127.0.0.1:{port}") });
    for (name, value) in settings.as_object().into_iter().flatten() {
        source[name] = value.clone();
    }
    engineer.post::<Value>("/api/v1/sources", &source).await.map(drop)
}

async fn remove_source(engineer: &Api, id: &str) -> anyhow::Result<()> {
    engineer.delete::<Value>(&format!("/api/v1/sources/{id}")).await.map(drop)
}

/// Answers a connector as a machine that claims gigabytes in its first message, and in the one that opens the channel.
pub(super) async fn claims_of_a_machine(engineer: Api) -> anyhow::Result<String> {
    const ID: &str = "ProbeImpostor";
    let listener = TcpListener::bind(("127.0.0.1", 0)).await?;
    let port = listener.local_addr()?.port();
    let (connections, most) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicUsize::new(0)));
    let (counted, taken) = (Arc::clone(&connections), Arc::clone(&most));
    let impostor = tokio::spawn(async move {
        while let Ok((stream, _)) = listener.accept().await {
            let number = counted.fetch_add(1, Ordering::Relaxed);
            let took = lie_to_a_client(stream, number).await;
            taken.fetch_max(took, Ordering::Relaxed);
        }
    });
    let _impostor = AbortOnDropHandle::new(impostor);
    add_source(&engineer, ID, port, json!({ "security": { "choice": "none" } })).await?;
    let seen = eventually("the connector calls the impostor", PATIENCE, || {
        let count = connections.load(Ordering::Relaxed);
        std::future::ready(if count > 3 { Ok(count) } else { Err(format!("{count} times")) })
    })
    .await;
    remove_source(&engineer, ID).await?;
    let (seen, taken) = (seen?, most.load(Ordering::Relaxed));
    anyhow::ensure!(taken < TAKEN_MAX, "the connector took {} MiB", taken >> 20);
    Ok(format!("{seen} calls, {} KiB taken of 4 GiB at most", taken >> 10))
}

/// Claims four gigabytes, and sends on until the client reads no more. Returns the number of bytes that it took.
async fn lie_to_a_client(mut stream: TcpStream, number: usize) -> usize {
    let mut hello = [0; 4096];
    if !matches!(timeout(PATIENCE, stream.read(&mut hello)).await, Ok(Ok(1..))) {
        return 0;
    }
    let kind: &[u8; 4] = match number % 3 {
        0 => b"ACKF",
        1 => b"ERRF",
        _ => {
            // A hello is answered as it should be; what claims is the answer to the next message.
            let body: Vec<u8> =
                [0, 65_535, 65_535, 0, 0_u32].iter().flat_map(|n| n.to_le_bytes()).collect();
            if stream.write_all(&framed(b"ACKF", &body)).await.is_err()
                || !matches!(timeout(PATIENCE, stream.read(&mut hello)).await, Ok(Ok(1..)))
            {
                return 0;
            }
            b"OPNF"
        }
    };
    let (block, mut taken) = (vec![0; 1 << 20], 0);
    if stream.write_all(&claiming(kind, u32::MAX)).await.is_err() {
        return 0;
    }
    while taken < 2 * TAKEN_MAX {
        match timeout(Duration::from_secs(3), stream.write(&block)).await {
            Ok(Ok(written)) => taken += written,
            _ => break,
        }
    }
    taken
}

/// Lets a connector read a machine whose certificate nobody has approved, then approves it, and takes that back; and
/// signs in with a password where the way is not protected.
pub(super) async fn unapproved_machine(engineer: Api, folder: PathBuf) -> anyhow::Result<String> {
    const ID: &str = "ProbeMachine";
    let [port, open, control] = free_ports::reserve()?;
    let config = folder.join("machines-of-probes.toml");
    let text = format!(
        "seed = 1\nhost = \"127.0.0.1\"\ncontrol = \"127.0.0.1:{control}\"\npki_directory = \"{pki}\"\n\
         \n[[machines]]\nname = \"Closed\"\nkind = \"conveyor\"\nport = {port}\n\
         security = {{ unprotected = false, protected = true }}\n\
         \n[[machines]]\nname = \"Open\"\nkind = \"conveyor\"\nport = {open}\n\
         security = {{ unprotected = true, protected = false, \
         users = [{{ name = \"probe\", password = \"a password in clear\" }}] }}\n",
        pki = folder.join("machines-of-probes").display(),
    );
    write_private(&config, &text)?;
    let arguments = ["--config", &config.display().to_string()];
    let mut machines = started("machines-of-probes", "simulator", &arguments, &folder)?;
    let outcome = async {
        approve_and_take_back(&engineer, ID, port).await?;
        in_the_clear(&engineer, open).await
    }
    .await;
    machines.stop(Duration::from_secs(15))?;
    outcome?;
    Ok("not read before the approval, nor after its end; no password in the clear".to_owned())
}

async fn approve_and_take_back(engineer: &Api, id: &str, port: u16) -> anyhow::Result<()> {
    let untrusted = |state: &str, kind: &str| {
        state == "waiting" && kind.eq_ignore_ascii_case("serverCertificateUntrusted")
    };
    let known: Value = engineer.get("/api/v1/source-certificates").await?;
    add_source(engineer, id, port, json!({ "security": { "choice": "strongest" } })).await?;
    source_is(engineer, id, untrusted).await?;
    let seen: Value = engineer.get("/api/v1/source-certificates").await?;
    let thumbprints = |list: &Value| -> Vec<String> {
        let items = list["items"].as_array().into_iter().flatten();
        items.filter_map(|item| item["thumbprint"].as_str().map(str::to_owned)).collect()
    };
    let known = thumbprints(&known);
    let shown = thumbprints(&seen).into_iter().find(|shown| !known.contains(shown));
    let path = format!("/api/v1/source-certificates/{}", shown.context("a new certificate")?);
    let trust = async |is_trusted: bool| {
        let body = json!({ "isTrusted": is_trusted });
        engineer.put::<Value>(&path, &body).await.map(drop)
    };
    trust(true).await?;
    source_is(engineer, id, |state, _| state == "connected").await?;
    trust(false).await?;
    source_is(engineer, id, untrusted).await?;
    remove_source(engineer, id).await
}

/// Signs in with a password at a machine that offers nothing but an open endpoint: it is not sent.
async fn in_the_clear(engineer: &Api, port: u16) -> anyhow::Result<()> {
    const ID: &str = "ProbeClear";
    let identity =
        json!({ "kind": "userName", "userName": "probe", "password": "a password in clear" });
    let settings = json!({ "security": { "choice": "none" }, "identity": identity });
    add_source(engineer, ID, port, settings.clone()).await?;
    source_is(engineer, ID, |state, kind| state == "waiting" && kind == "configuration").await?;
    // The machine is there, and takes the password where that is allowed by name.
    remove_source(engineer, ID).await?;
    let mut allowed = settings;
    allowed["sendsPasswordUnprotected"] = json!(true);
    add_source(engineer, ID, port, allowed).await?;
    source_is(engineer, ID, |state, _| state == "connected").await?;
    remove_source(engineer, ID).await
}

/// Lets a connector of its own enrol at a platform that names a broker which claims lengths and nests: the connector
/// lives on, and takes no memory for it.
pub(super) async fn broker_that_means_harm(folder: PathBuf) -> anyhow::Result<String> {
    let folder = folder.join("beside-a-mean-broker");
    std::fs::create_dir(&folder)?;
    let broker = TcpListener::bind(("127.0.0.1", 0)).await?;
    let url = format!("amqp://{}", broker.local_addr()?);
    let config = folder.join("connector.toml");
    let [web, twin] = free_ports::reserve()?;
    let text = format!(
        "data_directory = \"{}\"\n[web]\nlisten = \"127.0.0.1:{web}\"\n[twin]\nlisten = \"127.0.0.1:{twin}\"\n\
         [admin]\nuser_name = \"{ENGINEER}\"\npassword = \"{PASSWORD}\"\n",
        folder.join("data").display()
    );
    write_private(&config, &text)?;
    let config = config.display().to_string();
    files::enrol_at_scripted_platform(&folder, &config, &url).await?;
    let frames = Arc::new(mean_frames());
    let answered = Arc::new(AtomicUsize::new(0));
    let (scripts, count) = (Arc::clone(&frames), Arc::clone(&answered));
    let mean = tokio::spawn(async move {
        while let Ok((stream, _)) = broker.accept().await {
            let number = count.load(Ordering::Relaxed);
            let (is_signed_in, bytes) = &scripts[number % scripts.len()];
            if greet(stream, *is_signed_in, bytes).await.is_ok() {
                count.fetch_add(1, Ordering::Relaxed);
            }
        }
    });
    let _mean = AbortOnDropHandle::new(mean);
    let mut connector =
        started("connector", "factory-connector", &["run", "--config", &config], &folder)?;
    let memory = Memory::of(connector.pid());
    let health = format!("http://127.0.0.1:{web}/healthz");
    let first = eventually("the connector serves pages", PATIENCE, || async {
        let answer = reqwest::get(&health).await.map_err(|error| error.to_string())?;
        answer.error_for_status().map_err(|error| error.to_string())?;
        memory.resident().map_err(|error| error.to_string())
    })
    .await?;
    let wanted = frames.len();
    let heard = eventually("the broker has said all that it means", 3 * PATIENCE, || {
        let ended = connector.ended();
        let count = answered.load(Ordering::Relaxed);
        async move {
            if let Ok(Some(status)) = ended {
                return Ok(Err(status));
            }
            if count >= wanted { Ok(Ok(count)) } else { Err(format!("{count} of {wanted}")) }
        }
    })
    .await?;
    let count = heard.map_err(|status| {
        anyhow::anyhow!("the connector ended with {status}:\n{}", connector.log_tail(20))
    })?;
    let peak = memory.peak()?;
    reqwest::get(&health).await?.error_for_status()?;
    anyhow::ensure!(connector.ended()?.is_none(), "the connector ended");
    anyhow::ensure!(!connector.log_tail(usize::MAX).contains("panicked at"), "a task panicked");
    connector.stop(Duration::from_secs(15))?;
    let grew = peak.saturating_sub(first);
    let is_bounded = grew < GROWTH_MAX && peak < MEMORY_MAX;
    anyhow::ensure!(is_bounded, "{} MiB more, {} MiB in all", mib(grew), mib(peak));
    Ok(format!("{count} lies borne, {} MiB more", mib(grew)))
}

/// Returns what a mean broker sends: before the outcome of the sign-in (false), or behind it (true).
fn mean_frames() -> Vec<(bool, Vec<u8>)> {
    // A link that is down comes again after longer and longer pauses.
    let before = amqp::claiming_frames().into_iter().step_by(5).map(|frame| (false, frame));
    let offers = frame(SASL, 0, &described(0x40, &[nested(LEVELS)]));
    let short = 4_u32.to_be_bytes().to_vec();
    let open = frame(AMQP, 0, &described(0x10, &[string("broker"), entry(nested(LEVELS))]));
    let claims = frame(AMQP, 0, &[&[0x00, 0x53, 0x10, 0xd0][..], &[0xff; 8]].concat());
    let behind = [open, claims].map(|frame| (true, frame));
    before.chain([(false, offers), (false, short)]).chain(behind).collect()
}

/// Answers a client up to some point, sends what means harm, and waits until the client closes.
async fn greet(mut stream: TcpStream, is_signed_in: bool, bytes: &[u8]) -> anyhow::Result<()> {
    let answering = async {
        stream.read_exact(&mut [0; 8]).await?;
        stream.write_all(SASL_HEADER).await?;
        if is_signed_in {
            let mechanisms = described(0x40, &[symbol("PLAIN")]);
            stream.write_all(&frame(SASL, 0, &mechanisms)).await?;
            let mut init = [0; 4096];
            anyhow::ensure!(stream.read(&mut init).await? > 0, "no sign-in");
            // The outcome 0: welcome.
            stream.write_all(&frame(SASL, 0, &described(0x44, &[vec![0x50, 0]]))).await?;
            stream.read_exact(&mut [0; 8]).await?;
            stream.write_all(AMQP_HEADER).await?;
        }
        stream.write_all(bytes).await?;
        // What follows a header of four bytes, or of a list without end. A client that closes without reading it resets
        // the connection, which is an end, too.
        stream.write_all(&[0; 64]).await.ok();
        stream.read_to_end(&mut Vec::new()).await.ok();
        anyhow::Ok(())
    };
    timeout(PATIENCE, answering).await?
}
