//! Conformance suite of script workers: one suite, run against each worker binary through the whole
//! mapping engine.

mod bench;
mod hostile;
mod language;
mod lifecycle;
mod walls;

pub use bench::Worker;
pub use hostile::{
    a_full_memory_is_said_and_disturbs_nobody, hostile_scripts_end_in_time_and_disturb_nobody,
};
pub use language::{faults_have_kind_and_place, results_are_typed, the_sandbox_has_no_way_out};
pub use lifecycle::{
    a_broken_worker_is_a_diagnostic, checks_and_dry_runs_show_everything,
    scripts_rest_and_are_reset_by_hand, state_survives_the_worker,
    values_keep_their_order_under_load,
};
pub use walls::{
    a_closed_folder_does_not_change_its_user, its_walls_are_reported, the_kernel_holds_its_walls,
};

impl bench::Bench {
    /// Publishes a script mapping `id` of the inputs named, to a field of a type.
    async fn put_script(&self, id: &str, inputs: &[&str], target: &str, source: &str) {
        let mapping = bench::script_mapping(id, inputs, target, source);
        self.put(mapping).await;
    }
}
