//! Access to the broker: users, queues and consumed addresses, derived from the store.
//!
//! [`BrokerAccess::reconcile`] compares what the store says with what is in force and may run any number
//! of times: at the start, after every change, after a revocation. Queues of factories and tools that have
//! left are deleted with what waits in them.

use std::{collections::HashMap, sync::Arc, time::Duration};

use asi_model::{FactoryId, OrganisationId, ToolId};
use broker::{AddressPattern, BrokerUser, CredentialTable, QueueName, QueueOptions, SecretHash};
use daemon::web::session::random_token;
use messaging::{LinkHandle, LogicalAddress};
use parking_lot::Mutex;
use tokio_util::sync::CancellationToken;

use crate::{
    broker_process::{EmbeddedBroker, EmbeddedBrokerError},
    config::BrokerUserConfig,
    store::{BrokerCredential, Holder, Scope, StoreError, StoreReader},
};

/// Time between two attempts at the start.
const RETRY_INTERVAL: Duration = Duration::from_secs(1);

/// The platform's own user on the embedded broker.
pub const PLATFORM_USER: &str = "platform";

/// Users, queues and addresses. Clones share them.
#[derive(Clone)]
pub struct BrokerAccess(Arc<Inner>);

struct Inner {
    users: Arc<CredentialTable>,
    /// Serialises reading the users from the store and saying them to the broker.
    loading: tokio::sync::Mutex<()>,
    configured: Vec<BrokerUserConfig>,
    /// The platform's own secret on the embedded broker: new at every start, never stored.
    secret: String,
    parts: Mutex<BrokerParts>,
}

#[derive(Default)]
struct BrokerParts {
    broker: Option<EmbeddedBroker>,
    link: Option<LinkHandle>,
    /// Addresses to read beside those of the store.
    always_read: Vec<LogicalAddress>,
}

/// Users or queues could not be brought in line with the store.
#[derive(Debug, thiserror::Error)]
pub enum BrokerAccessError {
    #[error("the store failed")]
    Store(#[from] StoreError),
    /// The embedded broker failed.
    #[error("the embedded broker failed")]
    Broker(#[from] EmbeddedBrokerError),
}

impl std::fmt::Debug for BrokerAccess {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("BrokerAccess")
    }
}

impl BrokerAccess {
    /// Makes the access with these configured users, before broker and link run.
    #[must_use]
    pub fn new(configured: Vec<BrokerUserConfig>) -> Self {
        Self(Arc::new(Inner {
            users: Arc::new(CredentialTable::new()),
            loading: tokio::sync::Mutex::default(),
            configured,
            secret: random_token(),
            parts: Mutex::default(),
        }))
    }

    /// Returns the table of users for the embedded broker.
    #[must_use]
    pub fn users(&self) -> Arc<CredentialTable> {
        Arc::clone(&self.0.users)
    }

    /// Returns the platform's own password at the embedded broker.
    #[must_use]
    pub fn secret(&self) -> &str {
        &self.0.secret
    }

    /// Sets the handle of the embedded broker, once it runs.
    pub fn set_broker(&self, broker: EmbeddedBroker) {
        self.0.parts.lock().broker = Some(broker);
    }

    /// Sets the handle of the link, once it runs, with the addresses that it reads whatever the store says.
    pub fn set_link(&self, link: LinkHandle, always_read: Vec<LogicalAddress>) {
        let mut parts = self.0.parts.lock();
        parts.link = Some(link);
        parts.always_read = always_read;
    }

    /// Returns the embedded broker, if there is one.
    #[must_use]
    pub fn broker(&self) -> Option<EmbeddedBroker> {
        self.0.parts.lock().broker.clone()
    }

    /// Returns the link, once it runs.
    #[must_use]
    pub fn link(&self) -> Option<LinkHandle> {
        self.0.parts.lock().link.clone()
    }

    /// New messages wait to be sent.
    pub fn wake_link(&self) {
        if let Some(link) = self.link() {
            link.wake();
        }
    }

