use ed25519_dalek::SigningKey;
use proptest::prelude::*;

use super::*;

fn key(name: &str, kind: KeyKind, seed: u8) -> NoteKey {
    NoteKey::new(name, kind, SigningKey::from_bytes(&[seed; 32])).expect("a name")
}

fn signed(text: &str) -> SignedNote {
    let mut note = SignedNote::new(text).expect("a text");
    note.sign(&key("log", KeyKind::Ed25519, 1)).expect("a key for texts");
    note.cosign(&key("witness", KeyKind::CosignatureV1, 2), 1_760_000_000).expect("a cosigner");
    note
}

#[test]
fn a_note_survives_its_text_and_verifies() {
    for text in ["a\n", "a\n\nb\n", "\n\n", "ä \u{2014} name\n"] {
        let note = signed(text);
        let again = SignedNote::parse(&note.to_string()).expect("reads back");
        assert_eq!(again, note, "{text:?}");
        let log = key("log", KeyKind::Ed25519, 1);
        let witness = key("witness", KeyKind::CosignatureV1, 2);
        let verified = again.verify([log.verifier(), witness.verifier()]).expect("both signed");
        let times: Vec<_> = verified.iter().map(|found| found.cosigned_at).collect();
        assert_eq!(times, [None, Some(1_760_000_000)]);
    }
}

#[test]
fn only_the_one_form_is_read() {
    let check = |note: &str, expected: NoteError| {
        assert_eq!(SignedNote::parse(note), Err(expected), "{note:?}");
    };
    let good = signed("a\n").to_string();
    let line = good.lines().nth(2).expect("a signature").to_owned();
    check("", NoteError::NoSignatures);
    check("a\n", NoteError::NoSignatures);
    check(&format!("\n\n{line}\n"), NoteError::Text);
    check(&format!("a\r\n\n{line}\n"), NoteError::Text);
    check(&format!("a\0\n\n{line}\n"), NoteError::Text);
    check(good.trim_end(), NoteError::Signature);
    check("a\n\n", NoteError::Signature);
    check("a\n\n\n", NoteError::Signature);
    check(&format!("a\n\n{line}\nb\n"), NoteError::Signature);
    check(&format!("a\n\n{}\n", line.replace('\u{2014}', "-")), NoteError::Signature);
    check(&format!("a\n\n{}\n", line.replace(" log", " lo+g")), NoteError::Signature);
    check(&format!("a\n\n{}\n", line.trim_end_matches('=')), NoteError::Signature);
    check("a\n\n\u{2014} log AAAAAA==\n", NoteError::Signature);
    check(&format!("a\n\n{}", format!("{line}\n").repeat(17)), NoteError::TooLong);
    check(&format!("{}\n\n{line}\n", "a".repeat(NOTE_BYTES_MAX)), NoteError::TooLong);
    assert!(SignedNote::parse(&format!("a\n\n{}", format!("{line}\n").repeat(16))).is_ok());
}

#[test]
fn unknown_lines_are_left_alone_and_forged_ones_refused() {
    let note = signed("a\n");
    let log = key("log", KeyKind::Ed25519, 1);
    let unknown = key("log", KeyKind::Ed25519, 3);
    let other_name = key("other", KeyKind::Ed25519, 1);
    assert_eq!(note.verify([unknown.verifier()]), Err(NoteError::Unsigned));
    assert_eq!(note.verify([other_name.verifier()]), Err(NoteError::Unsigned));
    assert_eq!(note.verify([unknown.verifier(), log.verifier()]).expect("signed").len(), 1);
    let forged = SignedNote { text: "b\n".to_owned(), signatures: note.signatures.clone() };
    assert_eq!(forged.verify([log.verifier()]), Err(NoteError::Forged));
    let mut doubled = note.clone();
    doubled.signatures.push(note.signatures[0].clone());
    assert_eq!(doubled.verify([log.verifier()]).expect("signed").len(), 1, "once per key");
    // The same key under the other kind has another id: a line of one is none of the other.
    let as_cosigner = key("log", KeyKind::CosignatureV1, 1);
    assert_eq!(note.verify([as_cosigner.verifier()]), Err(NoteError::Unsigned));
    let mut note = note;
    assert_eq!(note.sign(&as_cosigner), Err(NoteError::Kind));
    assert_eq!(note.cosign(&log, 1), Err(NoteError::Kind));
    assert_eq!(note.cosign(&as_cosigner, u64::MAX), Err(NoteError::Kind));
}

#[test]
fn keys_have_one_text_each() {
    let text = "cloud.example/w1+2b338fc3+BCmsuuFBvMrwsi4alNNNC8c2HlJtC/4SyJeUvJMilm3X";
    let key: VerifierKey = text.parse().expect("a key");
    assert_eq!((key.name(), key.kind()), ("cloud.example/w1", KeyKind::CosignatureV1));
    assert_eq!(key.to_string(), text);
    let check = |text: &str, expected| {
        assert_eq!(text.parse::<VerifierKey>().map(drop), Err(expected), "{text}");
    };
    check("", KeyError::Form);
    check("a+b", KeyError::Form);
    check(&text.replace("2b338fc3", "4adcbd3c"), KeyError::Id);
    check(&text.replace("w1", "w2"), KeyError::Id);
    check(&text.replace("w1", "w 1"), KeyError::Name);
    check(&text.replace("BCms", "Bims"), KeyError::Kind);
    check(&text.replace("BCmsuuFB", "BCms"), KeyError::Key);
    // The neutral element of the group: it verifies any text.
    check("a+00000000+AQEAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA", KeyError::Key);
}

proptest! {
    #[test]
    fn what_is_read_is_written_the_same(note in "(\\PC|\n|\u{2014} |A|=){0,60}") {
        if let Ok(parsed) = SignedNote::parse(&note) {
            prop_assert_eq!(parsed.to_string(), note);
        }
    }

    #[test]
    fn no_changed_byte_of_a_note_verifies(place in 0_usize..300, by in 1_u8..=255) {
        let intact = signed("origin\n7\nroot\n").to_string();
        let mut bytes = intact.clone().into_bytes();
        let place = place % bytes.len();
        bytes[place] ^= by;
        let log = key("log", KeyKind::Ed25519, 1);
        let witness = key("witness", KeyKind::CosignatureV1, 2);
        let keys = [log.verifier(), witness.verifier()];
        let changed = String::from_utf8(bytes).ok().and_then(|text| SignedNote::parse(&text).ok());
        // A line whose name or id was changed is one of an unknown key.
        if let Some(changed) = changed {
            prop_assert!(changed.verify(keys).map_or(true, |verified| verified.len() < 2));
        }
    }
}
