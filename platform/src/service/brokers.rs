//! The embedded broker with its users and certificates, or the way to one of another make.

use std::net::SocketAddr;

use asi_model::DateTime;
use broker::{Broker, BrokerConfig, Carrier, Listener, TlsIdentity};
use daemon::{
    lifecycle::{Importance, Lifecycle},
    web::session::random_token,
};
use messaging::{BrokerProfile, BrokerUrl, LinkConfig, LinkError, Login, Roots};

use super::{StartError, make_data_directory};
use crate::{
    application::BrokerAccess,
    certificates::CertificateAuthority,
    clock::Clock,
    config::PlatformConfig,
    reach::{PLATFORM_USER, Reach},
    store::Store,
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
    make_data_directory(config)?;
    let store = Store::open(&config.database_path()).await?;
    let reach = Reach::new(config.broker.users.clone());
    let embedded = PlatformConfig {
        broker: crate::config::BrokerConfig { external: None, ..config.broker.clone() },
        ..config.clone()
    };
    let (broker, _, _) = open(&embedded, &reach, &store, clock.now()).await?;
    if let Some(broker) = broker {
        lifecycle.spawn("broker", Importance::Essential, broker.run(lifecycle.shutdown()));
    }
    reach.reconcile(&store).await?;
    Ok(reach.broker().map(|broker| broker.local_addresses().to_vec()).unwrap_or_default())
}

/// Opens the embedded broker, or prepares to use another one. The embedded one knows its users from
/// then on: whoever waits at the door of a broker that starts again must not be refused, since a
/// refused peer stays away for minutes.
pub(super) async fn open(
    config: &PlatformConfig,
    reach: &Reach,
    store: &Store,
    now: DateTime,
) -> Result<(Option<Broker>, BrokerAccess, LinkConfig), StartError> {
    // Unique per running instance, so that a broker's log tells them apart.
    let container = format!("platform-{}", &random_token()[..8]);
    if let Some(external) = &config.broker.external {
        let pem =
            match &external.root_certificates {
                None => None,
                Some(path) => Some(std::fs::read_to_string(path).map_err(|source| {
                    StartError::RootCertificates { path: path.clone(), source }
                })?),
            };
        let first = external.urls.first().ok_or(LinkError::NoBroker)?;
        let login = Login::new(&external.user_name, external.password.expose());
        let mut link = LinkConfig::new(first.clone(), login, container);
        link.brokers.clone_from(&external.urls);
        link.profile = external.profile.clone();
        if let Some(pem) = &pem {
            link.tls.roots = Roots::Pem(pem.clone().into_bytes().into());
        }
        let url = config.broker.public_url.as_ref().unwrap_or(first).to_string();
        let access =
            BrokerAccess { url, profile: external.profile.clone(), root_certificate_pem: pem };
        return Ok((None, access, link));
    }

    reach.load_users(store).await?;
    let authority = CertificateAuthority::open(&config.authority_directory(), now.into())?;
    let mut names = vec!["localhost".to_owned(), "127.0.0.1".to_owned(), "::1".to_owned()];
    names.extend(config.broker.host_names.iter().cloned());
    if let Some(url) = &config.broker.public_url {
        names.push(url.host().to_owned());
    }
    names.dedup();
    let issued = authority.issue(&names, now.into())?;
    let tls = TlsIdentity { certificates_pem: issued.certificates_pem, key_pem: issued.key_pem };
    let listener = Listener {
        address: config.broker.listen,
        tls: Some(tls.clone()),
        carrier: Carrier::Stream,
    };
    let mut broker_config = BrokerConfig::new(listener, config.broker_database_path());
    if let Some(address) = config.broker.plain_listen {
        broker_config.listeners.push(Listener { address, tls: None, carrier: Carrier::Stream });
    }
    if let Some(address) = config.broker.websocket_listen {
        broker_config.listeners.push(Listener {
            address,
            tls: Some(tls),
            carrier: Carrier::WebSocket,
        });
    }
    let (broker, handle) = Broker::new(broker_config, reach.users()).await?;
    let address = handle.local_addresses().first().copied().unwrap_or(config.broker.listen);
    reach.set_broker(handle);

    // We reach our own broker on this machine, whatever address it listens on for others.
    let own_host =
        if address.ip().is_unspecified() { "localhost".to_owned() } else { host(address) };
    let own_url: BrokerUrl = format!("amqps://{own_host}:{}", address.port())
        .parse()
        .expect("a host and a port make a broker address");
    let mut link =
        LinkConfig::new(own_url.clone(), Login::new(PLATFORM_USER, reach.secret()), container);
    link.tls.roots = Roots::Pem(authority.root_pem().to_owned().into_bytes().into());
    if !address.ip().is_loopback() {
        link.tls.server_name = Some("localhost".to_owned());
    }
    let access = BrokerAccess {
        url: config.broker.public_url.as_ref().unwrap_or(&own_url).to_string(),
        profile: BrokerProfile::embedded(),
        root_certificate_pem: Some(authority.root_pem().to_owned()),
    };
    Ok((Some(broker), access, link))
}

fn host(address: SocketAddr) -> String {
    match address {
        SocketAddr::V4(address) => address.ip().to_string(),
        SocketAddr::V6(address) => format!("[{}]", address.ip()),
    }
}

#[cfg(test)]
mod tests {
    use broker::Credentials;

    use super::*;

    #[tokio::test]
    async fn the_broker_knows_its_users_before_it_accepts_anyone() {
        drop(rustls::crypto::ring::default_provider().install_default());
        let folder = tempfile::tempdir().expect("a folder");
        let text = format!(
            "data_directory = {:?}\n[broker]\nlisten = \"127.0.0.1:0\"\n[[broker.users]]\nuser_name = \"observer\"\n\
             password = \"of the broker alone\"\nconsume = []\nproduce = []\n",
            folder.path()
        );
        let config: PlatformConfig =
            daemon::configuration::parse(None, &text, "NOTHING", []).expect("valid");
        let store = Store::open(&config.database_path()).await.expect("a database");
        let reach = Reach::new(config.broker.users.clone());
        let (broker, ..) =
            open(&config, &reach, &store, Clock::system().now()).await.expect("it opens");
        assert!(broker.is_some(), "it is embedded, and does not run yet");
        for user in ["observer", PLATFORM_USER] {
            assert!(reach.users().user(user).is_some(), "{user}");
        }
    }
}
