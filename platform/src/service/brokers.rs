//! The embedded broker with its users and certificates, or the way to one of another make.

use std::{
    net::SocketAddr,
    path::{Path, PathBuf},
};

use asi_model::DateTime;
use broker::{Broker, Carrier, DiskGauge, Listener, TlsIdentity};
use daemon::{
    data_directory,
    lifecycle::{Importance, Lifecycle},
    plaintext,
    web::session::random_token,
};
use messaging::{
    BrokerProfile, BrokerUrl, ClientIdentity, LinkConfig, LinkError, LogicalAddress, Login, Roots,
};
use tokio_util::sync::CancellationToken;
use tracing::warn;

use super::{broker_login, error::StartError};
use crate::{
    application::BrokerEndpoint,
    broker_access::{BrokerAccess, PLATFORM_USER},
    broker_process::{BrokerProcess, EmbeddedBroker, Setup},
    certificates::CertificateAuthority,
    clock::Clock,
    config::{BrokerSettings, ExternalBrokerConfig, PlatformConfig},
    disk,
    store::{Store, StoreReader},
};

/// Runs the embedded broker alone, with the users and queues of the platform's database as they are
/// now.
///
/// # Errors
/// [`StartError`].
pub async fn start_broker_alone(
    config: &PlatformConfig,
    clock: &Clock,
    lifecycle: &Lifecycle,
) -> Result<Vec<SocketAddr>, StartError> {
    data_directory::create(&config.data_directory, config.allow_shared_data_directory)?;
    drop(plaintext::warned(config.plaintext_ways()));
    let store = Store::open(&config.database_path()).await?;
    let broker_access = BrokerAccess::new(config.broker.users.clone());
    let embedded = PlatformConfig {
        broker: BrokerSettings { external: None, in_process: true, ..config.broker.clone() },
        ..config.clone()
    };
    let program = Path::new("");
    let (broker, _, _) =
        open(&embedded, &broker_access, &store.reader(), clock.now(), program).await?;
    if let Some(broker) = broker {
        broker.start(lifecycle, lifecycle.shutdown());
    }
    broker_access.reconcile(&store.reader()).await?;
    Ok(broker_access.broker().map(|broker| broker.addresses().to_vec()).unwrap_or_default())
}

/// The embedded broker, opened to be run.
pub(super) enum OpenedBroker {
    Here(Box<Broker>),
    Process(Box<BrokerProcess>),
}

impl OpenedBroker {
    /// Runs it in the lifecycle until `shutdown`.
    pub(super) fn start(self, lifecycle: &Lifecycle, shutdown: CancellationToken) {
        match self {
            Self::Here(broker) => {
                lifecycle.spawn("broker", Importance::Essential, broker.run(shutdown));
            }
            Self::Process(process) => {
                lifecycle.spawn("broker", Importance::Essential, process.run(shutdown));
            }
        }
    }
}

/// A broker to be used: the embedded one, or none when another one is configured, with its endpoint
/// for others and the configuration of our own link.
type Opened = (Option<OpenedBroker>, BrokerEndpoint, LinkConfig);

/// Opens the embedded broker, in a process of `program` if it has its own, or prepares the link to
/// an external one.
pub(super) async fn open(
    config: &PlatformConfig,
    broker_access: &BrokerAccess,
    store: &StoreReader,
    now: DateTime,
    program: &Path,
) -> Result<Opened, StartError> {
    // Unique per running instance, so that a broker's log distinguishes them.
    let container = format!("platform-{}", &random_token()[..8]);
    match &config.broker.external {
        Some(external) => open_external(config, external, container, now),
        None => open_embedded(config, broker_access, store, now, container, program).await,
    }
}

fn open_external(
    config: &PlatformConfig,
    external: &ExternalBrokerConfig,
    container: String,
    now: DateTime,
) -> Result<Opened, StartError> {
    let read = |path: &PathBuf| {
        std::fs::read_to_string(path)
            .map_err(|source| StartError::RootCertificates { path: path.clone(), source })
    };
    let roots = external.root_certificates.as_ref().map(read).transpose()?;
    let first = external.urls.first().ok_or(LinkError::NoBroker)?;
    let sealer = config.sealer();
    broker_login::seal_at_start(external, &sealer);
    let password = external.password_of(&external.user_name, &sealer)?;
    let login = Login::new(&external.user_name, password.expose());
    let mut link = LinkConfig::new(first.clone(), login, container);
    link.brokers.clone_from(&external.urls);
    link.profile = external.profile.clone();
    // What one factory has waiting leaves the others their room.
    link.has_session_per_address = true;
    // A broker that speaks AMQP collects there what expired or was refused; the platform's own keeps that by itself.
    if !first.is_mqtt() {
        link.consumed = vec![LogicalAddress::DeadLetters];
    }
    if let Some(pem) = &roots {
        link.tls.roots = Roots::Pem(pem.clone().into_bytes().into());
    }
    if let Some(files) = &external.client_certificate {
        let loaded = files.load()?;
        if let Some(notice) = loaded.notice(now.into()) {
            warn!("broker.external.client_certificate: {notice}.");
        }
        link.tls.identity = Some(ClientIdentity {
            certificates_pem: loaded.certificates_pem.into(),
            key_pem: loaded.key_pem,
        });
    }
    let endpoint = BrokerEndpoint {
        url: config.broker.public_url.as_ref().unwrap_or(first).to_string(),
        profile: external.profile.clone(),
        root_certificate_pem: roots,
    };
    Ok((None, endpoint, link))
}

