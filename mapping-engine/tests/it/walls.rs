//! Walls around the workers of scripts: none gets a script without them, and each is reported.

use std::{os::unix::fs::PermissionsExt as _, path::PathBuf};

use mapping_engine::{LandlockState, ScriptConfig, ScriptRuntime, ScriptWorkerStatus};
use script_protocol::{Landlock, PROTOCOL_VERSION, Sandbox, WorkerMessage, frame};
use tempfile::TempDir;

use crate::bench::{Bench, Worker, script_mapping};

/// Writes a worker that reports these walls and ends.
fn worker_that_reports(folder: &TempDir, sandbox: Sandbox) -> Worker {
    worker_that(folder, &format!("{}read -r _\n", greeting(sandbox)))
}

/// Returns the line of a program that greets with these walls.
fn greeting(sandbox: Sandbox) -> String {
    let engine = "a worker of this test".into();
    let welcome = WorkerMessage::Welcome { version: PROTOCOL_VERSION, engine, sandbox };
    let bytes = frame::framed(&welcome.encode()).expect("short");
    let escaped: String = bytes.iter().map(|byte| format!("\\{byte:03o}")).collect();
    format!("printf '{escaped}'\n")
}

/// Writes a worker that is this program of the shell.
fn worker_that(folder: &TempDir, program: &str) -> Worker {
    let path: PathBuf = folder.path().join("worker");
    std::fs::write(&path, format!("#!/bin/sh\n{program}")).expect("written");
    for open in [folder.path(), &path] {
        let mode = std::fs::Permissions::from_mode(0o755);
        std::fs::set_permissions(open, mode).expect("ours");
    }
    Worker { engine: ScriptRuntime::QuickJs, path, deno: None }
}

/// Tries a script, and returns what is said of it and of the worker.
async fn tried(worker: &Worker, require_filter: bool) -> (String, ScriptWorkerStatus) {
    tried_with(worker, |config| config.require_filter = require_filter).await
}

async fn tried_with(
    worker: &Worker,
    adjust: impl FnOnce(&mut ScriptConfig),
) -> (String, ScriptWorkerStatus) {
    let bench = Bench::start(worker, adjust);
    let mapping = script_mapping("tried", &["a"], "Double", "(v) => v");
    let diagnostics = bench.handle.check(mapping).await.expect("the engine runs");
    let said = diagnostics.iter().map(|diagnostic| diagnostic.message.as_str()).collect();
    let status = bench.handle.script_workers().remove(0);
    bench.stop().await;
    (said, status)
}

const UNFILTERED: Sandbox =
    Sandbox { is_filtered: false, landlock: Landlock::Partial, user_id: 7, has_limits: true };

#[tokio::test(flavor = "multi_thread")]
async fn a_worker_without_a_filter_gets_no_script_and_the_page_says_why() {
    let folder = tempfile::tempdir().expect("a folder");
    let worker = worker_that_reports(&folder, UNFILTERED);
    let (said, status) = tried(&worker, true).await;
    assert!(said.contains("mapping.script.requireFilter = false"), "{said}");
    assert!(status.walls.is_none() && status.engine.is_none(), "{status:?}");
    let fault = status.fault.expect("a reason");
    assert!(fault.contains("requireFilter"), "{fault}");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_setting_allows_it_and_the_page_shows_what_is_missing() {
    let folder = tempfile::tempdir().expect("a folder");
    let worker = worker_that_reports(&folder, UNFILTERED);
    let (said, status) = tried(&worker, false).await;
    assert!(!said.contains("requireFilter"), "{said}");
    let walls = status.walls.expect("it was taken into use");
    assert_eq!((walls.is_filtered, walls.landlock), (false, LandlockState::Partial));
    assert_eq!(walls.user_id, 7);
    assert!(walls.has_own_user && walls.has_limits);
    assert_eq!(status.engine.as_deref(), Some("a worker of this test"));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_worker_without_bounds_gets_no_script_whatever_is_set() {
    let folder = tempfile::tempdir().expect("a folder");
    let worker = worker_that_reports(
        &folder,
        Sandbox { is_filtered: true, has_limits: false, ..UNFILTERED },
    );
    let (said, status) = tried(&worker, false).await;
    assert!(said.contains("bounds") && status.fault.is_some(), "{said}");
}

const AS_ROOT: Sandbox =
    Sandbox { is_filtered: true, landlock: Landlock::Full, user_id: 0, has_limits: true };

#[tokio::test(flavor = "multi_thread")]
async fn root_is_the_user_of_no_worker_unless_a_setting_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let worker = worker_that_reports(&folder, AS_ROOT);
    let (said, status) = tried_with(&worker, |_| {}).await;
    assert!(said.contains("runs as root") && said.contains("mapping.script.userId"), "{said}");
    assert!(status.walls.is_none() && status.fault.is_some(), "{status:?}");
    let (said, status) = tried_with(&worker, |config| config.user_id = 0).await;
    assert!(!said.contains("userId"), "{said}");
    assert_eq!(status.walls.map(|walls| walls.user_id), Some(0), "the page shows it");
}

#[tokio::test(flavor = "multi_thread")]
async fn the_last_words_of_a_worker_that_does_not_start_are_shown() {
    let folder = tempfile::tempdir().expect("a folder");
    let worker = worker_that(&folder, "echo 'the engine is gone' >&2\nexit 1\n");
    let (said, status) = tried(&worker, true).await;
    assert!(said.contains("does not start: the engine is gone"), "{said}");
    assert!(status.fault.is_some_and(|fault| fault.contains("the engine is gone")));
}

#[tokio::test(flavor = "multi_thread")]
async fn an_engine_that_ends_for_want_of_memory_is_no_crash() {
    let folder = tempfile::tempdir().expect("a folder");
    // The greeting of the host has 55 bytes; with one more a script comes.
    let end =
        "/usr/bin/head -c 56 >/dev/null\necho 'Fatal JavaScript out of memory: a secret' >&2\n";
    let filtered = Sandbox { is_filtered: true, ..UNFILTERED };
    let worker = worker_that(&folder, &format!("{}{end}", greeting(filtered)));
    let (said, _) = tried(&worker, true).await;
    assert!(said.contains("more memory than there is"), "{said}");
    assert!(!said.contains("secret"), "{said}");
}
