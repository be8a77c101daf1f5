//! Connection to a server: an established session with its namespaces, data types and limits.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use asi_model::values::{Namespace, NodeId};
use opcua_stack::{
    NamespaceTable,
    notifications::decode_data_changes,
    opcua::{
        client::{Session, browser::BrowserConfig, custom_types::DataTypeTreeBuilder},
        types::{Error, StatusCode, custom::DynamicTypeLoader},
    },
    values::status_from_stack,
};
use parking_lot::{Mutex, RwLock};
use tokio::sync::OnceCell;

use super::request_size::per_request;
use crate::{ServerLimits, ShopFloorError, SourceId};

/// Longest wait for the response to one request.
pub(super) const RESPONSE_TIMEOUT: Duration = Duration::from_secs(10);
/// Longest wait until all data types of a server are read.
const TYPES_TIMEOUT: Duration = Duration::from_secs(60);
/// Most requests for data types in flight at the same time.
const TYPE_REQUESTS_AT_ONCE: usize = 4;
/// Most data types browsed in one request.
const TYPES_PER_REQUEST_MAX: usize = 100;

/// Cloneable handle that all services send their requests through.
#[derive(Clone)]
pub(crate) struct Connection {
    inner: Arc<Inner>,
}

struct Inner {
    source: SourceId,
    session: Arc<Session>,
    namespaces: RwLock<NamespaceTable>,
    limits: ServerLimits,
    types_loaded: OnceCell<bool>,
    last_response_at: Mutex<Instant>,
}

impl Connection {
    pub(super) fn new(
        source: SourceId,
        session: Arc<Session>,
        namespaces: NamespaceTable,
        limits: ServerLimits,
    ) -> Self {
        decode_data_changes(session.encoding_context().write().loaders_mut());
        let namespaces = RwLock::new(namespaces);
        let last_response_at = Mutex::new(Instant::now());
        let types_loaded = OnceCell::new();
        Self {
            inner: Arc::new(Inner {
                source,
                session,
                namespaces,
                limits,
                types_loaded,
                last_response_at,
            }),
        }
    }

    pub(super) fn session(&self) -> &Arc<Session> {
        &self.inner.session
    }

    /// Returns the session's namespaces, with the server's data types once they are loaded.
    pub(super) fn namespaces(&self) -> NamespaceTable {
        self.inner.namespaces.read().clone()
    }

    /// Returns a node's id with the URI of its namespace in place of the server's index.
    pub(crate) fn with_uri(&self, node: NodeId) -> NodeId {
        match node.namespace {
            Namespace::Index(index) => {
                let namespace = self.inner.namespaces.read().namespace(index);
                NodeId { namespace, identifier: node.identifier }
            }
            _ => node,
        }
    }

    pub(super) fn limits(&self) -> ServerLimits {
        self.inner.limits
    }

    /// Returns true once the data types are loaded or loading them has failed.
    pub(super) fn are_types_settled(&self) -> bool {
        self.inner.types_loaded.initialized()
    }

    /// Reads the server's data types, once per session; structures are decoded afterwards. Returns
    /// true when they are known.
    pub(super) async fn load_types(&self) -> bool {
        *self.inner.types_loaded.get_or_init(|| self.try_load_types()).await
    }

    async fn try_load_types(&self) -> bool {
        let limits = self.inner.limits;
        let browsing = BrowserConfig::new()
            .max_nodes_per_request(
                per_request(limits.nodes_per_browse_max).min(TYPES_PER_REQUEST_MAX),
            )
            .max_concurrent_requests(TYPE_REQUESTS_AT_ONCE);
        let tree = DataTypeTreeBuilder::new(|_| true)
            .config(browsing)
            .values_per_read(per_request(limits.nodes_per_read_max))
            .build(&self.inner.session);
        let reason = match tokio::time::timeout(TYPES_TIMEOUT, tree).await {
            Ok(Ok(tree)) => {
                let tree = Arc::new(tree);
                let namespaces = self.namespaces().with_data_types(Arc::clone(&tree));
                *self.inner.namespaces.write() = namespaces;
                self.inner.session.add_type_loader(Arc::new(DynamicTypeLoader::new(tree)));
                return true;
            }
            Ok(Err(error)) => error.to_string(),
            Err(_) => "no response in time".to_owned(),
        };
        tracing::warn!(source.id = %self.inner.source, %reason,
            "The data types of a server could not be read; its structures stay undecoded.");
        false
    }

    /// Returns the time since the server last responded to a request.
    pub(super) fn silence(&self) -> Duration {
        self.inner.last_response_at.lock().elapsed()
    }

    /// Waits for the response to a request, at most [`RESPONSE_TIMEOUT`].
    pub(super) async fn request<T>(
        &self,
        request: impl Future<Output = Result<T, Error>>,
    ) -> Result<T, ShopFloorError> {
        match tokio::time::timeout(RESPONSE_TIMEOUT, request).await {
            Ok(Ok(response)) => {
                *self.inner.last_response_at.lock() = Instant::now();
                Ok(response)
            }
            Ok(Err(error)) => Err(self.error(error.status())),
            Err(_) => Err(ShopFloorError::Timeout(self.inner.source.clone())),
        }
    }

    fn error(&self, status: StatusCode) -> ShopFloorError {
        match status {
            StatusCode::BadTimeout | StatusCode::BadRequestTimeout => {
                ShopFloorError::Timeout(self.inner.source.clone())
            }
            StatusCode::BadConnectionClosed
            | StatusCode::BadNotConnected
            | StatusCode::BadSessionIdInvalid
            | StatusCode::BadSessionClosed
            | StatusCode::BadSecureChannelClosed
            | StatusCode::BadSecureChannelIdInvalid => {
                ShopFloorError::NotConnected(self.inner.source.clone())
            }
            status => ShopFloorError::Refused { status: status_from_stack(status) },
        }
    }
}
