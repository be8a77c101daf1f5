use std::path::Path;

use daemon::sealing::{Sealer, SealingConfig, forget, rotate, seal_all};

use sqlx::{Connection as _, SqliteConnection, sqlite::SqliteConnectOptions};

use super::*;
use crate::store::Scope;

const SECRET: &str = "canary-of-the-app";

/// A database as the versions before sealing left it.
async fn former_database(folder: &Path) -> Store {
    let path = folder.join("platform.sqlite");
    let store = Store::open(&path).await.expect("a database");
    let options = SqliteConnectOptions::new().filename(path);
    let mut connection = SqliteConnection::connect_with(&options).await.expect("connected");
    for sql in [
        "INSERT INTO user_account (user_name, role, password_hash, created_at)
         VALUES ('eva', 'ADMINISTRATOR', 'hash', 0)",
        "INSERT INTO second_factor VALUES ('eva', CAST('canary-of-the-app' AS BLOB), 1, 7, '[]', NULL)",
    ] {
        sqlx::query(sql).execute(&mut connection).await.expect("written");
    }
    connection.close().await.expect("closed");
    store
}

async fn opened(store: &Store, sealer: &Sealer) -> Vec<u8> {
    let mut work = store.read().await.expect("begun");
    let factor = work.second_factors().lookup("eva").await.expect("read").expect("a factor");
    assert!(factor.is_confirmed && factor.last_step == 7, "{factor:?}");
    let sealed = factor.sealed_secret.expect("sealed");
    let secret = sealer.open("second-factor/eva", &sealed).expect("opened");
    hex::decode(secret.expose()).expect("hexadecimal")
}

/// Returns operation and subject of each entry of the record.
async fn entries(store: &Store) -> Vec<String> {
    let mut work = store.read().await.expect("begun");
    let entries = work.audit().list_after(&Scope::Platform, 0, 100).await.expect("listed");
    entries.iter().map(|entry| format!("{} {}", entry.operation, entry.subject)).collect()
}

/// Returns true if any file of a folder has the secret.
fn is_in_a_file(folder: &Path) -> bool {
    let files = std::fs::read_dir(folder).expect("a folder");
    files.map(|entry| entry.expect("a file").path()).filter(|path| path.is_file()).any(|path| {
        let bytes = std::fs::read(path).expect("readable");
        bytes.windows(SECRET.len()).any(|window| window == SECRET.as_bytes())
    })
}

#[tokio::test]
async fn secrets_of_a_former_database_are_sealed_rotated_and_forgotten_on_command() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut store = former_database(folder.path()).await;
    assert!(is_in_a_file(folder.path()), "the probe finds what is there");
    let sealer = Sealer::new(&SealingConfig::default(), folder.path());
    assert_eq!(seal_all(&mut store, &sealer).await.expect("sealed"), 1);
    assert!(!is_in_a_file(folder.path()), "neither database nor write-ahead log");
    assert_eq!(opened(&store, &sealer).await, SECRET.as_bytes());
    assert_eq!(rotate(&mut store, &sealer).await.expect("rotated"), 1);
    assert_eq!(opened(&store, &sealer).await, SECRET.as_bytes());

    std::fs::remove_file(sealer.place().path()).expect("lost");
    let fault = format!("{:#}", seal_all(&mut store, &sealer).await.expect_err("no key"));
    assert!(fault.contains("platform seal forget") && fault.contains("restore"), "{fault}");
    assert!(!sealer.place().path().exists(), "no other key in its place");
    assert_eq!(entries(&store).await, [""; 0], "nothing was removed yet");
    assert_eq!(forget(&mut store, &sealer).await.expect("forgotten"), ["eva"]);
    assert_eq!(entries(&store).await, ["forgetSecret users/eva/second-factor"]);
    assert!(forget(&mut store, &sealer).await.expect("none is left").is_empty());
    assert_eq!(entries(&store).await.len(), 1, "what was removed, once");
    assert_eq!(seal_all(&mut store, &sealer).await.expect("nothing is left"), 0);
    let mut work = store.read().await.expect("begun");
    let left = work.second_factors().lookup("eva").await.expect("read").expect("a factor");
    assert!(left.is_confirmed && left.sealed_secret.is_none(), "it is on, and no code is right");
}
