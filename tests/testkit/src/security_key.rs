//! A security key in software, with the browser in front of it (WebAuthn Level 3): makes a credential on
//! P-256 and signs assertions with it.

use base64::{Engine as _, engine::general_purpose::URL_SAFE_NO_PAD};
use p256::ecdsa::{Signature, SigningKey, signature::Signer as _};
use serde_json::{Value, json};
use sha2::{Digest as _, Sha256};

/// User present, and user verified.
const PRESENT: u8 = 0x05;
/// A credential is attached.
const ATTESTED: u8 = 0x40;
/// DER of a public key on P-256, before its two coordinates.
const PUBLIC_KEY_HEAD: &[u8] = &[
    0x30, 0x59, 0x30, 0x13, 0x06, 0x07, 0x2a, 0x86, 0x48, 0xce, 0x3d, 0x02, 0x01, 0x06, 0x08, 0x2a,
    0x86, 0x48, 0xce, 0x3d, 0x03, 0x01, 0x07, 0x03, 0x42, 0x00, 0x04,
];

/// A security key with one credential.
pub struct SecurityKey {
    /// Origin of the page, as the browser states it.
    pub origin: String,
    /// Id of the relying party whose hash is signed, where it is another than that of the options.
    pub rp_id: Option<String>,
    /// Counter of the last signature.
    pub counter: u32,
    /// Handle of the user; from the options of the creation.
    pub user_handle: Option<Value>,
    key: SigningKey,
    credential_id: Vec<u8>,
}

impl SecurityKey {
    /// Makes a key for pages of this origin; a name has the same key each time.
    ///
    /// # Panics
    /// A hash of the name that is no key; no test has one.
    #[must_use]
    pub fn new(name: &str, origin: &str) -> Self {
        Self {
            origin: origin.to_owned(),
            rp_id: None,
            counter: 0,
            user_handle: None,
            key: SigningKey::from_slice(&Sha256::digest(name)).expect("a key"),
            credential_id: Sha256::digest(format!("credential of {name}")).to_vec(),
        }
    }

    /// Names the credential otherwise, as keys do that keep no credentials and have all in the name.
    pub fn set_credential_id(&mut self, credential_id: Vec<u8>) {
        self.credential_id = credential_id;
    }

    /// Answers `navigator.credentials.create`.
    #[must_use]
    pub fn create(&mut self, options: &Value) -> Value {
        self.user_handle = Some(options["user"]["id"].clone());
        let client_data = self.client_data("webauthn.create", options);
        let point = self.key.verifying_key().to_encoded_point(false);
        let (x, y) = (point.x().expect("a coordinate"), point.y().expect("a coordinate"));
        let length = u16::try_from(self.credential_id.len()).expect("short").to_be_bytes();
        let mut data = self.authenticator_data(&options["rp"]["id"], PRESENT | ATTESTED);
        data.extend([0; 16]);
        data.extend(length);
        data.extend(&self.credential_id);
        // COSE: type EC2, algorithm ES256, curve P-256, and the coordinates.
        data.extend([0xa5, 1, 2, 3, 0x26, 0x20, 1, 0x21, 0x58, 32]);
        data.extend(x);
        data.extend([0x22, 0x58, 32]);
        data.extend(y);
        let mut object = b"\xa3\x63fmt\x64none\x67attStmt\xa0\x68authData".to_vec();
        // CBOR wants the shortest form of a length.
        match u8::try_from(data.len()) {
            Ok(length) => object.extend([0x58, length]),
            Err(_) => {
                object.push(0x59);
                object.extend(u16::try_from(data.len()).expect("short").to_be_bytes());
            }
        }
        object.extend(&data);
        self.credential(&json!({
            "clientDataJSON": encoded(&client_data),
            "attestationObject": encoded(&object),
            "authenticatorData": encoded(&data),
            "publicKey": encoded(&[PUBLIC_KEY_HEAD, x, y].concat()),
            "publicKeyAlgorithm": -7,
            "transports": ["usb"],
        }))
    }

    /// Answers `navigator.credentials.get`.
    #[must_use]
    pub fn get(&mut self, options: &Value) -> Value {
        self.counter += 1;
        let client_data = self.client_data("webauthn.get", options);
        let data = self.authenticator_data(&options["rpId"], PRESENT);
        let signed = [&data[..], &Sha256::digest(&client_data)[..]].concat();
        let signature: Signature = self.key.sign(&signed);
        self.credential(&json!({
            "clientDataJSON": encoded(&client_data),
            "authenticatorData": encoded(&data),
            "signature": encoded(signature.to_der().as_bytes()),
            "userHandle": self.user_handle,
        }))
    }

    fn client_data(&self, kind: &str, options: &Value) -> Vec<u8> {
        let data = json!({
            "type": kind,
            "challenge": options["challenge"],
            "origin": self.origin,
            "crossOrigin": false,
        });
        data.to_string().into_bytes()
    }

    fn authenticator_data(&self, rp_id: &Value, flags: u8) -> Vec<u8> {
        let rp_id = self.rp_id.as_deref().or(rp_id.as_str()).expect("an id");
        let mut data = Sha256::digest(rp_id).to_vec();
        data.push(flags);
        data.extend(self.counter.to_be_bytes());
        data
    }

    fn credential(&self, response: &Value) -> Value {
        json!({
            "id": encoded(&self.credential_id),
            "rawId": encoded(&self.credential_id),
            "type": "public-key",
            "authenticatorAttachment": "cross-platform",
            "clientExtensionResults": {},
            "response": response,
        })
    }
}

fn encoded(bytes: &[u8]) -> String {
    URL_SAFE_NO_PAD.encode(bytes)
}
