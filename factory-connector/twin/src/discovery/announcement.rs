//! The announcement by multicast DNS (RFC 6762, OPC 10000-12 Annex C), over IPv4.
//!
//! The twin only answers for its own few records, so it needs no resolver: it makes sure that nobody else has its name,
//! announces itself, answers questions, follows interfaces that come and go, and says goodbye.

use std::{
    collections::BTreeSet,
    io,
    net::{IpAddr, Ipv4Addr, SocketAddr, SocketAddrV4},
    time::Duration,
};

use futures::future::{join_all, select_all};
use opcua_stack::opcua::crypto::hostname;
use rand::Rng;
use socket2::{Domain, Protocol, Socket, Type};
use tokio::{net::UdpSocket, time::Instant};
use tokio_util::sync::CancellationToken;

use super::{
    dns::{self, Message},
    zone::{PORT, Zone},
};

/// Where multicast DNS is spoken.
const GROUP: SocketAddrV4 = SocketAddrV4::new(Ipv4Addr::new(224, 0, 0, 251), PORT);
/// Longest message, as RFC 6762 §17 has it.
const MESSAGE_BYTES_MAX: usize = 9000;
/// Most interfaces served.
const INTERFACES_MAX: usize = 32;
/// Probes of a name, and the pause after each (RFC 6762 §8.1).
const PROBES: u32 = 3;
const PROBE_PAUSE: Duration = Duration::from_millis(250);
/// Most names tried.
const CHOICES_MAX: u32 = 100;
/// How often interfaces are looked for.
const INTERFACES_PERIOD: Duration = Duration::from_secs(30);
/// The same is said to all at most this often on one interface.
const REPEAT_PAUSE: Duration = Duration::from_secs(1);

/// What is announced.
pub(super) struct Announcement {
    /// The name that people choose from in a list.
    pub name: String,
    /// Where the twin listens.
    pub address: SocketAddr,
}

/// The name of this machine in multicast DNS.
pub(crate) fn local_host_name() -> String {
    let name = hostname().ok().filter(|name| !name.is_empty()).unwrap_or_else(|| "verbund-twin".to_owned());
    format!("{}.local", dns::cut(name.split('.').next().unwrap_or_default(), dns::LABEL_BYTES_MAX))
}

impl Announcement {
    /// Announces and answers until `shutdown`, then says goodbye.
    pub async fn run(self, shutdown: &CancellationToken) {
        let mut interfaces = Interfaces::default();
        let announced = tokio::select! {
            zone = self.settle(&mut interfaces) => zone,
            () = shutdown.cancelled() => return,
        };
        let Some(zone) = announced else {
            tracing::warn!("Every name for the twin is taken in multicast DNS; it is not announced.");
            return;
        };
        tracing::info!(mdns.name = zone.instance.0[0], "The twin announces itself by multicast DNS.");
        tokio::select! {
            () = self.serve(&mut interfaces, &zone) => {}
            () = shutdown.cancelled() => {}
        }
        interfaces.send_to_all(|_| zone.goodbye()).await;
    }

    /// Finds a name that nobody has.
    async fn settle(&self, interfaces: &mut Interfaces) -> Option<Zone> {
        let host = local_host_name();
        let mut choices = (1..=CHOICES_MAX).map(|choice| Zone::new(&self.name, &host, self.address.port(), choice));
        let mut zone = choices.next()?;
        loop {
            interfaces.follow(self.address.ip()).await;
            if !interfaces.is_claimed(&zone).await {
                return Some(zone);
            }
            zone = choices.next()?;
        }
    }

    async fn serve(&self, interfaces: &mut Interfaces, zone: &Zone) {
        interfaces.send_to_all(|address| zone.announcement(address)).await;
        // Once more, as the first may be lost (RFC 6762 §8.3); then whenever interfaces have changed.
        let mut announce_again = Some(Instant::now() + REPEAT_PAUSE);
        let mut look = tokio::time::interval(INTERFACES_PERIOD);
        let mut buffer = vec![0; MESSAGE_BYTES_MAX];
        loop {
            let again = async {
                match announce_again {
                    Some(at) => tokio::time::sleep_until(at).await,
                    None => std::future::pending().await,
                }
            };
            tokio::select! {
                (interface, length, from) = interfaces.receive(&mut buffer) => {
                    if let Some(Message::Query(query)) = dns::read(&buffer[..length]) {
                        interfaces.answer(zone, interface, &query, from).await;
                    }
                }
                () = again => {
                    interfaces.send_to_all(|address| zone.announcement(address)).await;
                    announce_again = None;
                }
                _ = look.tick() => {
                    if interfaces.follow(self.address.ip()).await {
                        announce_again = Some(Instant::now());
                    }
                }
            }
        }
    }
}

/// One socket for each interface that the twin listens on.
#[derive(Default)]
struct Interfaces {
    open: Vec<Interface>,
    /// Those that could not be used, so that this is said once.
    useless: BTreeSet<Ipv4Addr>,
}

struct Interface {
    address: Ipv4Addr,
    socket: UdpSocket,
    told_all: Option<Instant>,
}

