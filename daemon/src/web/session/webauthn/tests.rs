//! Answers of browsers, with any byte changed.

use std::time::Duration;

use base64::{Engine as _, engine::general_purpose::URL_SAFE_NO_PAD};
use serde_json::{Value, json};
use testkit::SecurityKey;

use super::*;

const LIFETIME: Duration = Duration::from_secs(120);
const PAGES: &str = "https://verbund.example";

fn party() -> RelyingParty {
    RelyingParty::of(PAGES).expect("a domain")
}

fn begun(party: &RelyingParty) -> (RegistrationState, Value) {
    let registrant =
        Registrant { user_name: "ann", issuer: "Verbund", user_handle: [7; 16], passkeys: &[] };
    let (_, state, options) = begin_registration(party, &registrant, LIFETIME).expect("options");
    (state, options)
}

fn registered(
    party: &RelyingParty,
    state: RegistrationState,
    credential: &Value,
) -> Result<StoredPasskey, WebauthnError> {
    let naming = Naming {
        passkey_id: "p".to_owned(),
        name: "Blue key".to_owned(),
        created_at: std::time::UNIX_EPOCH,
    };
    Attestation::parse(credential)?.1.verify(party, state, naming)
}

/// Returns a credential with a byte of a member changed, or cut there; `None` behind the last byte.
fn changed(credential: &Value, member: &str, change: usize) -> Option<Value> {
    let text = credential["response"][member].as_str().expect("a text");
    let mut bytes = URL_SAFE_NO_PAD.decode(text).expect("bytes");
    let at = change / 2;
    *bytes.get_mut(at)? ^= 1;
    if change % 2 == 1 {
        bytes.truncate(at);
    }
    let mut other = credential.clone();
    other["response"][member] = json!(URL_SAFE_NO_PAD.encode(bytes));
    Some(other)
}

#[test]
fn a_changed_or_cut_assertion_is_refused_wherever_the_change_is() {
    let party = party();
    let mut key = SecurityKey::new("blue", PAGES);
    let (state, options) = begun(&party);
    let passkey = registered(&party, state, &key.create(&options)).expect("registered");
    let passkeys = [passkey];
    let check = |change: &dyn Fn(&Value) -> Option<Value>, key: &mut SecurityKey| {
        let (challenge, state, options) =
            begin_assertion(&party, &passkeys, LIFETIME).expect("options");
        let sent = change(&key.get(&options))?;
        let parsed = Assertion::parse(&sent.to_string());
        Some(parsed.and_then(|(sent, assertion)| {
            if sent == challenge {
                assertion.verify(&party, state, &passkeys[0])
            } else {
                Err(WebauthnError::NoChallenge)
            }
        }))
    };
    let whole = check(&|sent| Some(sent.clone()), &mut key).expect("sent");
    assert!(whole.is_ok(), "{whole:?}");
    for member in ["clientDataJSON", "authenticatorData", "signature"] {
        for at in 0.. {
            let Some(outcome) = check(&|sent| changed(sent, member, at), &mut key) else { break };
            assert!(outcome.is_err(), "{member}, change {at}");
        }
    }
}

#[test]
fn a_changed_or_cut_credential_is_no_fault_of_ours() {
    let party = party();
    let mut key = SecurityKey::new("blue", PAGES);
    let mut accepted = 0;
    for member in ["clientDataJSON", "attestationObject", "publicKey", "authenticatorData"] {
        for at in 0.. {
            let (state, options) = begun(&party);
            let Some(sent) = changed(&key.create(&options), member, at) else { break };
            // Without an attestation nobody vouches for model and counter; the key itself is a point or not.
            accepted += usize::from(registered(&party, state, &sent).is_ok());
        }
    }
    assert!(accepted < 100, "{accepted} changes passed");
}

#[test]
fn a_long_id_is_refused_since_it_would_not_fit_into_a_sign_in() {
    let party = party();
    let mut key = SecurityKey::new("blue", PAGES);
    key.set_credential_id(vec![1; CREDENTIAL_ID_BYTES_MAX]);
    let (state, options) = begun(&party);
    assert!(registered(&party, state, &key.create(&options)).is_ok());
    key.set_credential_id(vec![1; CREDENTIAL_ID_BYTES_MAX + 1]);
    let (state, options) = begun(&party);
    let long = registered(&party, state, &key.create(&options));
    assert!(matches!(long, Err(WebauthnError::LongId)), "{long:?}");
}
