//! Servers that answer with more than they may, before anybody trusts them.

use std::{
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

use shop_floor::{SourceConfig, SourceId, SourceState};
use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    net::{
        TcpListener, TcpStream,
        tcp::{OwnedReadHalf, OwnedWriteHalf},
    },
    sync::oneshot,
};

use crate::support::{Simulation, TestShopFloor, node, unprotected, until, within};

/// Most bytes that the network itself may take before the client's end is noticed.
const IN_FLIGHT_MAX: usize = 32 << 20;
/// Bytes that a server tries to send.
const SENT_MAX: usize = 256 << 20;

/// An address behind which a server greets with these bytes, and then sends zeros until the client hangs up. How many
/// bytes it could send.
async fn server(greeting: Vec<u8>) -> (String, oneshot::Receiver<usize>) {
    let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
    let address = listener.local_addr().expect("bound");
    let (sender, receiver) = oneshot::channel();
    tokio::spawn(async move {
        let (mut stream, _) = listener.accept().await.expect("a client");
        let mut hello = [0; 1024];
        let _ = stream.read(&mut hello).await.expect("a greeting");
        stream.write_all(&greeting).await.expect("the client listens");
        let (block, mut sent) = (vec![0; 1 << 20], 0);
        while sent < SENT_MAX && stream.write_all(&block).await.is_ok() {
            sent += block.len();
        }
        let _ = sender.send(sent);
    });
    (format!("opc.tcp://{address}"), receiver)
}

pub fn header(kind: &[u8; 4], size: u32) -> Vec<u8> {
    [kind.as_slice(), &size.to_le_bytes()].concat()
}

/// An acknowledgement of the greeting with the usual sizes.
pub fn acknowledgement() -> Vec<u8> {
    let mut bytes = header(b"ACKF", 28);
    for number in [0, 65_535, 65_535, 0, 0_u32] {
        bytes.extend(number.to_le_bytes());
    }
    bytes
}

#[tokio::test]
async fn what_a_server_claims_is_not_buffered() {
    let floor = TestShopFloor::start();
    for (what, greeting) in [
        ("an acknowledgement of 4 GiB", header(b"ACKF", u32::MAX)),
        ("a channel of 4 GiB", [acknowledgement(), header(b"OPNF", u32::MAX)].concat()),
        ("a chunk of 1 MiB", [acknowledgement(), header(b"MSGC", 1 << 20)].concat()),
    ] {
        let (url, sent) = server(greeting).await;
        let start = Instant::now();
        let answer = floor.handle.discover(&url).await.expect("an address");
        assert!(answer.is_err(), "{what}");
        assert!(start.elapsed() < Duration::from_secs(4), "{what}: {:?}", start.elapsed());
        let sent = sent.await.expect("the server ends");
        assert!(sent < IN_FLIGHT_MAX, "{what}: the client took {sent} bytes");
    }
}

/// Bytes of a chunk of an endless answer, and a number of chunks: some more than the 16 MiB that a stranger's message
/// may have, and far fewer than the 64 MiB of a trusted server's.
const CHUNK_BYTES: usize = 65_000;
const CHUNKS: u32 = 300;

/// An address behind which a machine answers, but in the second connection, the session's, the answer with this number
/// never ends: chunk follows chunk, and none is the final one. Heard of when all are sent.
async fn endless(machine: String, answer: usize, chunks: u32) -> (String, oneshot::Receiver<()>) {
    let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
    let address = listener.local_addr().expect("bound");
    let (sender, receiver) = oneshot::channel();
    tokio::spawn(async move {
        let (mut client, _) = listener.accept().await.expect("a client asks for the endpoints");
        let mut server = TcpStream::connect(&machine).await.expect("the machine listens");
        tokio::spawn(
            async move { tokio::io::copy_bidirectional(&mut client, &mut server).await.ok() },
        );
        let (client, _) = listener.accept().await.expect("a client opens a session");
        let server = TcpStream::connect(&machine).await.expect("the machine listens");
        let (mut from_client, mut to_client) = client.into_split();
        let (mut from_server, mut to_server) = server.into_split();
        tokio::spawn(async move { tokio::io::copy(&mut from_client, &mut to_server).await.ok() });
        for _ in 0..answer {
            let frame = frame(&mut from_server).await;
            to_client.write_all(&frame).await.expect("the client listens");
        }
        let first = frame(&mut from_server).await;
        flood(first, chunks, &mut to_client).await;
        let _ = sender.send(());
        // Open still: the client is not to end for want of a connection.
        std::future::pending::<()>().await;
    });
    (address.to_string(), receiver)
}

