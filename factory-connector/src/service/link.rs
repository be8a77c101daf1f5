//! The link to the platform: opened with the client of its lease, over the route that the enrolment
//! names and the plant may change.

use std::{str::FromStr as _, sync::Arc};

use anyhow::Context as _;
use asi_model::{DateTime, FactoryId};
use daemon::Confidential;
use ledger::LedgerKey;
use messaging::{BrokerUrl, ClientIdentity, Link, LinkConfig, LinkHandle, Login, Roots};
use tokio::sync::watch;

use crate::{
    config::ConnectorConfig,
    coordinator::CoordinatorHandle,
    in_flight::InFlight,
    keep_alive_queue::KeepAliveQueue,
    lease::{self, ConnectorInstance, LeaseClient, LeaseGate, LeaseStatus},
    link_adapter::{ConnectorSpool, PlatformInbox},
    live_events::LiveEvents,
    message_signer::MessageSigner,
    store::{Enrolment, ReaderUse, Readers, StoreIdentity},
};

/// The link with the client of its lease, and the queues that the coordinator fills.
pub(super) struct OpenedLink {
    pub(super) link: Link,
    pub(super) handle: LinkHandle,
    pub(super) lease_client: LeaseClient,
    pub(super) lease_status: watch::Receiver<LeaseStatus>,
    pub(super) keep_alives: Arc<KeepAliveQueue>,
    pub(super) in_flight: Arc<InFlight>,
}

/// Opens the link between spool and broker, whose messages `key` signs.
///
/// # Errors
/// The configuration can never work.
pub(super) fn open(
    mut config: LinkConfig,
    identity: StoreIdentity,
    key: &LedgerKey,
    started_at: DateTime,
    readers: &Readers,
    coordinator: &CoordinatorHandle,
    events: &LiveEvents,
) -> anyhow::Result<OpenedLink> {
    let StoreIdentity { factory_id, instance_id, place, host, was_lease_held, .. } = identity;
    let keep_alives = Arc::new(KeepAliveQueue::default());
    let in_flight = Arc::new(InFlight::default());
    let gate = Arc::new(LeaseGate::default());
    let spool = ConnectorSpool::new(
        factory_id.clone(),
        readers.reserved_for(ReaderUse::Spool),
        coordinator.clone(),
        Arc::clone(&keep_alives),
        Arc::clone(&in_flight),
        Arc::clone(&gate),
        MessageSigner::new(factory_id.clone(), key.clone())?,
    );
    let (lease_answers, answers) = lease::channel(factory_id.clone());
    config.consumed = LeaseClient::received_at_start(&factory_id, was_lease_held);
    let (link, handle) = Link::new(
        config,
        Arc::new(spool),
        Arc::new(PlatformInbox { coordinator: coordinator.clone(), lease: lease_answers }),
    )?;
    let (lease_client, lease_status) = LeaseClient::new(
        ConnectorInstance { factory_id, instance_id, place, host, started_at },
        was_lease_held,
        gate,
        handle.clone(),
        coordinator.clone(),
        answers,
        events.clone(),
    );
    Ok(OpenedLink { link, handle, lease_client, lease_status, keep_alives, in_flight })
}

/// Returns the link's configuration, but for the addresses that it receives, which follow from the
/// lease.
pub(super) fn link_config(
    enrolled: &Enrolment,
    password: &Confidential<String>,
    config: &ConnectorConfig,
    factory_id: &FactoryId,
    now: DateTime,
) -> anyhow::Result<LinkConfig> {
    let section = &config.broker;
    let enrolled_url = BrokerUrl::from_str(&enrolled.broker_url)
        .context("reading the broker's address of the enrolment")?;
    let broker = section.url.clone().unwrap_or_else(|| enrolled_url.clone());
    if broker.is_mqtt() != enrolled_url.is_mqtt() {
        anyhow::bail!(
            "broker.url is {broker}, but the platform's broker is {enrolled_url}: the way may differ, not the \
             protocol; write the same protocol, or remove the key"
        );
    }
    let login = Login::new(&enrolled.user_name, password.expose());
    // Unique per running instance, so that a broker distinguishes two instances.
    let mut link = LinkConfig::new(broker, login, format!("{factory_id}.{}", uuid::Uuid::new_v4()));
    link.profile = serde_json::from_str(&enrolled.profile)
        .context("reading the broker's profile of the enrolment")?;
    link.limits.replay_share = config.spool.replay_share_percent;
    if let Some(path) = &section.root_certificates {
        let pem = std::fs::read(path).with_context(|| {
            format!("reading broker.root_certificates at {}; is the path right?", path.display())
        })?;
        link.tls.roots = Roots::Pem(pem.into());
    } else if let Some(pem) = &enrolled.root_certificate_pem {
        link.tls.roots = Roots::Pem(pem.clone().into_bytes().into());
    }
    if let Some(files) = &section.client_certificate {
        let loaded = files.load().context("reading broker.client_certificate")?;
        if let Some(notice) = loaded.notice(now.into()) {
            tracing::warn!("broker.client_certificate: {notice}.");
        }
        link.tls.identity = Some(ClientIdentity {
            certificates_pem: loaded.certificates_pem.into(),
            key_pem: loaded.key_pem,
        });
    }
    link.proxy = section.proxy.as_ref().map(crate::config::ProxySection::http_proxy).transpose()?;
    Ok(link)
}

