//! The log of five entries with two witnesses whose bytes were computed by other programs.

use ed25519_dalek::SigningKey;
use sha2::{Digest as _, Sha256};

use super::*;
use crate::{
    merkle::{LeafRange, consistency_proof, inclusion_proof, leaf_hash},
    note::{KeyKind, NoteKey, SignedNote},
};

const ORIGIN: &str = "plant1.example/to/acme";
const CHECKPOINT: &str = "plant1.example/to/acme
5
G+R1Lhc1g3b0ilJb0vku97g74fRa1GdQTmMgVMH6P+0=

\u{2014} plant1.example/to/acme BRENtBzxCZITcEzDb283bH+/GKEu40IRHW5dnR0xbqPC60RqGemxqMsWWfB+RxPCS37cxB/k0b+o+R/DXLPqNFyQgA8=
\u{2014} cloud.example/w1 KzOPwwAAAABo53gA5QNnAV8oJ22JknOXze9s3GQcyx3qlyVtEJiNG1FGeBhgw0LLBFPq9nwvYYZn1h4QejIz0EVuao0N0KTnJIG+Bw==
\u{2014} acme.example/w1 fEw87wAAAABo53gBUkGTqBJGS/AS6eCHItEoRVjCPXUpLUBOVvW2aBvuYNwaMRtPiPYMhtCiwHEzFHkx5cpkvYnFBUCpq0AuCkD8Bg==
";

fn key(name: &str, kind: KeyKind, first: u8) -> NoteKey {
    let seed: [u8; 32] = std::array::from_fn(|place| first + u8::try_from(place).expect("small"));
    NoteKey::new(name, kind, SigningKey::from_bytes(&seed)).expect("a name")
}

fn log_key() -> NoteKey {
    key(ORIGIN, KeyKind::Ed25519, 0)
}

fn entry(number: u8) -> String {
    let mut salted = vec![number; 16];
    salted.extend(format!("{{\"v\":{number}}}").bytes());
    format!("{{\"n\":{number},\"c\":\"{}\"}}", hex::encode(Sha256::digest(salted)))
}

fn leaves(numbers: &[u8]) -> Vec<Hash> {
    numbers.iter().map(|number| leaf_hash(entry(*number).as_bytes())).collect()
}

fn range(begin: u64, leaves: &[Hash]) -> LeafRange {
    let mut range = LeafRange::starting_at(begin);
    leaves.iter().for_each(|leaf| range.append(*leaf));
    range
}

fn head(leaves: &[Hash]) -> TreeHead {
    TreeHead { size: leaves.len() as u64, root: range(0, leaves).root() }
}

fn checkpoint_of(leaves: &[Hash]) -> Checkpoint {
    let TreeHead { size, root } = head(leaves);
    Checkpoint { origin: ORIGIN.to_owned(), size, root }
}

fn request(old: usize, leaves: &[Hash], key: &NoteKey) -> AddCheckpoint {
    let added = range(old as u64, &leaves[old..]);
    AddCheckpoint {
        old_size: old as u64,
        proof: consistency_proof(&range(0, &leaves[..old]), &added).expect("ranges of one log"),
        checkpoint: checkpoint_of(leaves).sign(key).expect("signed"),
    }
}

fn digest(text: &str) -> (String, usize) {
    (hex::encode(Sha256::digest(text)), text.len())
}

#[test]
fn the_log_is_the_published_one() {
    let leaves = leaves(&[0, 1, 2, 3, 4]);
    let expected = "836b427bcf027ce0b432e531fd423e5c24552d4e3e31fef485349d46e0af42fa";
    assert_eq!(hex::encode(leaves[0]), expected);
    let root = |leaves: &[Hash]| hex::encode(range(0, leaves).root());
    let expected = "43d5420d16ec6588be25438931bf12bbaf4010c44e49ac1ee8450823b9e87b7e";
    assert_eq!(root(&leaves[..3]), expected);
    let expected = "1be4752e17358376f48a525bd2f92ef7b83be1f45ad467504e632054c1fa3fed";
    assert_eq!(root(&leaves), expected);
    let [witness, partner] = witnesses();
    assert_eq!(
        log_key().verifier().to_string(),
        "plant1.example/to/acme+05110db4+AQOhB7/zzhC+HXDdGOdLwJln5NYwm6UNXx3chmQSVTG4"
    );
    assert_eq!(
        [witness.verifier().to_string(), partner.verifier().to_string()],
        [
            "cloud.example/w1+2b338fc3+BCmsuuFBvMrwsi4alNNNC8c2HlJtC/4SyJeUvJMilm3X",
            "acme.example/w1+7c4c3cef+BCVDuS/xCVURR2rcg2nbbdyTNmWhGXjdoUBO4QZsqVWd"
        ]
    );
}

fn witnesses() -> [NoteKey; 2] {
    [
        key("cloud.example/w1", KeyKind::CosignatureV1, 0x20),
        key("acme.example/w1", KeyKind::CosignatureV1, 0x40),
    ]
}

#[test]
fn the_cosigned_checkpoint_is_the_published_one() {
    let mut note = checkpoint_of(&leaves(&[0, 1, 2, 3, 4])).sign(&log_key()).expect("signed");
    let [witness, partner] = witnesses();
    note.cosign(&witness, 1_760_000_000).expect("cosigned");
    note.cosign(&partner, 1_760_000_001).expect("cosigned");
    assert_eq!(note.to_string(), CHECKPOINT);
    let expected = "2315feea2448ede83db9f3c13de42f26e93bb46be76b77180697e35edfd354c7";
    assert_eq!(digest(CHECKPOINT), (expected.to_owned(), 442));
    let parsed = SignedNote::parse(CHECKPOINT).expect("a note");
    let keys = [log_key(), witness, partner];
    let verified = parsed.verify(keys.iter().map(NoteKey::verifier)).expect("all signed");
    let times: Vec<_> = verified.iter().map(|found| found.cosigned_at).collect();
    assert_eq!(times, [None, Some(1_760_000_000), Some(1_760_000_001)]);
}

