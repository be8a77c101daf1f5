//! The conformance suite against this worker, or against `script-deno` where `SCRIPT_DENO` names
//! its binary: one suite holds both to the same behaviour. The second engine is built outside of
//! the workspace.

#[path = "../../../tests/conformance/suite.rs"]
mod suite;

use mapping_engine::ScriptRuntime;
use suite::Worker;

fn worker() -> Worker {
    match std::env::var_os("SCRIPT_DENO") {
        Some(path) => Worker { engine: ScriptRuntime::Deno, path: path.into() },
        None => Worker {
            engine: ScriptRuntime::QuickJs,
            path: env!("CARGO_BIN_EXE_script-quickjs").into(),
        },
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
    checks_and_dry_runs_show_everything,
    faults_have_kind_and_place,
    hostile_scripts_end_in_time_and_disturb_nobody,
    its_walls_are_reported,
    results_are_typed,
    scripts_rest_and_are_reset_by_hand,
    state_survives_the_worker,
    the_sandbox_has_no_way_out,
    values_keep_their_order_under_load,
}
