//! Walls around a worker, as the real one reports them.

use mapping_engine::{LandlockState, WorkerPurpose};

use super::bench::{Bench, Worker};

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
    let modules = std::fs::read_to_string("/sys/kernel/security/lsm").unwrap_or_default();
    let has_landlock = modules.split(',').any(|module| module.trim() == "landlock");
    if has_landlock {
        assert_ne!(walls.landlock, LandlockState::None, "the kernel has it: {walls:?}");
    }
    let user_id = rustix::process::geteuid();
    assert_eq!(walls.has_own_user, user_id.is_root(), "as root it is another: {walls:?}");
    assert_eq!(walls.user_id == user_id.as_raw(), !user_id.is_root());
    bench.stop().await;
}