async fn open_embedded(
    config: &PlatformConfig,
    broker_access: &BrokerAccess,
    store: &StoreReader,
    now: DateTime,
    container: String,
    program: &Path,
) -> Result<Opened, StartError> {
    // Before the listeners open: a peer that is refused stays away for minutes, so one that waits
    // for the broker's start must be known from the first connection on.
    broker_access.load_users(store).await?;
    let authority = CertificateAuthority::open(&config.authority_directory(), now.into())?;
    let issued = authority.issue(&host_names(&config.broker), now.into())?;
    let tls = TlsIdentity { certificates_pem: issued.certificates_pem, key_pem: issued.key_pem };
    let mut embedded = broker::BrokerConfig::new(
        tls_listener(&config.broker, &tls),
        config.broker_database_path(),
    );
    if let Some(address) = config.broker.plain_listen {
        embedded.listeners.push(Listener { address, tls: None, carrier: Carrier::Stream });
    }
    if let Some(address) = config.broker.websocket_listen {
        let carrier = Carrier::WebSocket;
        embedded.listeners.push(Listener { address, tls: Some(tls), carrier });
    }
    embedded.disk = DiskGauge::new(disk::space_of);
    let users = broker_access.users();
    let (broker, handle) = if config.broker.in_process {
        let (broker, handle) = Broker::new(embedded, users).await?;
        (OpenedBroker::Here(Box::new(broker)), EmbeddedBroker::Here(handle))
    } else {
        let setup = Setup::new(&embedded, config.log.clone());
        let started = BrokerProcess::start(program.to_owned(), setup, &users.all()).await?;
        (OpenedBroker::Process(Box::new(started.0)), EmbeddedBroker::Process(started.1))
    };
    let address = handle.addresses().first().copied().unwrap_or(config.broker.listen);
    broker_access.set_broker(handle);

    let own_url = own_url(address);
    let login = Login::new(PLATFORM_USER, broker_access.secret());
    let mut link = LinkConfig::new(own_url.clone(), login, container);
    link.tls.roots = Roots::Pem(authority.root_pem().to_owned().into_bytes().into());
    if !address.ip().is_loopback() {
        link.tls.server_name = Some("localhost".to_owned());
    }
    let endpoint = BrokerEndpoint {
        url: config.broker.public_url.as_ref().unwrap_or(&own_url).to_string(),
        profile: BrokerProfile::embedded(),
        root_certificate_pem: Some(authority.root_pem().to_owned()),
    };
    Ok((Some(broker), endpoint, link))
}

/// Returns the names and addresses that the embedded broker's certificate is valid for.
fn host_names(config: &BrokerSettings) -> Vec<String> {
    let mut names = vec!["localhost".to_owned(), "127.0.0.1".to_owned(), "::1".to_owned()];
    names.extend(config.host_names.iter().cloned());
    if let Some(url) = &config.public_url {
        names.push(url.host().to_owned());
    }
    names.dedup();
    names
}

fn tls_listener(config: &BrokerSettings, tls: &TlsIdentity) -> Listener {
    Listener { address: config.listen, tls: Some(tls.clone()), carrier: Carrier::Stream }
}

/// Returns the URL by which the platform itself reaches the embedded broker: on this machine,
/// whatever address it listens on for others.
fn own_url(address: SocketAddr) -> BrokerUrl {
    let host = if address.ip().is_unspecified() { "localhost".to_owned() } else { host(address) };
    format!("amqps://{host}:{}", address.port())
        .parse()
        .expect("a host and a port make a broker address")
}

fn host(address: SocketAddr) -> String {
    match address {
        SocketAddr::V4(address) => address.ip().to_string(),
        SocketAddr::V6(address) => format!("[{}]", address.ip()),
    }
}

#[cfg(test)]
mod tests {
    use broker::CredentialSource;

    use super::*;

    #[tokio::test]
    async fn the_broker_knows_its_users_before_it_accepts_anyone() {
        drop(rustls::crypto::ring::default_provider().install_default());
        let folder = tempfile::tempdir().expect("a folder");
        let text = format!(
            "data_directory = {:?}\n[broker]\nlisten = \"127.0.0.1:0\"\nin_process = true\n[[broker.users]]\nuser_name = \"observer\"\n\
             password = \"of the broker alone\"\nconsume = []\nproduce = []\n",
            folder.path()
        );
        let config: PlatformConfig =
            daemon::configuration::parse(None, &text, "NOTHING", []).expect("valid");
        let store = Store::open(&config.database_path()).await.expect("a database");
        let broker_access = BrokerAccess::new(config.broker.users.clone());
        let (broker, ..) =
            open(&config, &broker_access, &store.reader(), Clock::system().now(), Path::new(""))
                .await
                .expect("it opens");
        assert!(broker.is_some(), "it is embedded, and does not run yet");
        for user in ["observer", PLATFORM_USER] {
            assert!(broker_access.users().user(user).is_some(), "{user}");
        }
    }
}
