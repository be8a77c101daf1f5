//! The link against an MQTT broker that means harm. Each test is a process of its own under nextest,
//! so that the peak of its memory is its own.

use std::{
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    time::Duration,
};

use messaging::BrokerProfile;
use parking_lot::Mutex;
use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    net::{
        TcpListener, TcpStream,
        tcp::{OwnedReadHalf, OwnedWriteHalf},
    },
};

use crate::support::{TestLink, eventually};

const ADDRESS: &str = "factory.f1.requests";
const TOPIC: &str = "verbund/v1/factory/f1/requests";
/// A CONNACK that accepts the connection and grants what is usual.
const ACCEPTED: &[u8] = &[0x20, 3, 0, 0, 0];
/// Largest packet of the link, in bytes.
const PACKET_BYTES_MAX: usize = 2 * 1024 * 1024;
/// Bytes that the link may take for what waits, with room for buffers and the broker of the test.
const GROWTH_BYTES_MAX: u64 = 100 * 1024 * 1024;
/// Empty user properties: five bytes each.
const BOMB_PROPERTIES: usize = PACKET_BYTES_MAX / 5 - 100;

/// A broker that answers a CONNECT with `answer`, sends `flood`, and then answers as it should.
struct HostileBroker {
    port: u16,
    connections: Arc<AtomicUsize>,
    /// Reason codes of the acknowledgements by packet identifier.
    acknowledged: Arc<Mutex<Vec<(u16, u8)>>>,
}

impl HostileBroker {
    async fn start(answer: Vec<u8>, flood: Vec<Arc<[u8]>>, last: Vec<u8>) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
        let port = listener.local_addr().expect("an address").port();
        let this = Self { port, connections: Arc::default(), acknowledged: Arc::default() };
        let (connections, acknowledged) =
            (Arc::clone(&this.connections), Arc::clone(&this.acknowledged));
        tokio::spawn(async move {
            while let Ok((stream, _)) = listener.accept().await {
                connections.fetch_add(1, Ordering::SeqCst);
                // An end of the connection is the link's right.
                let _ = serve(stream, &answer, &flood, &last, &acknowledged).await;
            }
        });
        this
    }

    fn link(&self) -> TestLink {
        let url = format!("mqtt://127.0.0.1:{}", self.port);
        TestLink::start(BrokerProfile::mqtt(), &url, "f1", "secret", &[ADDRESS])
    }
}

async fn serve(
    stream: TcpStream,
    answer: &[u8],
    flood: &[Arc<[u8]>],
    last: &[u8],
    acknowledged: &Mutex<Vec<(u16, u8)>>,
) -> std::io::Result<()> {
    let (mut read, mut write) = stream.into_split();
    next(&mut read).await?;
    write.write_all(answer).await?;
    let (subscribed, mut subscriptions) = tokio::sync::mpsc::unbounded_channel();
    let writing = send(&mut write, flood, last, &mut subscriptions);
    let reading = listen(&mut read, subscribed, acknowledged);
    // Ends with the connection, also while a subscription is awaited.
    tokio::try_join!(writing, reading).map(drop)
}

/// Reads the client's packets to the end of the connection, which is an error.
async fn listen(
    read: &mut OwnedReadHalf,
    subscribed: tokio::sync::mpsc::UnboundedSender<[u8; 2]>,
    acknowledged: &Mutex<Vec<(u16, u8)>>,
) -> std::io::Result<()> {
    loop {
        let (first, body) = next(read).await?;
        match first >> 4 {
            4 => {
                let code = body.get(2).copied().unwrap_or_default();
                acknowledged.lock().push((u16::from_be_bytes([body[0], body[1]]), code));
            }
            8 => drop(subscribed.send([body[0], body[1]])),
            _ => {}
        }
    }
}

async fn send(
    write: &mut OwnedWriteHalf,
    flood: &[Arc<[u8]>],
    last: &[u8],
    subscriptions: &mut tokio::sync::mpsc::UnboundedReceiver<[u8; 2]>,
) -> std::io::Result<()> {
    for packet in flood {
        write.write_all(packet).await?;
    }
    let [high, low] = subscriptions.recv().await.ok_or(std::io::ErrorKind::UnexpectedEof)?;
    write.write_all(&[0x90, 5, high, low, 0, 1, 1]).await?;
    write.write_all(last).await
}

/// First byte and body of the client's next packet.
async fn next(read: &mut OwnedReadHalf) -> std::io::Result<(u8, Vec<u8>)> {
    let first = read.read_u8().await?;
    let (mut length, mut shift) = (0, 0);
    loop {
        let byte = read.read_u8().await?;
        length |= usize::from(byte & 0x7F) << shift;
        shift += 7;
        if byte & 0x80 == 0 {
            break;
        }
    }
    let mut body = vec![0; length];
    read.read_exact(&mut body).await?;
    Ok((first, body))
}

fn variable(mut value: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    loop {
        let more = value >> 7;
        let digit = u8::try_from(value & 0x7F).expect("seven bits");
        bytes.push(if more > 0 { digit | 0x80 } else { digit });
        if more == 0 {
            return bytes;
        }
        value = more;
    }
}

fn packet(first: u8, body: &[u8]) -> Vec<u8> {
    [&[first][..], &variable(body.len()), body].concat()
}

