//! Walls around a worker, as the real one reports them.

use std::{
    ffi::{c_long, c_uint, c_void},
    fs,
    os::unix::fs::PermissionsExt as _,
    ptr,
};

use mapping_engine::{LandlockState, WorkerPurpose};

use super::bench::{Bench, Worker};

/// Version of Landlock with all rules that a worker asks for.
const ALL_RULES: c_long = 6;

/// Returns the version of Landlock that the kernel answers a worker with, if it has one.
#[allow(unsafe_code)]
fn landlock_of_the_kernel() -> Option<c_long> {
    // The same number on all processors.
    const LANDLOCK_CREATE_RULESET: c_long = 444;
    const LANDLOCK_CREATE_RULESET_VERSION: c_uint = 1;
    unsafe extern "C" {
        fn syscall(number: c_long, ...) -> c_long;
    }
    let nothing: *const c_void = ptr::null();
    // SAFETY: asked for its version, the kernel reads and writes no memory of this process.
    let version = unsafe {
        syscall(LANDLOCK_CREATE_RULESET, nothing, 0_usize, LANDLOCK_CREATE_RULESET_VERSION)
    };
    (version > 0).then_some(version)
}

pub async fn its_walls_are_reported(worker: &Worker) {
    let mut bench = Bench::start(worker, |_| {});
    bench.put_script("one", &["a"], "Double", "(v) => v").await;
    assert_eq!(bench.ask("one", 1.5).await.value, 1.5.into());
    let workers = bench.handle.script_workers();
    assert_eq!(workers.len(), 1, "{workers:?}");
    let status = &workers[0];
    assert_eq!((status.purpose, status.number), (WorkerPurpose::Mappings, 0));
    assert_eq!(status.fault, None);
    let walls = status.walls.as_ref().expect("it runs");
    assert!(walls.has_limits && status.engine.is_some(), "{status:?}");
    // By default nothing runs without: that it ran shows the filter.
    assert_eq!(walls.is_filtered, cfg!(target_os = "linux"), "{walls:?}");
    let landlock = landlock_of_the_kernel();
    let expected = match landlock {
        None => LandlockState::None,
        Some(version) if version < ALL_RULES => LandlockState::Partial,
        Some(_) => LandlockState::Full,
    };
    assert_eq!(walls.landlock, expected, "the kernel has {landlock:?}: {walls:?}");
    let user_id = rustix::process::geteuid();
    assert_eq!(walls.has_own_user, user_id.is_root(), "as root it is another: {walls:?}");
    assert_eq!(walls.user_id == user_id.as_raw(), !user_id.is_root());
    bench.stop().await;
}

/// A folder that is closed to all but its owner is what installations by hand have, and root's own.
pub async fn a_closed_folder_does_not_change_its_user(worker: &Worker) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("worker");
    fs::copy(&worker.path, &path).expect("a copy");
    let closed = fs::Permissions::from_mode(0o700);
    fs::set_permissions(folder.path(), closed).expect("ours");
    let mut bench = Bench::start(&Worker { path, ..worker.clone() }, |_| {});
    bench.put_script("one", &["a"], "Double", "(v) => v").await;
    assert_eq!(bench.ask("one", 1.5).await.value, 1.5.into());
    let walls = bench.handle.script_workers().remove(0).walls.expect("it runs");
    let user_id = rustix::process::geteuid();
    assert_eq!(walls.user_id == user_id.as_raw(), !user_id.is_root(), "{walls:?}");
    bench.stop().await;
}

/// Compares what is reported with what the kernel itself says of the process.
pub async fn the_kernel_holds_its_walls(worker: &Worker) {
    let mut bench = Bench::start(worker, |_| {});
    bench.put_script("one", &["a"], "Double", "(v) => v").await;
    assert_eq!(bench.ask("one", 1.5).await.value, 1.5.into());
    // Others of this process may be about to start.
    let filtered: Vec<String> = children()
        .into_iter()
        .filter(|child| said(child, "status", "Seccomp:").as_deref() == Some("2"))
        .collect();
    assert!(!filtered.is_empty() || !cfg!(target_os = "linux"), "no worker has a filter");
    for child in filtered {
        assert_eq!(said(&child, "status", "NoNewPrivs:").as_deref(), Some("1"));
        for bound in ["Max processes", "Max file size", "Max core file size"] {
            assert_eq!(said(&child, "limits", bound).as_deref(), Some("0"), "{bound}");
        }
        let files = said(&child, "limits", "Max open files").and_then(|files| files.parse().ok());
        assert!(files.is_some_and(|files: u32| files <= 8), "{files:?}");
    }
    bench.stop().await;
}

/// Returns the processes that this one started.
fn children() -> Vec<String> {
    let tasks = fs::read_dir("/proc/self/task").expect("a /proc");
    let lists =
        tasks.flatten().filter_map(|task| fs::read_to_string(task.path().join("children")).ok());
    lists.flat_map(|list| list.split_whitespace().map(str::to_owned).collect::<Vec<_>>()).collect()
}

/// Returns the first word after a name in a file of a process.
fn said(process: &str, file: &str, name: &str) -> Option<String> {
    let text = fs::read_to_string(format!("/proc/{process}/{file}")).ok()?;
    let rest = text.lines().find_map(|line| line.strip_prefix(name))?;
    rest.split_whitespace().next().map(str::to_owned)
}
