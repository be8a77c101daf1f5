//! A link against a broker that means harm, and against messages that nobody can read.

use std::{
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    time::Duration,
};

use fe2o3_amqp_types::{messaging::DeliveryState, performatives::Performative};
use parking_lot::Mutex;
use tokio::{io::AsyncReadExt, net::TcpListener};

use crate::{
    raw::{
        AMQP, AMQP_HEADER, RawPeer, SASL, SASL_HEADER, binary, boolean, described, entry, frame,
        nested, section, string, symbol, transfer, uint,
    },
    support::{TestLink, eventually},
};

/// Largest body that the link takes.
const BYTES_MAX: usize = 100_000;

/// A broker of one connection at a time, which delivers what it is told to.
struct HostileBroker {
    port: u16,
    connections: Arc<AtomicUsize>,
    /// Outcomes of the deliveries, in their order.
    outcomes: Arc<Mutex<Vec<DeliveryState>>>,
}

impl HostileBroker {
    /// Sends `mechanisms` as the first frame, and `deliveries` to the receiver.
    async fn start(mechanisms: Vec<u8>, deliveries: Vec<Vec<u8>>) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
        let port = listener.local_addr().expect("an address").port();
        let (connections, outcomes) = (Arc::<AtomicUsize>::default(), Arc::default());
        let this = Self { port, connections: Arc::clone(&connections), outcomes };
        let outcomes = Arc::clone(&this.outcomes);
        tokio::spawn(async move {
            while let Ok((stream, _)) = listener.accept().await {
                connections.fetch_add(1, Ordering::SeqCst);
                let peer = RawPeer(stream);
                let _ = serve(peer, &mechanisms, &deliveries, &outcomes).await;
            }
        });
        this
    }

    fn url(&self) -> String {
        format!("amqp://127.0.0.1:{}", self.port)
    }
}

async fn serve(
    mut peer: RawPeer,
    mechanisms: &[u8],
    deliveries: &[Vec<u8>],
    outcomes: &Mutex<Vec<DeliveryState>>,
) -> std::io::Result<()> {
    let mut header = [0; 8];
    peer.0.read_exact(&mut header).await?;
    peer.send(SASL_HEADER).await;
    peer.send(&frame(SASL, 0, mechanisms)).await;
    peer.read().await?;
    peer.send(&frame(SASL, 0, &described(0x44, &[vec![0x50, 0]]))).await;
    peer.0.read_exact(&mut header).await?;
    peer.send(AMQP_HEADER).await;
    loop {
        let (_, body) = peer.read().await?;
        if body.is_empty() {
            continue;
        }
        match serde_amqp::from_slice(&body).expect("a performative of the client") {
            Performative::Open(_) => {
                peer.send(&frame(AMQP, 0, &described(0x10, &[string("hostile")]))).await;
            }
            Performative::Begin(_) => {
                let counts = [vec![0x60, 0, 0], uint(0), uint(1000), uint(1000)];
                peer.send(&frame(AMQP, 0, &described(0x11, &counts))).await;
            }
            Performative::Attach(attach) => {
                let null = || vec![0x40];
                let address = string("factory.f1.requests");
                let address = [address];
                let (source, target) = (described(0x28, &address), described(0x29, &address));
                let link = [string(&attach.name), uint(0), boolean(false), null(), null()];
                let rest = [source, target, null(), null(), uint(0)];
                peer.send(&frame(AMQP, 0, &described(0x12, &[&link[..], &rest].concat()))).await;
            }
            Performative::Flow(flow) if flow.handle.is_some() && outcomes.lock().is_empty() => {
                for (id, delivery) in (0..).zip(deliveries) {
                    deliver(&mut peer, id, delivery).await;
                }
            }
            Performative::Disposition(disposition) => {
                let count = disposition.last.unwrap_or(disposition.first) - disposition.first + 1;
                let state = disposition.state.expect("an outcome");
                outcomes.lock().extend((0..count).map(|_| state.clone()));
            }
            _ => {}
        }
    }
}