#[test]
fn the_request_is_the_published_one_and_accepted() {
    let leaves = leaves(&[0, 1, 2, 3, 4]);
    let request = request(3, &leaves, &log_key());
    let expected = "e9d08dd0af47066e18611fcab08ecfb5fc2803f26ba9d05a7ed8e482df507165";
    assert_eq!(digest(&request.to_string()), (expected.to_owned(), 378));
    let parsed: AddCheckpoint = request.to_string().parse().expect("reads back");
    assert_eq!(parsed, request);
    let accepted = accept(&parsed, log_key().verifier(), &head(&leaves[..3]));
    assert_eq!(accepted, Ok(checkpoint_of(&leaves)));
    let proof = inclusion_proof(&range(0, &leaves[..2]), &range(3, &leaves[3..])).expect("one");
    assert_eq!(proof[..], parsed.proof[1..], "as the published log says");
}

#[test]
fn every_other_history_is_refused() {
    let genuine = leaves(&[0, 1, 2, 3, 4]);
    let key = log_key();
    let known = head(&genuine);
    let check = |request: &AddCheckpoint, known: &TreeHead, expected: Result<u64, Refusal>| {
        let accepted = accept(request, key.verifier(), known).map(|checkpoint| checkpoint.size);
        assert_eq!(accepted, expected);
    };
    check(&request(0, &genuine, &key), &TreeHead::empty(), Ok(5));
    check(&request(5, &genuine, &key), &known, Ok(5));
    // A store that was set back tells an older size, or one that others have overtaken.
    check(&request(3, &genuine, &key), &known, Err(Refusal::Stale { size: 5 }));
    check(&request(0, &genuine[..3], &key), &known, Err(Refusal::Stale { size: 5 }));
    let mut shorter = request(0, &genuine[..3], &key);
    shorter.old_size = 5;
    check(&shorter, &known, Err(Refusal::OldSize));
    let other_root = Err(Refusal::Inconsistent(ProofError::OtherRoot));
    let forked = leaves(&[0, 1, 2, 4, 3]);
    let expected = "0129067f39f3084453264fe220e490ccd665a57454c301ad317005be46198447";
    assert_eq!(hex::encode(head(&forked).root), expected);
    check(&request(5, &forked, &key), &known, other_root);
    let overtaken = leaves(&[0, 1, 2, 4, 3, 5]);
    check(&request(5, &overtaken, &key), &known, other_root);
    check(&request(5, &leaves(&[0, 1, 2, 3, 4, 5]), &key), &known, Ok(6));
    let mut longer = request(5, &genuine, &key);
    longer.proof.push([0; 32]);
    check(&longer, &known, Err(Refusal::Inconsistent(ProofError::WrongLength)));
}

#[test]
fn only_the_key_of_the_log_speaks_for_it() {
    let genuine = leaves(&[0, 1, 2, 3, 4]);
    let known = head(&genuine[..3]);
    let check = |request: &AddCheckpoint, expected| {
        assert_eq!(accept(request, log_key().verifier(), &known), Err(expected));
    };
    let same_name = key(ORIGIN, KeyKind::Ed25519, 0x60);
    check(&request(3, &genuine, &same_name), Refusal::Signature(NoteError::Unsigned));
    let mut forged = request(3, &genuine, &log_key());
    let pasted = request(3, &genuine[..4], &log_key()).checkpoint;
    let lines = pasted.to_string().rsplit_once("\n\n").expect("lines").1.to_owned();
    forged.checkpoint =
        SignedNote::parse(&format!("{}\n{lines}", forged.checkpoint.text())).expect("a note");
    check(&forged, Refusal::Signature(NoteError::Forged));
    let mut other = request(3, &genuine, &log_key());
    let checkpoint = Checkpoint { origin: "other".to_owned(), ..checkpoint_of(&genuine) };
    other.checkpoint = checkpoint.sign(&log_key()).expect("signed");
    check(&other, Refusal::Origin);
    let mut text = SignedNote::new("nothing\n").expect("a text");
    text.sign(&log_key()).expect("signed");
    other.checkpoint = text;
    check(&other, Refusal::Checkpoint(CheckpointError::Lines));
}

#[test]
fn only_the_one_form_of_a_request_is_read() {
    let good = request(3, &leaves(&[0, 1, 2, 3, 4]), &log_key()).to_string();
    assert!(good.parse::<AddCheckpoint>().is_ok());
    for bad in [
        good.replacen("old 3", "old 03", 1),
        good.replacen("old 3", "3", 1),
        good.replacen("old 3", "old 3 ", 1),
        good.replacen("old 3\n", "old 3\nAAAA\n", 1),
        good.replacen("old 3\n", &format!("old 3\n{}", ("A".repeat(43) + "=\n").repeat(64)), 1),
        good.replace("\n\n", "\n"),
        "x".repeat(REQUEST_TOO_LONG),
    ] {
        assert!(bad.parse::<AddCheckpoint>().is_err(), "{bad}");
    }
}

/// Longer than any request.
const REQUEST_TOO_LONG: usize = 40_000;
