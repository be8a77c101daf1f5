//! Protected servers: trust both ways, users, endpoints.

use shop_floor::{
    Identity, SecurityChoice, SecurityPolicy, SourceConfig, SourceId, SourceProblemKind, TrustState,
};
use simulator::{MachineConfig, MachineHandle, MachineKind, SecurityConfig, UserConfig};

use crate::support::{Simulation, TestShopFloor, node, until};

fn protected(name: &str) -> MachineConfig {
    let mut machine = MachineConfig::new(name, MachineKind::Press);
    machine.security = SecurityConfig {
        unprotected: false,
        protected: true,
        anonymous: false,
        users: vec![UserConfig { name: "connector".into(), password: "press".into() }],
        trusts_all_clients: false,
    };
    machine
}

fn source(machine: &MachineHandle, password: &str) -> SourceConfig {
    let mut source =
        SourceConfig::new(SourceId::new(machine.name()).expect("valid"), machine.endpoint_url());
    source.identity =
        Identity::UserName { user_name: "connector".into(), password: password.into() };
    source
}

fn problem(floor: &TestShopFloor, id: &SourceId) -> Option<SourceProblemKind> {
    floor.status(id).problem.map(|problem| problem.kind)
}

#[tokio::test]
async fn trust_is_given_by_people_on_both_sides_and_the_user_signs_in() {
    let simulation = Simulation::of(vec![protected("Press")]).await;
    let press = simulation.machine("Press");
    let floor = TestShopFloor::start();
    let wrong = source(&press, "wrong");
    let id = wrong.source_id.clone();
    floor.handle.put_source(wrong).expect("valid");

    // First we do not trust the server.
    let kind = SourceProblemKind::ServerCertificateUntrusted;
    until("the server's certificate is shown", || problem(&floor, &id) == Some(kind)).await;
    let shown = floor.handle.certificates().await.expect("certificates");
    assert_eq!(shown.len(), 1);
    assert_eq!(shown[0].trust, TrustState::Rejected);
    floor.handle.set_trust(&shown[0].thumbprint, TrustState::Trusted).await.expect("approved");

    // Then it does not trust us.
    let kind = SourceProblemKind::ClientCertificateRejected;
    until("the server rejects our certificate", || problem(&floor, &id) == Some(kind)).await;
    press.trust_rejected_clients().expect("the server's administrator approves");

    // Then the password is wrong.
    floor.handle.set_trust(&shown[0].thumbprint, TrustState::Trusted).await.expect("tries at once");
    until("the password is refused", || {
        problem(&floor, &id) == Some(SourceProblemKind::CredentialsRejected)
    })
    .await;
    floor.handle.put_source(source(&press, "press")).expect("valid");
    floor.until_connected(&id).await;
    let endpoint = floor.status(&id).endpoint.expect("an endpoint");
    assert_eq!(
        endpoint.security_policy,
        SecurityPolicy::Aes256Sha256RsaPss,
        "the strongest of the two"
    );

    floor.monitor(1, &id, node(&press, "Ram.Strokes"));
    press.set("Ram.Strokes", 99_u64).await.expect("set");
    floor.until_value(1, 99_u64).await;

    // Trust that is taken back ends the session, and so does a certificate that is forgotten.
    let untrusted = || problem(&floor, &id) == Some(SourceProblemKind::ServerCertificateUntrusted);
    floor.handle.set_trust(&shown[0].thumbprint, TrustState::Rejected).await.expect("taken back");
    until("the session ends with the trust", untrusted).await;
    floor.handle.set_trust(&shown[0].thumbprint, TrustState::Trusted).await.expect("approved");
    floor.until_connected(&id).await;
    floor.handle.forget_certificate(&shown[0].thumbprint).await.expect("forgotten");
    until("the session ends with the certificate", untrusted).await;
}

#[tokio::test]
async fn an_unprotected_server_is_used_only_by_explicit_choice() {
    let simulation = Simulation::milling_cell().await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    let mut source = SourceConfig::new(SourceId::new("Cell").expect("valid"), cell.endpoint_url());
    let id = source.source_id.clone();
    floor.handle.put_source(source.clone()).expect("valid");
    until("it is refused", || problem(&floor, &id) == Some(SourceProblemKind::NoSuitableEndpoint))
        .await;
    source.security = SecurityChoice::None;
    floor.handle.put_source(source).expect("valid");
    floor.until_connected(&id).await;
}

#[tokio::test]
async fn a_password_is_sent_unprotected_only_where_that_is_allowed_by_name() {
    let mut machine = protected("Press");
    (machine.security.unprotected, machine.security.protected) = (true, false);
    let simulation = Simulation::of(vec![machine]).await;
    let press = simulation.machine("Press");
    let floor = TestShopFloor::start();
    let mut source = source(&press, "press");
    source.security = SecurityChoice::None;
    let id = source.source_id.clone();
    floor.handle.put_source(source.clone()).expect("valid");
    until("it is refused", || problem(&floor, &id) == Some(SourceProblemKind::Configuration)).await;
    let message = floor.status(&id).problem.expect("a problem").message;
    assert!(message.contains("It was not sent"), "{message}");
    source.sends_password_unprotected = true;
    floor.handle.put_source(source).expect("valid");
    floor.until_connected(&id).await;
}

#[tokio::test]
async fn an_address_without_server_is_unreachable() {
    let floor = TestShopFloor::start();
    let source =
        SourceConfig::new(SourceId::new("nothing").expect("valid"), "opc.tcp://127.0.0.1:1");
    let id = source.source_id.clone();
    floor.handle.put_source(source).expect("valid");
    let kind = SourceProblemKind::NothingListens;
    until("nothing is there", || problem(&floor, &id) == Some(kind)).await;
    let http = SourceConfig::new(SourceId::new("http").expect("valid"), "http://127.0.0.1");
    assert!(floor.handle.put_source(http).is_err());
}
