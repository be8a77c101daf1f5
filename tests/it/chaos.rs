//! Short runs of random faults between factory and cloud; `make chaos` makes long ones.

use std::time::Duration;

use verbund_tests::chaos::{self, Length};

/// The first rounds of this seed hold kills of every program, an old broker store, a slow and a
/// stalled line.
const SEED: u64 = 1;

#[tokio::test(flavor = "multi_thread")]
async fn nothing_is_lost_or_doubled_whatever_is_killed() {
    rustls::crypto::ring::default_provider().install_default().ok();
    let length = Length { span: Duration::from_secs(15), kills: 30, at_least_kills: 1 };
    chaos::run(SEED, length, false).await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_copied_connector_is_refused_and_reported_on_both_sides() {
    rustls::crypto::ring::default_provider().install_default().ok();
    chaos::copied().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_connector_with_an_older_store_discloses_nothing_until_an_engineer_decides() {
    rustls::crypto::ring::default_provider().install_default().ok();
    chaos::rolled_back().await.unwrap();
}
