//! Announcement by multicast DNS (RFC 6762, RFC 6763, OPC 10000-12 Annex C).

use std::{
    net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr},
    time::Duration,
};

use mdns_sd::{DaemonEvent, IfKind, ServiceDaemon, ServiceInfo};
use tokio_util::sync::CancellationToken;

use crate::host_names::{cut_to_label, local_host_name};

/// The service type of OPC UA over TCP.
const SERVICE: &str = "_opcua-tcp._tcp.local.";
/// The path of the endpoint URL, and the capability of OPC 10000-12 Annex D: provides current data.
const TEXTS: [(&str, &str); 2] = [("path", "/"), ("caps", "DA")];
/// Time limit to withdraw the announcement. The shutdown waits for it; a lost announcement expires
/// by itself.
const WITHDRAWAL_TIMEOUT: Duration = Duration::from_secs(2);

/// The service that is announced.
pub(super) struct Announcement {
    /// The name that people see in a list.
    pub name: String,
    /// The address that the twin listens on.
    pub address: SocketAddr,
}

impl Announcement {
    /// Announces and answers until `shutdown`, then withdraws the announcement.
    pub async fn run(self, shutdown: &CancellationToken) {
        if let Err(error) = self.announce(shutdown).await {
            tracing::warn!(
                %error,
                "The twin cannot announce itself by multicast DNS. Allow UDP port 5353 and multicast, or set \
                 `announce_by_multicast_dns` to false."
            );
        }
    }

    async fn announce(&self, shutdown: &CancellationToken) -> Result<(), mdns_sd::Error> {
        let daemon = ServiceDaemon::new()?;
        let events = daemon.monitor()?;
        let (without, with) = interfaces(self.address.ip());
        daemon.disable_interface(without)?;
        daemon.enable_interface(with)?;
        daemon.register(self.service()?)?;
        loop {
            tokio::select! {
                () = shutdown.cancelled() => break,
                event = events.recv_async() => match event {
                    Ok(event) => report(&event),
                    Err(_) => return Err(mdns_sd::Error::DaemonShutdown),
                },
            }
        }
        // The shutdown withdraws the announcement from all listeners.
        let ended = daemon.shutdown()?;
        if tokio::time::timeout(WITHDRAWAL_TIMEOUT, ended.recv_async()).await.is_err() {
            tracing::warn!(
                "The announcement by multicast DNS could not be withdrawn in time; it expires by itself."
            );
        }
        Ok(())
    }

    fn service(&self) -> Result<ServiceInfo, mdns_sd::Error> {
        let (name, host) = (cut_to_label(&self.name), format!("{}.", local_host_name()));
        let port = self.address.port();
        let ip = self.address.ip();
        if ip.is_unspecified() {
            // Addresses change with the network interfaces.
            return Ok(
                ServiceInfo::new(SERVICE, name, &host, (), port, &TEXTS[..])?.enable_addr_auto()
            );
        }
        ServiceInfo::new(SERVICE, name, &host, ip, port, &TEXTS[..])
    }
}

/// Returns the interfaces to exclude, and those of them to include again, because clients on them
/// can reach the address that the twin listens on.
fn interfaces(listening: IpAddr) -> (Vec<IfKind>, Vec<IfKind>) {
    match listening {
        IpAddr::V4(Ipv4Addr::UNSPECIFIED) => (vec![IfKind::IPv6, IfKind::LoopbackV4], Vec::new()),
        IpAddr::V6(Ipv6Addr::UNSPECIFIED) => {
            (vec![IfKind::LoopbackV4, IfKind::LoopbackV6], Vec::new())
        }
        address => (vec![IfKind::All], vec![IfKind::Addr(address)]),
    }
}

fn report(event: &DaemonEvent) {
    match event {
        DaemonEvent::Announce(name, address) => {
            tracing::info!(mdns.name = name, %address, "The twin announces itself by multicast DNS.");
        }
        DaemonEvent::NameChange(change) => tracing::info!(
            mdns.name = change.new_name,
            "The twin's name was taken in multicast DNS. It has another one now."
        ),
        DaemonEvent::Error(error) => {
            tracing::warn!(%error, "Multicast DNS has a problem on an interface.")
        }
        _ => {}
    }
}
