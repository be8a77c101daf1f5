//! The platform as the witness of a factory's ledger: what it countersigns, what it refuses, and to
//! whom it shows it.

use asi_model::messages::ledger_log_origin;
use ed25519_dalek::SigningKey;
use serde_json::{Value, json};
use transparency_log::{
    AddCheckpoint, Checkpoint, KeyKind, LeafRange, NoteKey, SignedNote, VerifierKey,
    consistency_proof, leaf_hash,
};

use crate::{
    connector::Peer,
    harness::{World, eventually},
    story,
};

const RECIPIENT: &str = "acme-aero";

/// The log of FOR_MUC for a recipient, with these entries.
struct Log {
    epoch: u32,
    key: NoteKey,
    leaves: Vec<[u8; 32]>,
}

impl Log {
    fn new(epoch: u32, secret: u8, entries: &[&str]) -> Self {
        let (factory, recipient) =
            ("FOR_MUC".parse().expect("an id"), RECIPIENT.parse().expect("an id"));
        let origin = ledger_log_origin(&factory, &recipient, epoch);
        let secret = SigningKey::from_bytes(&[secret; 32]);
        let key = NoteKey::new(&origin, KeyKind::Ed25519, secret).expect("a key");
        let leaves = entries.iter().map(|entry| leaf_hash(entry.as_bytes())).collect();
        Self { epoch, key, leaves }
    }

    /// The message with a checkpoint of this size, proven from an older one.
    fn message(&self, old: usize, size: usize) -> Value {
        let range = |from: usize, to: usize| {
            let mut range = LeafRange::starting_at(from as u64);
            self.leaves[from..to].iter().for_each(|leaf| range.append(*leaf));
            range
        };
        let (older, added) = (range(0, old), range(old, size));
        let checkpoint = Checkpoint {
            origin: self.key.verifier().name().to_owned(),
            size: size as u64,
            root: range(0, size).root(),
        };
        let request = AddCheckpoint {
            old_size: old as u64,
            proof: consistency_proof(&older, &added).expect("ranges of one log"),
            checkpoint: checkpoint.sign(&self.key).expect("signed"),
        };
        json!({ "messageType": "ledger-checkpoint", "messageId": platform::clock::new_message_id(),
            "factoryId": "FOR_MUC", "recipientId": RECIPIENT, "epoch": self.epoch,
            "verifierKey": self.key.verifier().to_string(), "addCheckpoint": request.to_string() })
    }
}

/// Sends a checkpoint; the answer.
async fn ask(peer: &Peer, message: &Value) -> Value {
    peer.send("ledger-checkpoint", message);
    let id = message["messageId"].clone();
    peer.receive("ledger-cosignature", |answer| answer["correlationId"] == id).await
}

/// The size of the checkpoint in an answer, whose signatures are verified.
fn held(answer: &Value, log: &Log) -> u64 {
    let note = answer["checkpoint"].as_str().expect("a checkpoint");
    let witness: VerifierKey =
        answer["witnessKey"].as_str().expect("a key").parse().expect("a key");
    let note = SignedNote::parse(note).expect("a note");
    let verified = note.verify([log.key.verifier(), &witness]).expect("signed");
    assert_eq!(verified.len(), 2, "log and witness");
    note.text().parse::<Checkpoint>().expect("a checkpoint").size
}

/// Lets the platform countersign a log of FOR_MUC.
pub async fn countersigned(peer: &Peer) {
    let log = Log::new(1, 1, &GENUINE);
    assert_eq!(ask(peer, &log.message(0, 3)).await["result"], "COSIGNED");
}

/// Lets the platform countersign logs of FOR_MUC that replace each other.
pub async fn countersigned_epochs(peer: &Peer, epochs: std::ops::RangeInclusive<u32>) {
    for epoch in epochs {
        let log = Log::new(epoch, 1, &GENUINE);
        assert_eq!(ask(peer, &log.message(0, 3)).await["result"], "COSIGNED");
    }
}

