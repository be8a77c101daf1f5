use std::{
    io::{self, Write},
    sync::{Arc, Mutex},
};

use proptest::prelude::*;

use super::*;

/// Text of what is logged.
#[derive(Clone, Default)]
struct Log(Arc<Mutex<Vec<u8>>>);

impl Write for Log {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().expect("no panic").write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// The log of a start.
fn warned(sealer: &Sealer) -> String {
    let log = Log::default();
    let writer = log.clone();
    let subscriber =
        tracing_subscriber::fmt().with_writer(move || writer.clone()).with_ansi(false).finish();
    tracing::subscriber::with_default(subscriber, || sealer.warn_of_place());
    let bytes = log.0.lock().expect("no panic").clone();
    String::from_utf8(bytes).expect("text")
}

fn sealer(folder: &Path) -> Sealer {
    Sealer::with_credentials(&SealingConfig::default(), folder, None)
}

#[test]
fn a_password_opens_for_its_purpose_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let sealer = sealer(folder.path());
    let sealed = sealer.seal("source/press", "canary").expect("sealed");
    assert!(!sealed.contains("canary"));
    assert_ne!(sealed, sealer.seal("source/press", "canary").expect("sealed"), "no nonce twice");
    assert_eq!(sealer.open("source/press", &sealed).expect("opened").expose(), "canary");
    for other in ["source/robot", ""] {
        let refused = sealer.open(other, &sealed);
        assert!(matches!(refused, Err(SealingError::Unreadable)), "{other}");
    }
}

#[test]
fn sealed_texts_differ_from_passwords_by_their_form() {
    let folder = tempfile::tempdir().expect("a folder");
    let sealed = sealer(folder.path()).seal("broker", "").expect("sealed");
    assert!(is_sealed(&sealed));
    let cut = &sealed[..sealed.len() - 2];
    for plain in ["", "v1", "v1.pass.word", "v1.0123456789abcdef.AAAA", cut] {
        assert!(!is_sealed(plain), "{plain}");
    }
}

#[test]
fn a_changed_text_opens_nowhere() {
    let folder = tempfile::tempdir().expect("a folder");
    let sealer = sealer(folder.path());
    let sealed = sealer.seal("broker", "canary").expect("sealed");
    let body = sealed.rfind('.').expect("parts") + 1;
    for at in body..sealed.len() {
        let mut changed = sealed.clone().into_bytes();
        changed[at] = if changed[at] == b'A' { b'B' } else { b'A' };
        let changed = String::from_utf8(changed).expect("text");
        // The last sign has bits that count for nothing.
        if parts(&changed).is_ok_and(|(_, bytes)| parts(&sealed).is_ok_and(|(_, b)| b == bytes)) {
            continue;
        }
        assert!(sealer.open("broker", &changed).is_err(), "sign {at}");
    }
}

#[test]
fn a_store_without_its_key_names_the_key() {
    let folder = tempfile::tempdir().expect("a folder");
    let other = tempfile::tempdir().expect("a folder");
    let sealed = sealer(folder.path()).seal("broker", "canary").expect("sealed");
    let none = sealer(other.path()).open("broker", &sealed).expect_err("no key");
    assert!(matches!(none, SealingError::Key(_)), "{none}");
    assert!(!other.path().join(KEY_FILE).exists(), "opening makes no key");
    sealer(other.path()).seal("broker", "x").expect("another key");
    let other = sealer(other.path()).open("broker", &sealed).expect_err("another key");
    assert!(matches!(other, SealingError::UnknownKey { .. }), "{other}");
}

#[test]
fn a_renewed_key_opens_what_the_one_before_has_sealed() {
    let folder = tempfile::tempdir().expect("a folder");
    let sealer = sealer(folder.path());
    let first = sealer.seal("broker", "canary").expect("sealed");
    sealer.renew().expect("renewed");
    let second = sealer.seal("broker", "canary").expect("sealed");
    assert!(
        !sealer.is_current(&first).expect("a key") && sealer.is_current(&second).expect("a key")
    );
    assert_eq!(sealer.open("broker", &first).expect("opened").expose(), "canary");
    sealer.renew().expect("renewed again");
    assert!(matches!(sealer.open("broker", &first), Err(SealingError::UnknownKey { .. })));
    assert_eq!(sealer.open("broker", &second).expect("opened").expose(), "canary");
}

#[test]
fn a_credential_comes_before_a_file_and_is_never_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = SealingConfig { key_file: Some(folder.path().join("configured")) };
    let credentials = folder.path().join("credentials");
    std::fs::create_dir(&credentials).expect("made");
    let store = folder.path().join("store");
    let chosen = || Sealer::with_credentials(&config, &store, Some(&credentials)).place().clone();
    assert_eq!(chosen(), KeyPlace::Configured(folder.path().join("configured")));
    let credential = credentials.join(CREDENTIAL);
    std::fs::write(&credential, new_key().expect("a key").expose()).expect("written");
    let for_the_service = std::os::unix::fs::PermissionsExt::from_mode(0o400);
    std::fs::set_permissions(&credential, for_the_service).expect("ours");
    assert_eq!(chosen(), KeyPlace::Credential(credential.clone()));
    let sealer = Sealer::with_credentials(&config, &store, Some(&credentials));
    assert!(!sealer.is_beside_store());
    let sealed = sealer.seal("broker", "canary").expect("sealed");
    assert_eq!(sealer.open("broker", &sealed).expect("opened").expose(), "canary");
    assert!(matches!(sealer.renew(), Err(SealingError::Credential)));
}

#[test]
fn a_key_in_the_folder_of_the_store_is_beside_it_by_whatever_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let (store, elsewhere) = (folder.path().join("store"), folder.path().join("keys"));
    for made in [&store, &elsewhere] {
        std::fs::create_dir(made).expect("made");
    }
    let link = folder.path().join("link");
    std::os::unix::fs::symlink(&store, &link).expect("linked");
    for (key_file, is_beside) in [
        (None, true),
        (Some(store.join("another-name")), true),
        (Some(elsewhere.join("../store/key")), true),
        (Some(link.join("key")), true),
        (Some(elsewhere.join("key")), false),
    ] {
        let config = SealingConfig { key_file: key_file.clone() };
        let sealer = Sealer::with_credentials(&config, &store, None);
        assert_eq!(sealer.is_beside_store(), is_beside, "{key_file:?}");
        let log = warned(&sealer);
        let names_the_ways = ["BESIDE THE STORE", CREDENTIAL, "sealing.key_file"];
        assert_eq!(names_the_ways.iter().all(|word| log.contains(word)), is_beside, "{log}");
        assert_eq!(log.lines().count(), usize::from(is_beside), "{log}");
    }
}

proptest! {
    #[test]
    fn any_password_survives(password in ".{0,200}", purpose in ".{0,40}") {
        let key = Key::random().expect("random bytes");
        let sealed = seal_with(&key, &purpose, &password).expect("sealed");
        let (_, body) = parts(&sealed).expect("ours");
        let opened = open_with(&key, &purpose, body).expect("opened");
        prop_assert_eq!(opened.expose(), &password);
    }

    #[test]
    fn any_text_is_met_without_panic(text in ".{0,200}") {
        if let Ok((_, body)) = parts(&text) {
            drop(open_with(&Key::random().expect("random bytes"), "", body));
        }
    }
}