    /// Brings the users in line with the store; before the broker runs, so that nobody is refused
    /// by mistake.
    ///
    /// # Errors
    /// [`BrokerAccessError::Store`].
    pub async fn load_users(&self, store: &StoreReader) -> Result<(), BrokerAccessError> {
        // What was read later is sent later.
        let _turn = self.0.loading.lock().await;
        let credentials = store.read().await?.credentials().list().await?;
        let users = self.users_of(&credentials);
        self.0.users.replace(users.clone());
        if let Some(broker) = self.broker() {
            broker.set_users(&users).await;
        }
        Ok(())
    }

    /// Brings users, queues and the addresses that are read in line with the store.
    ///
    /// # Errors
    /// [`BrokerAccessError`]; what was done by then stays and the next run goes on.
    pub async fn reconcile(&self, store: &StoreReader) -> Result<(), BrokerAccessError> {
        let mut work = store.read().await?;
        let factories: Vec<FactoryId> = work
            .factories()
            .list(&Scope::Platform)
            .await?
            .into_iter()
            .map(|factory| factory.factory_id)
            .collect();
        let tools: Vec<ToolId> = work
            .tools()
            .list(&Scope::Platform)
            .await?
            .into_iter()
            .map(|tool| tool.tool_id)
            .collect();
        let left = addresses(&work.factories().removed().await?, &work.tools().removed().await?);
        drop(work);
        self.load_users(store).await?;
        if let Some(broker) = self.broker() {
            for address in addresses(&factories, &tools) {
                let is_single_active_consumer = address.has_single_active_consumer();
                let options = QueueOptions { is_single_active_consumer, ..QueueOptions::default() };
                broker.declare_queue(&queue(&address), options).await?;
            }
            for queue in left.iter().map(queue).filter(|queue| !self.is_configured(queue)) {
                let messages = broker.delete_queue(&queue).await?;
                if messages > 0 {
                    tracing::info!(%queue, messages, "The queue of a factory or tool that has left was deleted.");
                }
            }
        }
        // After the queues: an address without one would be refused and pause.
        if let Some(link) = self.link() {
            let read = factories
                .iter()
                .cloned()
                .map(LogicalAddress::FactoryIngress)
                .chain(tools.iter().cloned().map(LogicalAddress::ToolRequests))
                .chain(self.0.parts.lock().always_read.clone())
                .collect();
            link.set_consumed(read);
        }
        Ok(())
    }

    /// Reconciles at the start of the daemon, again and again until it has succeeded once; from
    /// then on every change does it.
    pub async fn reconcile_at_start(self, store: StoreReader, shutdown: CancellationToken) {
        let reconciling = async {
            while let Err(error) = self.reconcile(&store).await {
                tracing::warn!(%error, "Users and queues are not yet in line with the store; trying again.");
                tokio::time::sleep(RETRY_INTERVAL).await;
            }
        };
        shutdown.run_until_cancelled(reconciling).await;
    }

    /// After a revocation: the holder is unknown from now on and its connections are cut.
    ///
    /// # Errors
    /// [`BrokerAccessError`].
    pub async fn revoked(
        &self,
        store: &StoreReader,
        holder: &Holder,
    ) -> Result<usize, BrokerAccessError> {
        self.reconcile(store).await?;
        match self.broker() {
            Some(broker) => Ok(broker.disconnect_user(&holder.user_name()).await),
            None => Ok(0),
        }
    }

    /// Returns whether a configured user may use the queue: then it is not only of the one that has left.
    fn is_configured(&self, queue: &QueueName) -> bool {
        self.0.configured.iter().any(|user| {
            user.consume.iter().chain(&user.produce).any(|pattern| pattern.matches(queue))
        })
    }