#[cfg(test)]
mod tests {
    use daemon::client_certificate::ClientCertificateFiles;

    use super::*;
    use crate::config::{BrokerSection, ProxySection};

    fn enrolled() -> Enrolment {
        Enrolment {
            factory_id: "FOR_MUC".to_owned(),
            broker_url: "amqps://verbund.example:5671".to_owned(),
            profile: "\"embedded\"".to_owned(),
            user_name: "factory.FOR_MUC".to_owned(),
            sealed_password: None,
            root_certificate_pem: Some("enrolled".to_owned()),
        }
    }

    fn configured(section: &BrokerSection) -> anyhow::Result<LinkConfig> {
        let config = ConnectorConfig { broker: section.clone(), ..ConnectorConfig::default() };
        configured_by(&config)
    }

    fn configured_by(config: &ConnectorConfig) -> anyhow::Result<LinkConfig> {
        link_config(
            &enrolled(),
            &"secret".into(),
            config,
            &FactoryId::new("FOR_MUC").expect("an id"),
            DateTime::from_unix_micros(1_767_225_600_000_000),
        )
    }

    #[test]
    fn without_a_section_the_enrolment_is_used() {
        let link = configured(&BrokerSection::default()).expect("a configuration");
        assert_eq!(link.brokers, ["amqps://verbund.example".parse().expect("an address")]);
        assert!(link.proxy.is_none());
        assert!(matches!(link.tls.roots, Roots::Pem(pem) if pem == "enrolled"));
    }

    #[test]
    fn the_section_replaces_address_authorities_and_proxy() {
        let folder = tempfile::tempdir().expect("a folder");
        let pem = folder.path().join("roots.pem");
        std::fs::write(&pem, "own").expect("written");
        let proxy = ProxySection {
            url: "http://proxy.plant:3128".to_owned(),
            user_name: Some("plant".to_owned()),
            password: Some("gate".into()),
            allow_plaintext: true,
        };
        let url = Some("amqp+wss://verbund.example".parse().expect("an address"));
        let section = BrokerSection {
            url,
            root_certificates: Some(pem),
            proxy: Some(proxy),
            ..BrokerSection::default()
        };
        let link = configured(&section).expect("a configuration");
        assert_eq!(link.brokers[0].to_string(), "amqp+wss://verbund.example:443/");
        assert!(matches!(link.tls.roots, Roots::Pem(pem) if pem == "own"));
        let login = link.proxy.and_then(|proxy| proxy.login).expect("a login");
        assert_eq!((login.user_name.as_str(), login.password.as_str()), ("plant", "gate"));
        assert_eq!(link.login.user_name, "factory.FOR_MUC", "who we are to the broker stays");
    }

    #[test]
    fn the_backlog_has_the_share_that_is_configured_and_never_all_or_nothing() {
        let parse = |share: u8| {
            let text = format!("[spool]\nreplay_share_percent = {share}\n");
            daemon::configuration::parse::<ConnectorConfig>(None, &text, "VERBUND", [])
        };
        for share in [1, 70, 99] {
            let link = configured_by(&parse(share).expect("valid")).expect("a configuration");
            assert_eq!(link.limits.replay_share.percent(), share);
        }
        for share in [0, 100] {
            let refused = parse(share).map(drop).expect_err("refused").to_string();
            assert!(refused.contains("between 1 and 99"), "{refused}");
        }
    }

    #[test]
    fn the_broker_is_shown_a_certificate_whose_key_is_ours_alone() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().expect("a folder");
        let made = rcgen::generate_simple_self_signed(["plant".to_owned()]).expect("made");
        let files = ClientCertificateFiles {
            certificate: folder.path().join("client.pem"),
            key: folder.path().join("client.key"),
        };
        std::fs::write(&files.certificate, made.cert.pem()).expect("written");
        std::fs::write(&files.key, made.signing_key.serialize_pem()).expect("written");
        let section =
            BrokerSection { client_certificate: Some(files.clone()), ..BrokerSection::default() };
        let with_mode = |mode| {
            let permissions = std::fs::Permissions::from_mode(mode);
            std::fs::set_permissions(&files.key, permissions).expect("ours");
            configured(&section)
        };
        let refused = format!("{:#}", with_mode(0o644).expect_err("refused"));
        assert!(
            refused.contains("broker.client_certificate") && refused.contains("chmod 600"),
            "{refused}"
        );
        let identity = with_mode(0o600).expect("a configuration").tls.identity;
        let shown = identity.expect("a certificate").certificates_pem;
        assert_eq!(shown, made.cert.pem().into_bytes());
    }

    #[test]
    fn another_protocol_than_that_of_the_enrolment_is_refused() {
        let url = Some("mqtt+wss://verbund.example".parse().expect("an address"));
        let fault = configured(&BrokerSection { url, ..BrokerSection::default() })
            .expect_err("refused")
            .to_string();
        assert!(fault.contains("broker.url") && fault.contains("protocol"), "{fault}");
    }
}
