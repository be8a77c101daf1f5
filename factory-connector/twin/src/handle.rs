//! Handle of the twin for the connector.

use std::sync::Arc;

use asi_model::{FieldKey, OperationNetworkId};
use disclosure::Released;
use opcua_stack::opcua::{
    server::{ServerHandle, authenticator::UserToken},
    types::{DataValue as StackValue, NodeId},
};
use tokio::sync::watch;

use crate::{
    asi::AsiProvider,
    document::{AppliedDocument, AsiDocument, FieldRecord},
    error::TwinError,
    events::EventReporter,
    host::NodeHost,
    provider::NodeProvider,
    security::{application_certificate::ApplicationCertificate, trust::TrustList},
    session_token::user_of,
    sessions::{TwinSession, session_id},
};

/// Message of the audit event of a session that ended with its user's rights.
const USER_CHANGED: &str =
    "A session was ended, for its user got another password or role, or is gone.";

/// Message of the audit event of a session that a person ended.
const ENDED_AT_PAGES: &str = "A session was ended at the connector's pages.";

/// A cloneable handle of the twin. All methods but [`Self::ready`] return at once; they may be
/// called before the twin runs, so that the first client after a restart finds all nodes.
#[derive(Clone)]
pub struct TwinHandle {
    interfaces: Arc<AsiProvider>,
    host: Arc<NodeHost>,
    server: ServerHandle,
    events: Arc<EventReporter>,
    files: TrustFiles,
    endpoint: watch::Receiver<Option<Arc<str>>>,
}

/// The files in the folder of certificates.
#[derive(Clone)]
pub(crate) struct TrustFiles {
    pub trust_list: TrustList,
    pub application_certificate: ApplicationCertificate,
}

impl TwinHandle {
    pub(crate) fn new(
        interfaces: Arc<AsiProvider>,
        host: Arc<NodeHost>,
        server: ServerHandle,
        events: Arc<EventReporter>,
        files: TrustFiles,
        endpoint: watch::Receiver<Option<Arc<str>>>,
    ) -> Self {
        Self { interfaces, host, server, events, files, endpoint }
    }

    /// Shows the present state of a network: as a new Activity Status Interface, or by changing the
    /// nodes that differ in the existing one. Subscribers of other nodes get no notification.
    pub fn apply(&self, document: AsiDocument) -> AppliedDocument {
        self.interfaces.apply(document)
    }

    /// Removes an Activity Status Interface. Monitored items on its nodes get BadNodeIdUnknown. False
    /// when there is none.
    pub fn remove(&self, operation_network_id: &OperationNetworkId) -> bool {
        self.interfaces.remove_interface(operation_network_id)
    }

    /// Returns the number of Activity Status Interfaces.
    #[must_use]
    pub fn interfaces(&self) -> usize {
        self.interfaces.count()
    }

    /// Shows newly released values, after the commit, in the order given. Values of fields that do
    /// not exist or are not mapped are ignored. Returns how many were shown.
    pub fn publish_values(&self, values: Vec<(FieldKey, Released)>) -> usize {
        self.interfaces.publish_values(values)
    }

    /// Shows a decision, after the commit. False when the field does not exist.
    pub fn publish_decision(&self, field: &FieldKey, record: FieldRecord) -> bool {
        self.interfaces.publish_decision(field, record)
    }

    /// Returns the index of a namespace on this server, for a new provider. Indexes stay the same
    /// while the server runs.
    #[must_use]
    pub fn namespace_index(&self, uri: &str) -> u16 {
        self.host.namespace_index(uri)
    }

    /// Adds a provider: its namespaces, types and nodes exist from now on, also for connected
    /// clients.
    pub fn add_provider(&self, provider: Arc<dyn NodeProvider>) {
        self.host.add_provider(provider);
    }

    /// Removes a provider with its namespaces, types and nodes.
    pub fn remove_provider(&self, provider: &Arc<dyn NodeProvider>) {
        self.host.remove_provider(provider);
    }

    /// Pushes new values of a provider's variables into the monitored items of clients.
    pub fn notify_values(&self, values: &[(NodeId, StackValue)]) {
        self.host.notify(values);
    }

    /// Returns the certificates of clients, which the engineer approves or rejects.
    #[must_use]
    pub fn trust_list(&self) -> &TrustList {
        &self.files.trust_list
    }

    /// Returns the twin's certificate, which an authority may issue.
    #[must_use]
    pub fn application_certificate(&self) -> &ApplicationCertificate {
        &self.files.application_certificate
    }

    /// Ends the sessions of a user and their subscriptions, as after a change of password or role: an
    /// open session stays with its role. The client may sign in again. Returns their number.
    pub async fn end_sessions_of(&self, user_name: &str) -> usize {
        let ended = self.server.close_sessions(|token| &*user_of(token).name == user_name).await;
        let count = ended.len();
        for (session_id, user_token) in ended {
            self.events.report_terminated(session_id, Some(user_token), USER_CHANGED);
        }
        count
    }

    /// Returns the open sessions of a user.
    #[must_use]
    pub fn sessions_of(&self, user_name: &str) -> Vec<TwinSession> {
        let sessions = self.server.sessions();
        let own = sessions.into_iter().filter(|one| &*user_of(&one.user_token).name == user_name);
        own.filter_map(TwinSession::of).collect()
    }

    /// Ends a session of a user with its subscriptions. False when the user has no such session.
    pub async fn end_session_of(&self, user_name: &str, number: u32) -> bool {
        let id = session_id(number);
        let is_own = |token: &UserToken| &*user_of(token).name == user_name;
        let Some(user_token) = self.server.close_session(&id, is_own).await else { return false };
        self.events.report_terminated(id, Some(user_token), ENDED_AT_PAGES);
        true
    }

    /// Returns the endpoint URL, once the twin listens.
    #[must_use]
    pub fn endpoint(&self) -> watch::Receiver<Option<Arc<str>>> {
        self.endpoint.clone()
    }

    /// Waits until the twin listens and returns its endpoint URL with the real port.
    ///
    /// # Errors
    /// [`TwinError::Stopped`] when the twin ended before it listened.
    pub async fn ready(&self) -> Result<Arc<str>, TwinError> {
        let mut endpoint = self.endpoint.clone();
        let url = endpoint.wait_for(Option::is_some).await.map_err(|_| TwinError::Stopped)?;
        url.clone().ok_or(TwinError::Stopped)
    }
}