fn properties(count: usize) -> Vec<u8> {
    [variable(5 * count), [0x26, 0, 0, 0, 0].repeat(count)].concat()
}

/// A message with QoS 1.
fn publish(topic: &str, id: u16, properties: &[u8], payload: &[u8]) -> Vec<u8> {
    let length = u16::try_from(topic.len()).expect("a short topic").to_be_bytes();
    let body = [&length[..], topic.as_bytes(), &id.to_be_bytes(), properties, payload].concat();
    packet(0x32, &body)
}

/// A message that the link reads, with its id.
fn readable(id: u16) -> Vec<u8> {
    let property = [&[0x26, 0, 10][..], b"message-id", &[0, 4], b"good"].concat();
    publish(TOPIC, id, &[variable(property.len()), property].concat(), b"{}")
}

fn peak() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("a status");
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("a peak");
    peak.trim().trim_end_matches(" kB").parse::<u64>().expect("a number") * 1024
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn messages_of_nothing_but_properties_are_rejected_and_those_behind_them_arrive() {
    let bomb = |topic, id| publish(topic, id, &properties(BOMB_PROPERTIES), b"");
    let flood = (1..=20).map(|id| bomb(if id % 2 == 0 { TOPIC } else { "other" }, id).into());
    let (flood, before) = (flood.collect(), peak());
    let broker = HostileBroker::start(ACCEPTED.to_vec(), flood, readable(99)).await;
    let link = broker.link();
    eventually("the last message has arrived", || link.has_received("good")).await;
    let growth = peak().saturating_sub(before);
    assert!(growth < GROWTH_BYTES_MAX, "the link grew by {growth} bytes");
    eventually("all are settled", || broker.acknowledged.lock().len() == 21).await;
    let mut expected: Vec<_> = (1..=20).map(|id| (id, 0x99)).collect();
    expected.push((99, 0));
    assert_eq!(*broker.acknowledged.lock(), expected);
    assert_eq!(broker.connections.load(Ordering::SeqCst), 1, "the link has stayed");
    link.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn messages_that_nobody_asked_for_take_no_more_memory_than_is_for_them() {
    let large: Arc<[u8]> = publish("other", 1, &[0], &vec![7; PACKET_BYTES_MAX - 100]).into();
    // A small message in front of a packet that is read and passed over: it must not keep the buffer
    // of both.
    let small = publish("other", 1, &[0], b"{}");
    let pinning = [&small[..], &publish("other", 2, &properties(BOMB_PROPERTIES), b"")].concat();
    for flood in [vec![large; 200], vec![pinning.into(); 200]] {
        let before = peak();
        let broker = HostileBroker::start(ACCEPTED.to_vec(), flood, readable(99)).await;
        let link = broker.link();
        eventually("the flood has begun", || broker.connections.load(Ordering::SeqCst) > 0).await;
        // There is nothing to observe of a reader that takes no more.
        tokio::time::sleep(Duration::from_secs(3)).await;
        let growth = peak().saturating_sub(before);
        assert!(growth < GROWTH_BYTES_MAX, "the link grew by {growth} bytes");
        tokio::time::timeout(Duration::from_secs(30), link.stop()).await.expect("the link ends");
    }
}

/// A persistent session holds more than there is memory for, and the broker sends it before its answer
/// to the subscription.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_large_backlog_arrives_although_the_answer_to_the_subscription_is_behind_it() {
    let large = |id| publish(TOPIC, id, &[0], &vec![7; PACKET_BYTES_MAX - 100]).into();
    let flood: Vec<Arc<[u8]>> = (1..=40).map(large).collect();
    let before = peak();
    let broker = HostileBroker::start(ACCEPTED.to_vec(), flood, readable(99)).await;
    let link = broker.link();
    eventually("all are settled", || broker.acknowledged.lock().len() == 41).await;
    assert_eq!(broker.connections.load(Ordering::SeqCst), 1, "the link has stayed");
    assert!(link.has_received("good"));
    assert!(peak() > before, "{before} bytes before");
    link.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn answers_of_nothing_but_properties_end_the_connection_before_they_are_read() {
    let block = properties(BOMB_PROPERTIES);
    let answer = packet(0x20, &[&[0, 0][..], &block].concat());
    let of = |first, head: &[u8], tail: &[u8]| packet(first, &[head, &block, tail].concat());
    for (answer, after) in [
        (answer, None),
        (ACCEPTED.to_vec(), Some(of(0x40, &[0, 1, 0], &[]))),
        (ACCEPTED.to_vec(), Some(of(0x50, &[0, 1, 0], &[]))),
        (ACCEPTED.to_vec(), Some(of(0x90, &[0, 1], &[1]))),
        (ACCEPTED.to_vec(), Some(of(0xB0, &[0, 1], &[0]))),
        (ACCEPTED.to_vec(), Some(of(0xE0, &[0], &[]))),
    ] {
        let flood = after.into_iter().map(Arc::from).collect();
        let before = peak();
        let broker = HostileBroker::start(answer, flood, Vec::new()).await;
        let link = broker.link();
        eventually("the link tries again", || broker.connections.load(Ordering::SeqCst) > 1).await;
        let growth = peak().saturating_sub(before);
        assert!(growth < 8 * 1024 * 1024, "the link grew by {growth} bytes");
        link.stop().await;
    }
}