/// Sends a message in as many frames as it needs.
async fn deliver(peer: &mut RawPeer, id: u32, message: &[u8]) {
    let parts: Vec<_> = message.chunks(60_000).collect();
    for (at, part) in parts.iter().enumerate() {
        let performative = transfer(0, id, at + 1 < parts.len());
        peer.send(&frame(AMQP, 0, &[&performative[..], part].concat())).await;
    }
}

fn start_link(broker: &HostileBroker) -> TestLink {
    TestLink::start_with(
        &broker.url(),
        "f1",
        &["factory.f1.requests"],
        messaging::spool::memory::AcceptedReports::Leave,
        |config| config.limits.message_bytes_max = BYTES_MAX as u64,
    )
}

fn plain() -> Vec<u8> {
    described(0x40, &[symbol("PLAIN")])
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn poison_messages_are_rejected_with_a_reason_and_those_behind_them_arrive() {
    let body = section(0x75, &binary(b"{}"));
    let good = |id: &str| [described(0x73, &[string(id)]), body.clone()].concat();
    let oversize = section(0x75, &binary(&vec![b'x'; BYTES_MAX + 1]));
    let poison = [
        section(0x77, &nested(2_000)),
        section(0x77, &nested(30_000)),
        [section(0x72, &entry(nested(8_000))), body.clone()].concat(),
        [section(0x71, &entry(nested(8_000))), body.clone()].concat(),
        // A length that is not there, and a section cut off.
        section(0x75, &[0xb0, 0xff, 0xff, 0xff, 0xf0]),
        body[..5].to_vec(),
        oversize,
    ];
    let mut deliveries = vec![good("first")];
    for message in poison.clone() {
        deliveries.extend([message, good("next")]);
    }
    deliveries.push(good("last"));
    let broker = HostileBroker::start(plain(), deliveries.clone()).await;
    let link = start_link(&broker);
    eventually("all are settled", || broker.outcomes.lock().len() == deliveries.len()).await;
    let ids = link.inbox.ids();
    assert_eq!(
        (ids.first().map(String::as_str), ids.last().map(String::as_str)),
        (Some("first"), Some("last"))
    );
    assert_eq!(ids.len(), poison.len() + 2);
    let outcomes = broker.outcomes.lock().clone();
    let mut reasons: Vec<_> = outcomes
        .iter()
        .filter_map(|outcome| match outcome {
            DeliveryState::Rejected(rejected) => rejected.error.clone(),
            DeliveryState::Accepted(_) => None,
            other => panic!("an outcome that settles nothing: {other:?}"),
        })
        .map(|error| format!("{:?}: {}", error.condition, error.description.unwrap_or_default()))
        .collect();
    reasons.sort();
    assert_eq!(reasons.len(), poison.len(), "{reasons:?}");
    assert!(reasons.iter().filter(|reason| reason.contains("cannot be decoded")).count() == 6);
    assert!(reasons.iter().any(|reason| reason.contains("at most 100000 are taken")));
    assert_eq!(broker.connections.load(Ordering::SeqCst), 1, "the link has stayed");
    link.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn lengths_that_a_broker_claims_are_not_allocated() {
    let peak = || {
        let status = std::fs::read_to_string("/proc/self/status").expect("a status");
        let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("a peak");
        peak.trim().trim_end_matches(" kB").parse::<u64>().expect("a number")
    };
    for bomb in [
        vec![0x00, 0xb3, 0xff, 0xff, 0xff, 0xf0],
        described(0x40, &[vec![0xb3, 0xff, 0xff, 0xff, 0xf0]]),
        described(0x40, &[nested(200)]),
        Vec::new(),
    ] {
        let before = peak();
        let broker = HostileBroker::start(bomb, Vec::new()).await;
        let link = start_link(&broker);
        eventually("the link tries again and again", || {
            broker.connections.load(Ordering::SeqCst) > 2
        })
        .await;
        tokio::time::timeout(Duration::from_secs(10), link.stop()).await.expect("the link lives");
        assert!(peak() - before < 64 * 1024, "the client grew");
    }
}
