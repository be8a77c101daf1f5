//! The published vectors, forms that are refused, and every change of one bit.

use ed25519_dalek::{Signer as _, SigningKey};
use hmac::{Hmac, Mac as _};
use proptest::prelude::*;
use serde_json::{Value, json};

use super::*;

fn decoded(text: &str) -> Vec<u8> {
    URL_SAFE_NO_PAD.decode(text).expect("base64url")
}

/// The key of RFC 8037, appendix A.1.
fn key() -> SigningKey {
    let secret = decoded("nWGxne_9WmC6hEr0kuwsxERJxWl7MmkZcDusAxyuf2A");
    SigningKey::from_bytes(&secret.try_into().expect("32 bytes"))
}

fn public(key: &SigningKey) -> PublicKey {
    PublicKey::from_bytes(key.verifying_key().as_bytes()).expect("a key")
}

fn properties() -> SignedProperties {
    SignedProperties {
        factory_id: "FOR_MUC".parse().expect("an id"),
        message_id: "m1".parse().expect("an id"),
        subject: "ua-data".to_owned(),
        lease: Some(7),
    }
}

fn signed(body: &[u8]) -> String {
    let key = key();
    sign(&properties(), &public(&key), body, |bytes| key.sign(bytes).to_bytes())
}

/// Signs a header that is given as it stands.
fn signed_header(header: &Value, body: &[u8]) -> String {
    let header = URL_SAFE_NO_PAD.encode(header.to_string());
    let signature = key().sign(&signing_input(&header, body)).to_bytes();
    format!("{header}..{}", URL_SAFE_NO_PAD.encode(signature))
}

