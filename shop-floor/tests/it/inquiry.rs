//! Servers that are asked and tested before they are sources.

use shop_floor::{
    Identity, MessageSecurity, SecurityChoice, SecurityPolicy, ServerFinding, ServerOffer,
    SourceConfig, SourceId, SourceProblem, SourceProblemKind as Kind, TestedServer, TrustState,
};
use simulator::{MachineConfig, MachineHandle, MachineKind, SecurityConfig, UserConfig};

use crate::support::{Simulation, TestShopFloor, unprotected};

/// A press that wants a user, at two protected endpoints and an unprotected one.
async fn press() -> (Simulation, MachineHandle, TestShopFloor) {
    let mut machine = MachineConfig::new("Press", MachineKind::Press);
    machine.security = SecurityConfig {
        unprotected: true,
        protected: true,
        anonymous: false,
        users: vec![UserConfig { name: "connector".into(), password: "press".into() }],
        trusts_all_clients: false,
    };
    let simulation = Simulation::of(vec![machine]).await;
    let press = simulation.machine("Press");
    (simulation, press, TestShopFloor::start())
}

async fn discover(floor: &TestShopFloor, url: &str) -> Result<ServerOffer, SourceProblem> {
    floor.handle.discover(url).await.expect("an address")
}

async fn test(floor: &TestShopFloor, source: &SourceConfig) -> Result<TestedServer, SourceProblem> {
    floor.handle.test_source(source).await.expect("an address")
}

fn kind<T: std::fmt::Debug>(outcome: Result<T, SourceProblem>) -> Kind {
    outcome.expect_err("a problem").kind
}

#[tokio::test]
async fn a_server_says_what_it_offers_and_nothing_of_it_is_kept() {
    let (_simulation, press, floor) = press().await;
    let offer = discover(&floor, press.endpoint_url()).await.expect("it answers");
    let choices: Vec<_> = offer.endpoints.iter().map(|endpoint| endpoint.choice).collect();
    let encrypted =
        |policy| Some(SecurityChoice::Exactly { policy, mode: MessageSecurity::SignAndEncrypt });
    assert_eq!(
        choices,
        [
            encrypted(SecurityPolicy::Aes256Sha256RsaPss),
            encrypted(SecurityPolicy::Basic256Sha256),
            Some(SecurityChoice::None)
        ],
        "the strongest first"
    );
    assert!(offer.endpoints.iter().all(|one| one.allows_user_name && !one.allows_anonymous));
    let [certificate] = &offer.certificates[..] else { panic!("{:?}", offer.certificates) };
    assert!(!certificate.is_trusted && certificate.key_bits >= Some(2048), "{certificate:?}");
    assert!(offer.endpoints[0].certificate_fingerprint.as_ref() == Some(&certificate.fingerprint));
    assert!(floor.handle.certificates().await.expect("a list").is_empty(), "nothing is kept");
    assert!(floor.handle.states().is_empty());
}

#[tokio::test]
async fn a_test_goes_through_trust_and_sign_in_and_makes_no_source() {
    let (_simulation, press, floor) = press().await;
    let mut source =
        SourceConfig::new(SourceId::new("Press").expect("valid"), press.endpoint_url());
    assert_eq!(kind(test(&floor, &source).await), Kind::NoSuitableEndpoint, "not anonymously");
    let user = |password: &str| Identity::UserName {
        user_name: "connector".into(),
        password: password.into(),
    };
    source.identity = user("wrong");
    assert_eq!(kind(test(&floor, &source).await), Kind::ServerCertificateUntrusted);
    let shown = floor.handle.certificates().await.expect("a list");
    floor.handle.set_trust(&shown[0].thumbprint, TrustState::Trusted).await.expect("approved");
    let offer = discover(&floor, press.endpoint_url()).await.expect("it answers");
    assert!(offer.certificates[0].is_trusted);
    assert_eq!(kind(test(&floor, &source).await), Kind::ClientCertificateRejected);
    press.trust_rejected_clients().expect("the server's administrator approves");
    assert_eq!(kind(test(&floor, &source).await), Kind::CredentialsRejected);
    source.identity = user("press");
    let tested = test(&floor, &source).await.expect("it lets us in");
    assert_eq!(tested.endpoint.security_policy, SecurityPolicy::Aes256Sha256RsaPss);
    assert!(tested.clock_ahead_ms.is_some_and(|ahead| ahead.abs() < 5000), "{tested:?}");
    assert!(tested.findings.is_empty(), "{tested:?}");
    assert!(floor.handle.states().is_empty(), "it is no source");
}

#[tokio::test]
async fn a_server_that_calls_itself_by_another_host_is_reached_at_the_address_that_was_asked() {
    let simulation = Simulation::milling_cell().await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    // The server calls itself 127.0.0.1; asked by another spelling of that it is another host.
    let url = cell.endpoint_url().replace("127.0.0.1", "127.1");
    let offer = discover(&floor, &url).await.expect("it answers");
    let used_url = offer.endpoints[0].used_url.clone();
    assert!(used_url.starts_with("opc.tcp://127.1:"), "{used_url}");
    let differs = ServerFinding::HostNameDiffers { host: "127.0.0.1".into(), used_url };
    assert!(offer.findings.contains(&differs), "{:?}", offer.findings);
    let nothing =
        |finding: &ServerFinding| matches!(finding, ServerFinding::NothingEncrypted { .. });
    assert!(offer.findings.iter().any(nothing), "{:?}", offer.findings);
    let mut source = unprotected(&cell);
    source.endpoint_url = url;
    test(&floor, &source).await.expect("the address that was asked is used");
}

#[tokio::test]
async fn an_address_that_is_wrong_is_said_as_such() {
    let floor = TestShopFloor::start();
    assert_eq!(kind(discover(&floor, "opc.tcp://127.0.0.1:1").await), Kind::NothingListens);
    // Longer than a label may be, so that no name service is asked.
    let unknown = discover(&floor, &format!("opc.tcp://{}:4840", "plc".repeat(30))).await;
    let problem = unknown.expect_err("no such host");
    assert_eq!(problem.kind, Kind::HostNameUnknown, "{problem:?}");
    assert!(!problem.message.contains("kind:"), "words for people: {problem:?}");
    assert!(floor.handle.discover("http://127.0.0.1").await.is_err());
}

#[tokio::test]
async fn a_test_gives_its_place_back() {
    let mut config = MachineConfig::new("Cell", MachineKind::MillingCell);
    config.sessions_max = 3;
    let simulation = Simulation::of(vec![config]).await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    for _ in 0..10 {
        test(&floor, &unprotected(&cell)).await.expect("there is room again");
    }
}
