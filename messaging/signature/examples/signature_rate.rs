//! Measures the time to sign and to verify one message, by the size of its body. `cargo run --release -p
//! message-signature --example signature_rate`.

#![allow(clippy::disallowed_methods, reason = "measured by the machine's clock")]

use std::{io::Write as _, time::Instant};

use ed25519_dalek::{Signer as _, SigningKey};
use message_signature::{PublicKey, SignedProperties, sign, verify};

/// Messages per measurement.
const MESSAGES: u32 = 5_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let key = SigningKey::from_bytes(&[7; 32]);
    let public = PublicKey::from_bytes(key.verifying_key().as_bytes())?;
    let properties = SignedProperties {
        factory_id: "FOR_MUC".parse()?,
        message_id: "3ea281da-fad0-42e0-8c9a-713bd4257fec".parse()?,
        subject: "ua-data".to_owned(),
        lease: Some(1),
    };
    for bytes in [700, 8 * 1024, 64 * 1024] {
        let body = vec![b'x'; bytes];
        let signed = || sign(&properties, &public, &body, |bytes| key.sign(bytes).to_bytes());
        let signature = signed();
        let started = Instant::now();
        (0..MESSAGES).for_each(|_| drop(std::hint::black_box(signed())));
        let signing = started.elapsed() / MESSAGES;
        let started = Instant::now();
        for _ in 0..MESSAGES {
            std::hint::black_box(verify(&signature, &body)?);
        }
        let verifying = started.elapsed() / MESSAGES;
        writeln!(
            std::io::stdout(),
            "body of {bytes} bytes: signed in {signing:?}, verified in {verifying:?}; the signature has {} bytes",
            signature.len()
        )?;
    }
    Ok(())
}
