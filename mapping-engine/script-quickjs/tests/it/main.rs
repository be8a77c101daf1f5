//! The conformance suite against this worker; `script-deno` has the same.

#[path = "../../../tests/conformance/suite.rs"]
mod suite;

use mapping_engine::ScriptRuntime;
use suite::Worker;

fn worker() -> Worker {
    Worker {
        engine: ScriptRuntime::QuickJs,
        path: env!("CARGO_BIN_EXE_script-quickjs").into(),
        deno: None,
    }
}

macro_rules! conform {
    ($($name:ident),* $(,)?) => {$(
        #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
        async fn $name() {
            suite::$name(&worker()).await;
        }
    )*};
}

conform! {
    a_broken_worker_is_a_diagnostic,
    a_closed_folder_does_not_change_its_user,
    a_full_memory_is_said_and_disturbs_nobody,
    checks_and_dry_runs_show_everything,
    faults_have_kind_and_place,
    hostile_scripts_end_in_time_and_disturb_nobody,
    its_walls_are_reported,
    results_are_typed,
    scripts_rest_and_are_reset_by_hand,
    state_survives_the_worker,
    the_kernel_holds_its_walls,
    the_sandbox_has_no_way_out,
    values_keep_their_order_under_load,
}
