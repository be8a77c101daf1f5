//! Servers that are asked and tested before they are sources.

use shop_floor::{
    Identity, MessageSecurity, SecurityChoice, SecurityPolicy, ServerFinding, ServerOffer,
    SourceConfig, SourceId, SourceProblem, SourceProblemKind as Kind, TestedServer, TrustState,
};
use simulator::{MachineConfig, MachineHandle, MachineKind, SecurityConfig, UserConfig};
use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    net::{TcpListener, TcpStream},
};

use crate::{
    hostile::{acknowledgement, header},
    support::{Simulation, TestShopFloor, unprotected},
};

/// Status with which a server refuses a channel of this security (OPC 10000-4 §7.39.2).
const BAD_SECURITY_POLICY_REJECTED: u32 = 0x8055_0000;

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
    (config.sessions_max, config.publishing_interval_ms_min) = (3, 500);
    let simulation = Simulation::of(vec![config]).await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    for _ in 0..10 {
        let tested = test(&floor, &unprotected(&cell)).await.expect("there is room again");
        assert_eq!(tested.publishing_interval_ms, Some(500), "what it grants, not what is asked");
    }
}

/// An address at which a machine shows its endpoints without protection at the path `/discovery` alone.
async fn hidden(machine: &MachineHandle) -> String {
    let target = machine.endpoint_url().trim_start_matches("opc.tcp://").to_owned();
    let target = target.split('/').next().unwrap_or_default().to_owned();
    let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
    let address = listener.local_addr().expect("bound");
    tokio::spawn(async move {
        while let Ok((mut client, _)) = listener.accept().await {
            let mut greeting = [0; 4096];
            let length = client.read(&mut greeting).await.expect("a greeting");
            if let Some(plain) = greeting[..length].strip_suffix(b"/discovery") {
                let mut plain = plain.to_vec();
                let size = u32::try_from(plain.len()).expect("short");
                // The sizes of the message and of the address, its last member (OPC 10000-6 §7.1.2.3).
                plain[4..8].copy_from_slice(&size.to_le_bytes());
                plain[28..32].copy_from_slice(&(size - 32).to_le_bytes());
                let mut server = TcpStream::connect(&target).await.expect("the machine listens");
                server.write_all(&plain).await.expect("the machine reads");
                tokio::io::copy_bidirectional(&mut client, &mut server).await.ok();
                continue;
            }
            client.write_all(&acknowledgement()).await.expect("the client listens");
            let mut request = [0; 4096];
            let _ = client.read(&mut request).await.expect("a channel is asked for");
            let mut refusal = header(b"ERRF", 16);
            refusal.extend(BAD_SECURITY_POLICY_REJECTED.to_le_bytes());
            refusal.extend((-1_i32).to_le_bytes());
            client.write_all(&refusal).await.expect("the client listens");
        }
    });
    format!("opc.tcp://{address}")
}

#[tokio::test]
async fn endpoints_that_are_shown_at_the_path_of_discovery_alone_are_found() {
    let simulation = Simulation::milling_cell().await;
    let floor = TestShopFloor::start();
    let url = hidden(&simulation.machine("Cell")).await;
    let offer = discover(&floor, &url).await.expect("it is asked there, too");
    assert_eq!(offer.endpoints[0].choice, Some(SecurityChoice::None));
    assert!(offer.endpoints[0].used_url.starts_with(&url), "{:?}", offer.endpoints[0].used_url);
}