    fn users_of(
        &self,
        credentials: &[(BrokerCredential, Option<OrganisationId>)],
    ) -> HashMap<String, BrokerUser> {
        let mut users = HashMap::new();
        for (credential, organisation) in credentials {
            let user = users
                .entry(credential.holder.user_name())
                .or_insert_with(|| permitted(&credential.holder, organisation.as_ref()));
            user.secrets.push(SecretHash::from_bytes(credential.secret_hash));
        }
        for configured in &self.0.configured {
            let mut user = BrokerUser::with_secret(configured.password.expose().as_bytes());
            user.permissions.consume.clone_from(&configured.consume);
            user.permissions.produce.clone_from(&configured.produce);
            users.insert(configured.user_name.clone(), user);
        }
        let platform = BrokerUser::with_secret(self.0.secret.as_bytes())
            .may_consume(AddressPattern::any())
            .may_produce(AddressPattern::any())
            .as_owner();
        users.insert(PLATFORM_USER.to_owned(), platform);
        users
    }
}

/// A connector reads its own requests and leases and writes its own ingress, a tool likewise, and
/// nothing else.
fn permitted(holder: &Holder, organisation: Option<&OrganisationId>) -> BrokerUser {
    let writes = match holder {
        Holder::Factory(id) => LogicalAddress::FactoryIngress(id.clone()),
        Holder::Tool(id) => LogicalAddress::ToolRequests(id.clone()),
    };
    let mut user = BrokerUser::default().may_produce(AddressPattern::exact(&queue(&writes)));
    user.organisation = organisation.map(ToString::to_string);
    holder
        .reads()
        .iter()
        .fold(user, |user, address| user.may_consume(AddressPattern::exact(&queue(address))))
}

fn addresses(factories: &[FactoryId], tools: &[ToolId]) -> Vec<LogicalAddress> {
    let of_factories = factories.iter().flat_map(|id| {
        [
            LogicalAddress::FactoryRequests(id.clone()),
            LogicalAddress::FactoryLeases(id.clone()),
            LogicalAddress::FactoryIngress(id.clone()),
        ]
    });
    let of_tools = tools.iter().flat_map(|id| {
        [LogicalAddress::ToolRequests(id.clone()), LogicalAddress::ToolReports(id.clone())]
    });
    of_factories.chain(of_tools).collect()
}

fn queue(address: &LogicalAddress) -> QueueName {
    address
        .to_string()
        .parse()
        .expect("logical addresses are words of letters, digits, _ and - with dots between")
}

#[cfg(test)]
mod tests {
    use broker::CredentialSource;

    use super::*;

    #[test]
    fn a_connector_may_use_its_own_addresses_only() {
        let broker_access = BrokerAccess::new(Vec::new());
        let holder = Holder::Factory("A".parse().expect("valid"));
        let organisation: OrganisationId = "a".parse().expect("valid");
        let credentials = [[1; 32], [2; 32]].map(|secret_hash| {
            (BrokerCredential { holder: holder.clone(), secret_hash }, Some(organisation.clone()))
        });
        broker_access.users().replace(broker_access.users_of(&credentials));
        let user = broker_access.users().user("factory.A").expect("known");
        assert_eq!(user.secrets.len(), 2, "one in use, one being rotated in");
        let may = |name: &str| {
            let queue = name.parse().expect("a queue name");
            (user.permissions.permits_consuming(&queue), user.permissions.permits_producing(&queue))
        };
        assert_eq!(may("factory.A.requests"), (true, false));
        assert_eq!(may("factory.A.leases"), (true, false));
        assert_eq!(may("factory.A.ingress"), (false, true));
        for foreign in [
            "factory.B.requests",
            "factory.B.leases",
            "factory.B.ingress",
            "dead-letters",
            "tool.A.reports",
        ] {
            assert_eq!(may(foreign), (false, false), "{foreign}");
        }
        assert!(broker_access.users().user("factory.B").is_none());
        assert_eq!((user.organisation.as_deref(), user.is_owner), (Some("a"), false));
        let platform = broker_access.users().user(PLATFORM_USER).expect("known");
        assert!(platform.is_owner, "it has links for all");
    }
}
