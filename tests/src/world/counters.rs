//! A machine of each factory that counts at a steady rate, so that a count that is in no report is seen.

/// Name of the machine.
pub(crate) const COUNTERS: &str = "Counters";
/// Number of its counters.
pub(crate) const COUNT: usize = 3;
/// Time between two counts of each, in milliseconds: several publishing intervals.
pub(crate) const COUNTED_EACH_MS: i64 = 250;

/// Returns its configuration.
pub(super) fn configuration(port: u16) -> String {
    let rate = COUNT as f64 * 1000.0 / COUNTED_EACH_MS as f64;
    format!(
        "name = \"{COUNTERS}\"\nkind = \"bank\"\nport = {port}\nvariables = {COUNT}\nchanges_per_second = {rate:.1}"
    )
}