const GENUINE: [&str; 6] = ["start", "a", "b", "c", "d", "e"];

#[tokio::test(flavor = "multi_thread")]
async fn a_growing_log_is_countersigned_and_any_other_history_refused() {
    let mut world = World::start().await;
    let (_, _, munich, _hamburg) = story::accepted(&world).await;
    let log = Log::new(1, 1, &GENUINE);
    let first = log.message(0, 3);
    let answer = ask(&munich, &first).await;
    assert_eq!((&answer["result"], held(&answer, &log)), (&json!("COSIGNED"), 3));
    let key = answer["witnessKey"].clone();

    // The same message again, and the same checkpoint in another message.
    munich.send("ledger-checkpoint", &first);
    let answer = ask(&munich, &log.message(0, 3)).await;
    assert_eq!((&answer["result"], held(&answer, &log)), (&json!("STALE"), 3));
    let answer = ask(&munich, &log.message(3, 3)).await;
    assert_eq!(answer["result"], "COSIGNED", "the same head is countersigned again");
    assert_eq!(munich.count("ledger-cosignature"), 3, "a repetition is not answered");

    // What is held and the key survive a restart.
    world.restart().await;
    let (admin, munich) = reconnected(&world).await;
    let answer = ask(&munich, &log.message(3, 5)).await;
    assert_eq!((&answer["result"], held(&answer, &log)), (&json!("COSIGNED"), 5));
    assert_eq!(answer["witnessKey"], key);

    // Set back, cut, replaced at the same size, replaced and longer, signed with another key.
    let answer = ask(&munich, &log.message(3, 4)).await;
    assert_eq!((&answer["result"], held(&answer, &log)), (&json!("STALE"), 5));
    let other = Log::new(1, 1, &["start", "a", "x", "y", "z", "z"]);
    for size in [5, 6] {
        let answer = ask(&munich, &other.message(5, size)).await;
        assert_eq!((&answer["result"], held(&answer, &log)), (&json!("INCONSISTENT"), 5));
    }
    let signed_by_other = Log::new(1, 2, &GENUINE);
    let answer = ask(&munich, &signed_by_other.message(5, 6)).await;
    assert_eq!((&answer["result"], held(&answer, &log)), (&json!("OTHER_KEY"), 5));
    let answer = ask(&munich, &log.message(5, 6)).await;
    assert_eq!(answer["result"], "COSIGNED", "the genuine log goes on");

    // A log that replaces it, by whatever key; then the former one is past.
    let second = Log::new(2, 3, &["start 2", "a"]);
    let answer = ask(&munich, &second.message(0, 2)).await;
    assert_eq!((&answer["result"], &answer["epoch"]), (&json!("COSIGNED"), &json!(2)));
    let answer = ask(&munich, &log.message(6, 6)).await;
    assert_eq!((&answer["result"], &answer["epoch"]), (&json!("STALE"), &json!(2)));
    assert_eq!(held(&answer, &second), 2);
    drop(admin);
}

/// The same connector with a new credential after a restart of the platform.
async fn reconnected(world: &World) -> (crate::harness::Api, Peer) {
    let admin = world.admin().await;
    let munich = Peer::enrolled(world, &admin, "FOR_MUC").await;
    (admin, munich)
}

#[tokio::test(flavor = "multi_thread")]
async fn a_log_of_which_nothing_is_held_begins_with_the_first_checkpoint() {
    let world = World::start().await;
    let (_, buyer, munich, _hamburg) = story::accepted(&world).await;
    let log = Log::new(1, 1, &GENUINE);
    let answer = ask(&munich, &log.message(3, 5)).await;
    assert_eq!((&answer["result"], &answer["checkpoint"]), (&json!("STALE"), &Value::Null));
    let answer = ask(&munich, &log.message(0, 5)).await;
    assert_eq!((&answer["result"], held(&answer, &log)), (&json!("COSIGNED"), 5));
    let shown = buyer.get("/factories/FOR_MUC/ledger-logs").await.expect_ok();
    assert_eq!(shown["items"][0]["firstSize"], 5, "from here on it is witnessed: {shown}");
}

