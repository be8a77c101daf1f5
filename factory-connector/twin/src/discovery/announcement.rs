//! The announcement by multicast DNS (RFC 6762, RFC 6763, OPC 10000-12 Annex C).

use std::{
    net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr},
    time::Duration,
};

use mdns_sd::{DaemonEvent, IfKind, ServiceDaemon, ServiceInfo};
use opcua_stack::opcua::crypto::hostname;
use tokio_util::sync::CancellationToken;

/// The service type of OPC UA over TCP.
const SERVICE: &str = "_opcua-tcp._tcp.local.";
/// The path of the endpoint URL, and the capability of OPC 10000-12 Annex D: provides current data.
const TEXTS: [(&str, &str); 2] = [("path", "/"), ("caps", "DA")];
/// Longest part of a name, in bytes (RFC 1035 §2.3.4), with room left for a number where the name
/// is taken.
const LABEL_BYTES_MAX: usize = 63 - " (100)".len();
/// How long saying goodbye may take.
const GOODBYE_MAX: Duration = Duration::from_secs(2);

/// What is announced.
pub(super) struct Announcement {
    /// The name that people choose from in a list.
    pub name: String,
    /// Where the twin listens.
    pub address: SocketAddr,
}

/// The name of this machine in multicast DNS.
pub(crate) fn local_host_name() -> String {
    let name = hostname()
        .ok()
        .filter(|name| !name.is_empty())
        .unwrap_or_else(|| "verbund-twin".to_owned());
    format!("{}.local", cut(name.split('.').next().unwrap_or_default()))
}

impl Announcement {
    /// Announces and answers until `shutdown`, then says goodbye.
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
        // Ending takes leave of all who listen.
        let ended = daemon.shutdown()?;
        if tokio::time::timeout(GOODBYE_MAX, ended.recv_async()).await.is_err() {
            tracing::warn!(
                "The announcement by multicast DNS could not be taken back in time; it runs out by itself."
            );
        }
        Ok(())
    }

    fn service(&self) -> Result<ServiceInfo, mdns_sd::Error> {
        let (name, host) = (cut(&self.name), format!("{}.", local_host_name()));
        let port = self.address.port();
        let ip = self.address.ip();
        if ip.is_unspecified() {
            // Addresses come and go with the interfaces.
            return Ok(
                ServiceInfo::new(SERVICE, name, &host, (), port, &TEXTS[..])?.enable_addr_auto()
            );
        }
        ServiceInfo::new(SERVICE, name, &host, ip, port, &TEXTS[..])
    }
}

/// On which interfaces nobody could reach what listens on this address, and on which of these
/// somebody could.
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
            "The twin's name was taken in multicast DNS; it has another one now."
        ),
        DaemonEvent::Error(error) => {
            tracing::warn!(%error, "Multicast DNS has a problem on an interface.")
        }
        _ => {}
    }
}

/// As much of a text as fits into a part of a name.
fn cut(text: &str) -> &str {
    &text[..text.floor_char_boundary(LABEL_BYTES_MAX)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_name_is_cut_between_characters() {
        assert_eq!(cut("Verbund"), "Verbund");
        let long = "ä".repeat(40);
        assert_eq!(cut(&long), "ä".repeat(28));
    }
}
