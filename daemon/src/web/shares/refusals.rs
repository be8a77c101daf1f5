//! Count of refusals, by share and by those who had used theirs up.

/// Counts a refusal. `who` is an organisation, a factory, a tool or a person that has an account, never
/// a name that a stranger made up: so the metric has as many labels as there are accounts.
pub fn count_refusal(share: &'static str, who: &str) {
    let who = who.to_owned();
    metrics::counter!("verbund_share_refusals_total", "share" => share, "who" => who).increment(1);
}