/// RFC 8037, appendices A.2, A.4 and A.5. Its payload is encoded, so the encoded text takes the
/// place of our unencoded one.
#[test]
fn the_vector_of_rfc_8037_holds() {
    let key = key();
    assert_eq!(public(&key).to_string(), "11qYAYKxCrfVS_7TyWQHOg7hcvPapiMlrwIaaPcHURo");
    let header = URL_SAFE_NO_PAD.encode(r#"{"alg":"EdDSA"}"#);
    let payload = URL_SAFE_NO_PAD.encode("Example of Ed25519 signing");
    let input = signing_input(&header, payload.as_bytes());
    let expected =
        "hgyY0il_MGCjP0JzlnLWG1PPOt7-09PGcvMg3AIbQR6dWbhijcNR4ki4iylGjg5BhVsPt9g7sVvpAr_MuM0KAg";
    assert_eq!(URL_SAFE_NO_PAD.encode(key.sign(&input).to_bytes()), expected);
    let signature = decoded(expected).try_into().expect("64 bytes");
    assert!(public(&key).has_signed(&input, &signature));
}

/// RFC 7797, section 4.2, with the key of RFC 7515, appendix A.1: the payload is `$.02` as it is.
#[test]
fn the_vector_of_rfc_7797_holds() {
    let text = "eyJhbGciOiJIUzI1NiIsImI2NCI6ZmFsc2UsImNyaXQiOlsiYjY0Il19..A5dxf2s96_n5FLueVuW1Z_vh161FwXZC4YLPff6dmDY";
    let (header, mac) = text.split_once("..").expect("a detached payload");
    let key =
        "AyM1SysPpbyDfgZld3umj1qzKObwVMkoqQ-EstJQLr_T-1qS0gZH75aKtMN3Yj0iPS4hcgUuTwjAzZr1Z9CAow";
    let mut hmac = Hmac::<sha2::Sha256>::new_from_slice(&decoded(key)).expect("any key");
    hmac.update(&signing_input(header, b"$.02"));
    assert_eq!(hmac.finalize().into_bytes().as_slice(), decoded(mac));
    assert_eq!(verify(text, b"$.02"), Err(SignatureError::Form), "a MAC has half the bytes");
}

#[test]
fn a_signed_message_is_verified_with_what_was_signed_beside_its_body() {
    let verified = verify(&signed(b"{}"), b"{}").expect("it holds");
    assert_eq!(verified, VerifiedMessage { key: public(&key()), properties: properties() });
    let header = signed(b"{}");
    let header = decoded(header.split_once("..").expect("detached").0);
    let expected = r#"{"alg":"EdDSA","b64":false,"crit":["b64"],"kid":"11qYAYKxCrfVS_7TyWQHOg7hcvPapiMlrwIaaPcHURo","factoryId":"FOR_MUC","messageId":"m1","subject":"ua-data","lease":7}"#;
    assert_eq!(String::from_utf8(header).expect("UTF-8"), expected);
}

#[test]
fn other_forms_are_refused() {
    let header = |changes: Value| {
        let mut header = json!({ "alg": "EdDSA", "b64": false, "crit": ["b64"],
            "kid": public(&key()).to_string(), "factoryId": "F", "messageId": "m", "subject": "s" });
        let members = header.as_object_mut().expect("an object");
        members.extend(changes.as_object().expect("an object").clone());
        members.retain(|_, value| !value.is_null());
        signed_header(&header, b"{}")
    };
    assert!(verify(&header(json!({})), b"{}").is_ok());
    assert!(verify(&header(json!({ "typ": "any" })), b"{}").is_ok(), "it means nothing to us");
    let long = "A".repeat(SIGNATURE_BYTES_MAX + 1);
    let (form, twice) = (SignatureError::Form, SignatureError::Header);
    let good = header(json!({}));
    let twice_kid = r#"{"alg":"EdDSA","kid":"a","kid":"b"}"#;
    for (text, expected) in [
        (long, SignatureError::TooLong),
        (String::new(), form),
        (good.replace("..", "."), form),
        (good.replace("..", ".e30."), form),
        (format!("{good}="), form),
        (format!("{good}."), form),
        (format!("{}..AAAA", URL_SAFE_NO_PAD.encode("{}")), form),
        (format!("{}..{}", URL_SAFE_NO_PAD.encode("{}"), "A".repeat(86)), twice),
        (format!("{}..{}", URL_SAFE_NO_PAD.encode(twice_kid), "A".repeat(86)), twice),
        (header(json!({ "alg": "none" })), SignatureError::Algorithm),
        (header(json!({ "b64": true })), SignatureError::Algorithm),
        (header(json!({ "crit": [] })), SignatureError::Algorithm),
        (header(json!({ "crit": ["b64", "exp"] })), SignatureError::Algorithm),
        (header(json!({ "b64": null })), SignatureError::Header),
        (header(json!({ "kid": "other" })), SignatureError::Key),
        (header(json!({ "kid": "A".repeat(43) })), SignatureError::Key),
        (header(json!({ "factoryId": "no id" })), SignatureError::Header),
        (header(json!({ "messageId": null })), SignatureError::Header),
        (header(json!({ "lease": -1 })), SignatureError::Header),
    ] {
        assert_eq!(verify(&text, b"{}"), Err(expected), "{text}");
    }
}

#[test]
fn a_signature_of_another_key_under_this_name_is_refused() {
    let other = SigningKey::from_bytes(&[9; 32]);
    let forged = sign(&properties(), &public(&key()), b"{}", |bytes| other.sign(bytes).to_bytes());
    assert_eq!(verify(&forged, b"{}"), Err(SignatureError::Mismatch));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Property of any body: each change of one bit, in it or in the signature, is found.
    #[test]
    fn any_single_changed_bit_is_found(
        body in proptest::collection::vec(any::<u8>(), 1..300),
        at in any::<prop::sample::Index>(),
        bit in 0_u8..8,
    ) {
        let text = signed(&body);
        prop_assert!(verify(&text, &body).is_ok());
        let mut changed = body.clone();
        changed[at.index(body.len())] ^= 1 << bit;
        prop_assert_eq!(verify(&text, &changed), Err(SignatureError::Mismatch));
        let mut bytes = text.clone().into_bytes();
        bytes[at.index(text.len())] ^= 1 << bit;
        // What is no text is none of the transport's properties, either.
        if let Ok(changed) = String::from_utf8(bytes) {
            prop_assert!(verify(&changed, &body).is_err(), "{}", changed);
        }
    }

    /// Property of any text: it is refused, and nothing panics.
    #[test]
    fn any_text_is_survived(text in "[A-Za-z0-9_.=-]{0,120}", body in any::<Vec<u8>>()) {
        prop_assert!(verify(&text, &body).is_err());
    }
}
