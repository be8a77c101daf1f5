//! Discovery of the twin by clients: at a local discovery server, and by multicast DNS.

mod announcement;
mod registration;

use std::{net::SocketAddr, sync::Arc};

use opcua_stack::opcua::{server::ServerHandle, types::RegisteredServer};
use tokio_util::sync::CancellationToken;

use self::{announcement::Announcement, registration::Registration};
use crate::{config::TwinConfig, security::validation::Validator};

/// Both kinds of discovery, each if it is configured.
pub(crate) struct Discovery {
    registration: Option<Registration>,
    announcement: Option<Announcement>,
}

impl Discovery {
    /// Prepares what is configured; `address` is the one that the twin listens on.
    pub fn new(
        config: &TwinConfig,
        address: SocketAddr,
        handle: &ServerHandle,
        validator: Arc<Validator>,
    ) -> Self {
        // The server does not run yet, but it will when this is sent.
        let server = RegisteredServer { is_online: true, ..handle.info().registered_server() };
        let name = server
            .server_names
            .iter()
            .flatten()
            .next()
            .map(|name| name.text.to_string())
            .unwrap_or_default();
        let announcement =
            config.discovery.announce_by_multicast_dns.then_some(Announcement { name, address });
        let registration =
            config.discovery.local_discovery_server_url.clone().map(|url| Registration {
                url,
                interval: config.discovery.registration_interval(),
                pki_directory: config.pki_directory.clone(),
                validator,
                server,
            });
        Self { registration, announcement }
    }

    /// Runs until `shutdown`, then withdraws registration and announcement within a few seconds.
    pub async fn run(self, shutdown: &CancellationToken) {
        let registration = async {
            if let Some(registration) = self.registration {
                registration.run(shutdown).await;
            }
        };
        let announcement = async {
            if let Some(announcement) = self.announcement {
                announcement.run(shutdown).await;
            }
        };
        tokio::join!(registration, announcement);
    }
}
