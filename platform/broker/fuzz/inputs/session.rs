//! A peer that sends any bytes to a broker, for the fuzz target and for the test that replays its
//! corpus.

use std::{
    sync::{Arc, OnceLock},
    time::Duration,
};

use broker::{
    AddressPattern, Broker, BrokerConfig, BrokerHandle, BrokerUser, Carrier, CredentialTable,
    Listener,
};
use tokio::{
    io::{AsyncReadExt, AsyncWriteExt, duplex},
    runtime::Runtime,
    time::timeout,
};
use tokio_util::sync::CancellationToken;

/// Time for a connection to end after its peer has.
const END_TIMEOUT: Duration = Duration::from_secs(20);

const SASL_HEADER: &[u8] = b"AMQP\x03\x01\x00\x00";
const AMQP_HEADER: &[u8] = b"AMQP\x00\x01\x00\x00";
/// PLAIN, as the user and with the secret `fuzz`.
const INIT: &[u8] = b"\x00\x53\x41\xc0\x14\x02\xa3\x05PLAIN\xa0\x0a\x00fuzz\x00fuzz";
const OPEN: &[u8] = b"\x00\x53\x10\xc0\x07\x01\xa1\x04fuzz";
const BEGIN: &[u8] = b"\x00\x53\x11\xc0\x08\x05\x40\x43\x52\x64\x52\x64\x40";
/// A sender to the queue `fuzz`, handle 0.
const ATTACH: &[u8] = b"\x00\x53\x12\xc0\x1b\x0a\xa1\x01l\x43\x42\x40\x40\x00\x53\x28\x45\
    \x00\x53\x29\xc0\x07\x01\xa1\x04fuzz\x40\x42\x43";

struct World {
    runtime: Runtime,
    broker: BrokerHandle,
    _folder: tempfile::TempDir,
}

/// Sends bytes to the one broker of this process. The first byte says where they begin: before the
/// sign-in, after it, or in an attached link; and if they are frames or bodies of frames.
pub fn session(bytes: &[u8]) {
    static WORLD: OnceLock<World> = OnceLock::new();
    let world = WORLD.get_or_init(start);
    let Some((mode, rest)) = bytes.split_first() else { return };
    let mut input = SASL_HEADER.to_vec();
    if mode & 1 != 0 {
        input.extend(frame(1, INIT));
        input.extend(AMQP_HEADER);
        input.extend(frame(0, OPEN));
    }
    if mode & 3 == 3 {
        input.extend(frame(0, BEGIN));
        input.extend(frame(0, ATTACH));
    }
    if mode & 4 == 0 {
        input.extend(rest);
    } else {
        // Bodies, each with its length before it.
        let mut rest = rest;
        while let Some((length, after)) = rest.split_first() {
            let (body, after) = after.split_at(usize::from(*length).min(after.len()));
            input.extend(frame(u8::from(mode & 1 == 0), body));
            rest = after;
        }
    }
    world.runtime.block_on(talk(&world.broker, &input));
}

async fn talk(broker: &BrokerHandle, input: &[u8]) {
    let (near, far) = duplex(64 * 1024);
    let (mut read, mut write) = tokio::io::split(near);
    let serving = broker.serve_stream(far);
    let talking = async {
        let sending = async {
            // The broker may have closed before all was sent.
            let _ = write.write_all(input).await;
            let _ = write.shutdown().await;
        };
        let mut answers = Vec::new();
        let (_, _) = tokio::join!(sending, read.read_to_end(&mut answers));
    };
    let both = async { tokio::join!(serving, talking) };
    timeout(END_TIMEOUT, both).await.expect("a connection ends with its peer");
}

fn frame(kind: u8, body: &[u8]) -> Vec<u8> {
    let size = u32::try_from(body.len() + 8).expect("a small frame");
    [&size.to_be_bytes()[..], &[2, kind, 0, 0], body].concat()
}

fn start() -> World {
    let runtime = Runtime::new().expect("a runtime");
    let folder = tempfile::tempdir().expect("a folder");
    let listener =
        Listener { address: ([127, 0, 0, 1], 0).into(), tls: None, carrier: Carrier::Stream };
    let mut config = BrokerConfig::new(listener, folder.path().join("broker.db"));
    config.auto_created = vec![AddressPattern::any()];
    config.queue_options.messages_max = 100;
    let users = Arc::new(CredentialTable::new());
    let user = BrokerUser::with_secret(b"fuzz")
        .may_consume(AddressPattern::any())
        .may_produce(AddressPattern::any());
    users.put("fuzz", user);
    let broker = runtime.block_on(async {
        let (broker, handle) = Broker::new(config, users).await.expect("a broker");
        tokio::spawn(broker.run(CancellationToken::new()));
        handle
    });
    World { runtime, broker, _folder: folder }
}
