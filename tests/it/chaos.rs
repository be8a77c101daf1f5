//! Short runs of random faults between factory and cloud; `make chaos` makes long ones.

use std::{process::Command, time::Duration};

use verbund_tests::{
    chaos::{self, Length},
    world::BrokerKind,
};

/// The first two rounds of each seed have each fault that a run has to have; a run without them fails, and says what its
/// machine needs for them.
const SEED: u64 = 1;

/// Returns the length of a run that is over after its first two rounds.
fn short(kills: u32) -> Length {
    Length {
        span: Duration::from_secs(15),
        kills,
        at_least_kills: 1,
        at_least_faults: 12,
        rounds_at_least: 2,
        may_lack_disks: false,
        may_lack_clocks: false,
    }
}

/// Plays the test of this name again in namespaces of its own, where disks can be mounted: users other than root may not
/// do that outside. Returns false where this process may, so that the test itself has to go on.
fn is_played_in_namespaces(name: &str) -> bool {
    if rustix::process::geteuid().is_root() {
        return false;
    }
    let this = std::env::current_exe().expect("this program");
    let mut unshare = Command::new("unshare");
    unshare.args(["--map-root-user", "--mount"]).arg(this);
    unshare.args([&format!("chaos::{name}"), "--exact", "--nocapture"]);
    let status = unshare.status().expect("`unshare`, of the package util-linux");
    assert!(status.success(), "{unshare:?} ended with {status}");
    true
}

#[tokio::test(flavor = "multi_thread")]
async fn nothing_is_lost_or_doubled_whatever_is_killed() {
    if is_played_in_namespaces("nothing_is_lost_or_doubled_whatever_is_killed") {
        return;
    }
    rustls::crypto::ring::default_provider().install_default().ok();
    chaos::run(SEED, short(30), BrokerKind::Embedded, false).await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_copied_connector_is_refused_and_reported_on_both_sides() {
    rustls::crypto::ring::default_provider().install_default().ok();
    chaos::copied(BrokerKind::Embedded).await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_connector_with_an_older_store_discloses_nothing_until_an_engineer_decides() {
    rustls::crypto::ring::default_provider().install_default().ok();
    chaos::rolled_back().await.unwrap();
}

/// The story of the demo, and then everything that can go wrong, with a broker of another make.
async fn nothing_is_lost_beside(broker: BrokerKind) {
    rustls::crypto::ring::default_provider().install_default().ok();
    chaos::run(SEED, short(20), broker, false).await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn nothing_is_lost_or_doubled_with_rabbitmq() {
    if is_played_in_namespaces("nothing_is_lost_or_doubled_with_rabbitmq") {
        return;
    }
    nothing_is_lost_beside(BrokerKind::RabbitMq).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn nothing_is_lost_or_doubled_with_mosquitto() {
    if is_played_in_namespaces("nothing_is_lost_or_doubled_with_mosquitto") {
        return;
    }
    nothing_is_lost_beside(BrokerKind::Mosquitto).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_copied_connector_is_refused_with_rabbitmq() {
    rustls::crypto::ring::default_provider().install_default().ok();
    chaos::copied(BrokerKind::RabbitMq).await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_copied_connector_is_refused_with_mosquitto() {
    rustls::crypto::ring::default_provider().install_default().ok();
    chaos::copied(BrokerKind::Mosquitto).await.unwrap();
}