impl Interfaces {
    /// Opens sockets on interfaces that came and closes those of interfaces that went. True where any came.
    async fn follow(&mut self, listening: IpAddr) -> bool {
        let found = tokio::task::spawn_blocking(move || addresses(listening)).await.unwrap_or_default();
        self.open.retain(|interface| found.contains(&interface.address));
        let mut is_changed = false;
        for address in found {
            if self.open.len() >= INTERFACES_MAX || self.open.iter().any(|interface| interface.address == address) {
                continue;
            }
            match open(address) {
                Ok(socket) => {
                    self.useless.remove(&address);
                    self.open.push(Interface { address, socket, told_all: None });
                    is_changed = true;
                }
                Err(error) if self.useless.insert(address) => tracing::warn!(
                    %error,
                    interface.address = %address,
                    "The twin cannot announce itself by multicast DNS on an interface. Allow UDP port 5353 and \
                     multicast there, or set `announce_by_multicast_dns` to false."
                ),
                Err(_) => {}
            }
        }
        is_changed
    }

    /// The next message on any of them: from which interface, how long, from whom. Never ends where there is none.
    async fn receive(&self, buffer: &mut [u8]) -> (usize, usize, SocketAddr) {
        loop {
            if self.open.is_empty() {
                return std::future::pending().await;
            }
            let ready = self.open.iter().map(|interface| Box::pin(interface.socket.readable()));
            let (_, interface, _) = select_all(ready).await;
            // A failed reception (an interface went down) and a readiness for nothing are no messages.
            if let Ok((length, from)) = self.open[interface].socket.try_recv_from(buffer) {
                return (interface, length, from);
            }
            tokio::task::yield_now().await;
        }
    }

    async fn send_to_all(&mut self, message: impl Fn(Ipv4Addr) -> Vec<u8>) {
        let sent = self.open.iter_mut().map(|interface| {
            let bytes = message(interface.address);
            interface.told_all = Some(Instant::now());
            async move { interface.send(&bytes, GROUP.into()).await }
        });
        join_all(sent).await;
    }

    /// Asks three times whether somebody has the name.
    async fn is_claimed(&mut self, zone: &Zone) -> bool {
        let mut buffer = vec![0; MESSAGE_BYTES_MAX];
        for _ in 0..PROBES {
            self.send_to_all(|_| dns::probe(&zone.instance)).await;
            let until = Instant::now() + PROBE_PAUSE;
            while let Ok((_, length, _)) = tokio::time::timeout_at(until, self.receive(&mut buffer)).await {
                if let Some(Message::Answer(claims)) = dns::read(&buffer[..length])
                    && claims.0.iter().any(|(name, _)| name.is(&zone.instance))
                {
                    return true;
                }
            }
        }
        false
    }

    async fn answer(&mut self, zone: &Zone, interface: usize, query: &dns::Query, from: SocketAddr) {
        let interface = &mut self.open[interface];
        let Some(reply) = zone.reply(query, interface.address, from.port()) else { return };
        if !reply.is_for_all {
            return interface.send(&reply.bytes, from).await;
        }
        if !reply.is_defence {
            if interface.told_all.is_some_and(|told| told.elapsed() < REPEAT_PAUSE) {
                return;
            }
            // Others may answer too, and not all at the same moment (RFC 6762 §6).
            let pause = rand::rng().random_range(20..=120);
            tokio::time::sleep(Duration::from_millis(pause)).await;
        }
        interface.told_all = Some(Instant::now());
        interface.send(&reply.bytes, GROUP.into()).await;
    }
}

impl Interface {
    async fn send(&self, bytes: &[u8], to: SocketAddr) {
        if let Err(error) = self.socket.send_to(bytes, to).await {
            tracing::debug!(%error, interface.address = %self.address, "A message of multicast DNS was not sent.");
        }
    }
}

/// The addresses of the interfaces that the twin listens on; those of the loopback only where it listens nowhere else.
fn addresses(listening: IpAddr) -> Vec<Ipv4Addr> {
    match listening {
        IpAddr::V4(address) if !address.is_unspecified() => vec![address],
        IpAddr::V6(address) if !address.is_unspecified() => Vec::new(),
        _ => {
            let interfaces = if_addrs::get_if_addrs().unwrap_or_default().into_iter();
            interfaces
                .filter_map(|interface| match interface.ip() {
                    IpAddr::V4(address) if !address.is_loopback() => Some(address),
                    _ => None,
                })
                .collect()
        }
    }
}

fn open(address: Ipv4Addr) -> io::Result<UdpSocket> {
    let socket = Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::UDP))?;
    // Other programs on this machine speak multicast DNS too.
    socket.set_reuse_address(true)?;
    #[cfg(all(unix, not(any(target_os = "solaris", target_os = "illumos"))))]
    socket.set_reuse_port(true)?;
    socket.set_nonblocking(true)?;
    socket.bind(&SocketAddr::from((Ipv4Addr::UNSPECIFIED, PORT)).into())?;
    // Only what came in on this interface: every interface has its own socket.
    #[cfg(target_os = "linux")]
    socket.set_multicast_all_v4(false)?;
    socket.join_multicast_v4(GROUP.ip(), &address)?;
    socket.set_multicast_if_v4(&address)?;
    socket.set_multicast_ttl_v4(255)?;
    socket.set_multicast_loop_v4(true)?;
    UdpSocket::from_std(socket.into())
}