/// Reads one message of a machine.
async fn frame(stream: &mut OwnedReadHalf) -> Vec<u8> {
    let mut frame = vec![0; 8];
    stream.read_exact(&mut frame).await.expect("a header");
    frame.resize(number_at(&frame, 4) as usize, 0);
    stream.read_exact(&mut frame[8..]).await.expect("a message");
    frame
}

/// Sends so many chunks of the message that this chunk would have been all of.
async fn flood(first: Vec<u8>, chunks: u32, stream: &mut OwnedWriteHalf) {
    let at = sequence_at(&first);
    let begun = number_at(&first, at);
    let mut chunk = first[..at + 8].to_vec();
    chunk.resize(CHUNK_BYTES, 0);
    chunk[3] = b'C';
    let size = u32::try_from(CHUNK_BYTES).expect("small");
    chunk[4..8].copy_from_slice(&size.to_le_bytes());
    for number in begun..begun + chunks {
        chunk[at..at + 4].copy_from_slice(&number.to_le_bytes());
        if stream.write_all(&chunk).await.is_err() {
            return;
        }
    }
}

/// Returns the place at which an unprotected chunk has its number, with that of the request behind it.
fn sequence_at(chunk: &[u8]) -> usize {
    if chunk.starts_with(b"MSG") {
        return 16;
    }
    // A channel is opened with the names of the policy and of two certificates, which may be absent.
    let mut at = 12;
    for _ in 0..3 {
        let length = number_at(chunk, at).cast_signed();
        at += 4 + usize::try_from(length).unwrap_or(0);
    }
    at
}

/// Returns the host and port of a source.
fn host_of(source: &SourceConfig) -> String {
    let rest = source.endpoint_url.strip_prefix("opc.tcp://").expect("a URL of OPC UA");
    rest.split('/').next().expect("a host").to_owned()
}

fn number_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"))
}

#[tokio::test]
async fn an_answer_without_end_is_given_up_before_anybody_is_signed_in() {
    let simulation = Simulation::milling_cell().await;
    let machine = simulation.machine("Cell");
    let direct = unprotected(&machine);
    let host = host_of(&direct);
    // The first message acknowledges the greeting.
    for (what, answer) in [("the channel's opening", 1), ("the session's creation", 2)] {
        let floor = TestShopFloor::start();
        let (address, sent) = endless(host.clone(), answer, CHUNKS).await;
        let mut source = direct.clone();
        source.endpoint_url = direct.endpoint_url.replace(&host, &address);
        let id = source.source_id.clone();
        floor.handle.put_source(source).expect("a valid source");
        sent.await.expect("the server sends");
        // Long before the request's own time is over.
        within(Duration::from_secs(4), what, || floor.status(&id).problem.is_some()).await;
    }
}

#[tokio::test]
async fn many_hostile_servers_hold_no_more_than_the_budget_and_an_honest_one_answers() {
    const ROOM: usize = 24 << 20;
    // Each keeps within what a stranger's message may have; together they send four times the room.
    const HOSTILE: usize = 8;
    const CHUNKS_OF_EACH: u32 = 200;
    let simulation = Simulation::milling_cell().await;
    let machine = simulation.machine("Cell");
    let direct = unprotected(&machine);
    let host = host_of(&direct);
    let floor = TestShopFloor::start_with(|config| config.incoming_bytes_max = ROOM);
    let most = Arc::new(AtomicUsize::new(0));
    let sampler = tokio::spawn({
        let (handle, most) = (floor.handle.clone(), Arc::clone(&most));
        async move {
            loop {
                most.fetch_max(handle.incoming_bytes(), Ordering::Relaxed);
                tokio::time::sleep(Duration::from_millis(1)).await;
            }
        }
    });
    let mut floods = Vec::new();
    for number in 0..HOSTILE {
        let (address, sent) = endless(host.clone(), 2, CHUNKS_OF_EACH).await;
        let mut source = direct.clone();
        source.source_id = SourceId::new(format!("Hostile{number}")).expect("a name");
        source.endpoint_url = direct.endpoint_url.replace(&host, &address);
        floor.handle.put_source(source).expect("a valid source");
        floods.push(sent);
    }
    let honest = floor.connect(&machine).await;
    floor.monitor(1, &honest, node(&machine, "Spindle.Temperature"));
    until("the honest machine answers", || floor.newest(1).is_some()).await;
    for sent in floods {
        sent.await.expect("each server sends, or is cut off");
    }
    until("the room is used", || most.load(Ordering::Relaxed) > ROOM / 2).await;
    sampler.abort();
    let most = most.load(Ordering::Relaxed);
    assert!(most <= ROOM, "{most} bytes were held");
    let status = floor.status(&honest);
    assert!(status.state == SourceState::Connected && status.problem.is_none(), "{status:?}");
}