/// A request whose checkpoint has signatures of many others, which the platform would keep.
fn signed_by_many(request: &Value) -> Value {
    let text = request.as_str().expect("a request");
    let own = text.trim_end().rsplit('\n').next().expect("a signature");
    let (_, signature) = own.rsplit_once(' ').expect("a name and a signature");
    let others: String = (0..12)
        .map(|number| {
            format!("\u{2014} witness-{number}.example/{} {signature}\n", "x".repeat(300))
        })
        .collect();
    json!(format!("{text}{others}"))
}

#[tokio::test(flavor = "multi_thread")]
async fn a_checkpoint_that_says_nothing_is_a_dead_letter() {
    let world = World::start().await;
    let (admin, _, munich, _hamburg) = story::accepted(&world).await;
    let log = Log::new(1, 1, &GENUINE);
    let with = |member: &str, value: Value| {
        let mut message = log.message(0, 3);
        message[member] = value;
        message
    };
    let foreign = Log::new(2, 1, &GENUINE).message(0, 3)["verifierKey"].clone();
    let messages = [
        with("addCheckpoint", json!("rubbish")),
        with("verifierKey", json!("rubbish")),
        with("verifierKey", foreign),
        with("recipientId", json!("nobody")),
        with("epoch", json!(0)),
        with("addCheckpoint", Log::new(1, 2, &GENUINE).message(0, 3)["addCheckpoint"].clone()),
        with("addCheckpoint", signed_by_many(&log.message(0, 3)["addCheckpoint"])),
    ];
    for message in &messages {
        munich.send("ledger-checkpoint", message);
    }
    let letters = eventually("dead letters", || async {
        let letters = admin.get("/dead-letters").await.expect_ok()["items"].clone();
        let count = letters.as_array().map_or(0, Vec::len);
        if count == messages.len() { Ok(letters) } else { Err(letters.to_string()) }
    })
    .await;
    let count = |code: &str| {
        letters.as_array().into_iter().flatten().filter(|letter| letter["code"] == code).count()
    };
    let counts = ["INVALID_CHECKPOINT", "UNKNOWN_ORGANISATION", "INVALID_MESSAGE"].map(count);
    assert_eq!(counts, [5, 1, 1], "{letters}");
    assert!(letters.to_string().contains("4096 are allowed"), "{letters}");
    assert_eq!(munich.count("ledger-cosignature"), 0);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_log_is_shown_to_its_recipient_and_its_factory_only() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    let log = Log::new(1, 1, &GENUINE);
    ask(&munich, &log.message(0, 3)).await;
    let forged = Log::new(1, 1, &["start", "x", "y"]);
    ask(&munich, &forged.message(3, 3)).await;
    let path = "/factories/FOR_MUC/ledger-logs";
    let maker = story::planner(&world, "frames-munich").await;
    for api in [&buyer, &maker] {
        let shown = api.get(path).await.expect_ok();
        let item = &shown["items"][0];
        let expected = json!([RECIPIENT, 1, "FOR_MUC/to/acme-aero", 3, 3]);
        let members = ["recipientId", "epoch", "origin", "size", "firstSize"];
        assert_eq!(json!(members.map(|name| item[name].clone())), expected, "{shown}");
        assert_eq!(item["verifierKey"], log.key.verifier().to_string());
        assert_eq!(held(item, &log), 3);
        let refused = item["refusedCheckpoint"].as_str().expect("evidence");
        let refused = SignedNote::parse(refused).expect("a note");
        assert!(refused.verify([log.key.verifier()]).is_ok(), "two heads of one size");
    }
    let inspector = story::planner(&world, "inspect-hamburg").await;
    for api in [&admin, &inspector] {
        assert_eq!(api.get(path).await.expect_ok()["items"], json!([]));
    }
    let stranger = story::planner(&world, "stranger").await;
    stranger.get(path).await.expect_problem(404, "NOT_FOUND");
}
