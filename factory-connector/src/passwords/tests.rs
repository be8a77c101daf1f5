use std::path::Path;

use daemon::sealing::{SealingConfig, forget, rotate, seal_all};
use sqlx::Executor as _;

use super::*;
use crate::store::Store;

const BROKER: &str = "canary-of-the-broker";
const MACHINE: &str = "canary-of-the-machine";
/// Secret of a second factor, as bytes of a former store and as text in hexadecimal.
const FACTOR: &str = "canary-of-the-app";

/// A store as the versions before sealing left it.
async fn former_store(folder: &Path) -> StoreSession {
    let mut session = Store::connect(folder).await.expect("a store");
    let connection = session.connection();
    for sql in [
        "INSERT INTO enrolment (id, factory_id, broker_url, profile, user_name, password, enrolled_at)
         VALUES (1, 'F', 'amqps://broker', '\"embedded\"', 'factory.F', 'canary-of-the-broker', 0)",
        "INSERT INTO source (source_id, config, password) VALUES ('press', '{}', 'canary-of-the-machine')",
        "INSERT INTO source (source_id, config) VALUES ('robot', '{}')",
        "INSERT INTO user (user_name, role, password_hash, changed_at) VALUES ('eva', 'ENGINEER', 'hash', 0)",
        "INSERT INTO second_factor VALUES ('eva', CAST('canary-of-the-app' AS BLOB), 1, 7, '[]', NULL)",
    ] {
        (&mut *connection).execute(sql).await.expect("written");
    }
    session
}

fn sealer(folder: &Path) -> Sealer {
    Sealer::new(&SealingConfig::default(), folder)
}

/// Returns the passwords of broker and machine. The second factor opens, too.
async fn opened(session: &mut StoreSession, sealer: &Sealer) -> (String, String) {
    let factor = session.second_factors().lookup("eva").await.expect("read").expect("a factor");
    assert!(factor.is_confirmed && factor.last_step == 7, "{factor:?}");
    let sealed = factor.sealed_secret.expect("sealed");
    let secret = sealer.open("second-factor/eva", &sealed).expect("opened");
    assert_eq!(hex::decode(secret.expose()).expect("hexadecimal"), FACTOR.as_bytes());
    let enrolled = session.enrolments().current().await.expect("read").expect("enrolled");
    let sources = session.sources().all().await.expect("read");
    assert!(of_source(sealer, &sources[1]).expect("none").is_none());
    (
        of_broker(sealer, &enrolled).expect("opened").expose().clone(),
        of_source(sealer, &sources[0]).expect("opened").expect("one").expose().clone(),
    )
}

/// Returns true if any file of a folder has one of the passwords.
fn is_in_a_file(folder: &Path) -> bool {
    let files =
        std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("a file").path());
    files.filter(|path| path.is_file()).any(|path| {
        let bytes = std::fs::read(path).expect("readable");
        [BROKER, MACHINE, FACTOR]
            .iter()
            .any(|canary| bytes.windows(canary.len()).any(|window| window == canary.as_bytes()))
    })
}

#[tokio::test]
async fn plain_passwords_of_a_former_store_are_sealed_and_no_file_has_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = former_store(folder.path()).await;
    assert!(is_in_a_file(folder.path()), "the probe finds what is there");
    let sealer = sealer(folder.path());
    assert_eq!(seal_all(&mut session, &sealer).await.expect("sealed"), 3);
    assert!(!is_in_a_file(folder.path()), "neither database nor write-ahead log");
    assert_eq!(opened(&mut session, &sealer).await, (BROKER.to_owned(), MACHINE.to_owned()));
    assert_eq!(seal_all(&mut session, &sealer).await.expect("nothing to do"), 0);
}

#[tokio::test]
async fn a_rotation_seals_again_and_a_password_sealed_meanwhile_still_opens() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = former_store(folder.path()).await;
    let sealer = sealer(folder.path());
    seal_all(&mut session, &sealer).await.expect("sealed");
    // What a running connector sealed just before, and stores just after the rotation.
    let late = seal(&sealer, &SecretHolder::Source("press".to_owned()), "late").expect("sealed");
    assert_eq!(rotate(&mut session, &sealer).await.expect("rotated"), 3);
    assert_eq!(opened(&mut session, &sealer).await, (BROKER.to_owned(), MACHINE.to_owned()));
    let stored = session.secret_rows().all().await.expect("read");
    let of_press = &stored[1];
    assert!(session.secret_rows().replace(of_press, Some(&late)).await.expect("stored"));
    assert_eq!(opened(&mut session, &sealer).await.1, "late");
    for _ in 0..2 {
        rotate(&mut session, &sealer).await.expect("rotated again");
    }
    assert_eq!(opened(&mut session, &sealer).await, (BROKER.to_owned(), "late".to_owned()));
}

#[tokio::test]
async fn a_password_changed_meanwhile_is_not_set_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = former_store(folder.path()).await;
    let sealer = sealer(folder.path());
    seal_all(&mut session, &sealer).await.expect("sealed");
    let before = session.secret_rows().all().await.expect("read");
    rotate(&mut session, &sealer).await.expect("rotated");
    assert!(!session.secret_rows().replace(&before[0], Some("old")).await.expect("written"));
    assert_eq!(opened(&mut session, &sealer).await.0, BROKER);
}

#[tokio::test]
async fn without_its_key_a_store_says_what_to_do_and_forgets_on_command_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = former_store(folder.path()).await;
    let sealer = sealer(folder.path());
    seal_all(&mut session, &sealer).await.expect("sealed");
    std::fs::remove_file(sealer.place().path()).expect("lost");
    let fault = format!("{:#}", seal_all(&mut session, &sealer).await.expect_err("no key"));
    assert!(fault.contains("seal forget") && fault.contains("restore"), "{fault}");
    assert!(!sealer.place().path().exists(), "no other key in its place");
    let forgotten = forget(&mut session, &sealer).await.expect("forgotten");
    let press = SecretHolder::Source("press".to_owned());
    let factor = SecretHolder::SecondFactor("eva".to_owned());
    assert_eq!(forgotten, [SecretHolder::Broker, press, factor]);
    let left = session.second_factors().lookup("eva").await.expect("read").expect("a factor");
    assert!(left.is_confirmed && left.sealed_secret.is_none(), "it is on, and no code is right");
    assert_eq!(seal_all(&mut session, &sealer).await.expect("nothing is left"), 0);
    let enrolled = session.enrolments().current().await.expect("read").expect("enrolled");
    let fault = of_broker(&sealer, &enrolled).expect_err("none").to_string();
    assert!(fault.contains("enrol again"), "{fault}");
}
