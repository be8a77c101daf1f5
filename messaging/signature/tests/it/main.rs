//! Signatures as other people's libraries read and write them.

use std::{
    io::Write as _,
    path::PathBuf,
    process::{Command, Stdio},
};

use ed25519_dalek::{Signer as _, SigningKey};
use message_signature::{PublicKey, SignedProperties, sign, verify};
use serde_json::{Value, json};

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/foreign")
}

/// Asks joserfc about a signature of ours over a body.
fn joserfc(signature: &str, body: &str) -> Value {
    let installed = Command::new(folder().join("setup.sh")).status().expect("setup.sh runs");
    assert!(installed.success(), "tests/foreign/setup.sh failed");
    let python = folder().join("../../target/foreign/python/bin/python");
    let mut peer = Command::new(python)
        .arg(folder().join("jws/joserfc_peer.py"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the peer starts");
    let asked = json!({ "signature": signature, "body": body }).to_string();
    peer.stdin.take().expect("a pipe").write_all(asked.as_bytes()).expect("it reads");
    let output = peer.wait_with_output().expect("it ends");
    assert!(output.status.success(), "joserfc refuses the signature");
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

#[test]
fn joserfc_verifies_what_is_signed_here() {
    let key = SigningKey::from_bytes(&[7; 32]);
    let public = PublicKey::from_bytes(key.verifying_key().as_bytes()).expect("a key");
    let properties = SignedProperties {
        factory_id: "FOR_MUC".parse().expect("an id"),
        message_id: "m1".parse().expect("an id"),
        subject: "ua-data".to_owned(),
        lease: Some(7),
    };
    let body = r#"{"MessageId":"m1","Messages":[{"Payload":{"temperature":"21.5 °C"}}]}"#;
    let signature = sign(&properties, &public, body.as_bytes(), |bytes| key.sign(bytes).to_bytes());
    let answer = joserfc(&signature, body);
    assert_eq!(answer["header"]["kid"], public.to_string().as_str());
    assert_eq!(answer["header"]["factoryId"], "FOR_MUC");
    assert_eq!(answer["findsChange"], true);

    // The other way round: what it signs with a key of its own is verified here.
    let theirs = answer["signature"].as_str().expect("a signature");
    let verified = verify(theirs, body.as_bytes()).expect("it holds");
    assert_eq!(verified.properties, properties);
    assert_ne!(verified.key, public);
}
