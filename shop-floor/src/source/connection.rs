//! An established session, as all services use it.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

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

use crate::{ServerLimits, ShopFloorError, SourceId};

/// Longest wait for an answer to one request.
pub(super) const ANSWER_TIMEOUT: Duration = Duration::from_secs(10);
/// Longest wait for reading all data types of a server.
const TYPES_TIMEOUT: Duration = Duration::from_secs(60);
/// Requests for data types that are under way at the same time.
const TYPE_REQUESTS_AT_ONCE: usize = 4;
/// Operations per request where the server declares no limit.
const OPERATIONS_DEFAULT: usize = 1000;

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
    answered_at: Mutex<Instant>,
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
        let answered_at = Mutex::new(Instant::now());
        let types_loaded = OnceCell::new();
        Self {
            inner: Arc::new(Inner {
                source,
                session,
                namespaces,
                limits,
                types_loaded,
                answered_at,
            }),
        }
    }

    pub(super) fn session(&self) -> &Arc<Session> {
        &self.inner.session
    }

    /// The session's namespaces, and data types once they were loaded.
    pub(super) fn namespaces(&self) -> NamespaceTable {
        self.inner.namespaces.read().clone()
    }

    pub(super) fn limits(&self) -> ServerLimits {
        self.inner.limits
    }

    /// True once loading the data types was tried.
    pub(super) fn are_types_settled(&self) -> bool {
        self.inner.types_loaded.initialized()
    }

    /// Reads the server's data types, once per session; from then on structures are decoded.
    /// Returns whether they are known.
    pub(super) async fn load_types(&self) -> bool {
        *self
            .inner
            .types_loaded
            .get_or_init(|| async {
                let limits = self.inner.limits;
                let browsing = BrowserConfig::new()
                    .max_nodes_per_request(per_request(limits.nodes_per_browse_max).min(100))
                    .max_concurrent_requests(TYPE_REQUESTS_AT_ONCE);
                let tree = DataTypeTreeBuilder::new(|_| true)
                    .config(browsing)
                    .values_per_read(per_request(limits.nodes_per_read_max))
                    .build(&self.inner.session);
                match tokio::time::timeout(TYPES_TIMEOUT, tree).await {
                    Ok(Ok(tree)) => {
                        let tree = Arc::new(tree);
                        let namespaces = self.namespaces().with_data_types(Arc::clone(&tree));
                        *self.inner.namespaces.write() = namespaces;
                        self.inner.session.add_type_loader(Arc::new(DynamicTypeLoader::new(tree)));
                        true
                    }
                    Ok(Err(error)) => {
                        tracing::warn!(source.id = %self.inner.source, %error,
                            "The data types of a server could not be read; its structures stay undecoded.");
                        false
                    }
                    Err(_) => {
                        tracing::warn!(source.id = %self.inner.source,
                            "The data types of a server were not read in time; its structures stay undecoded.");
                        false
                    }
                }
            })
            .await
    }

    /// How long ago the server last answered a request.
    pub(super) fn silence(&self) -> Duration {
        self.inner.answered_at.lock().elapsed()
    }

    /// Waits for an answer, no longer than [`ANSWER_TIMEOUT`].
    pub(super) async fn ask<T>(
        &self,
        request: impl Future<Output = Result<T, Error>>,
    ) -> Result<T, ShopFloorError> {
        match tokio::time::timeout(ANSWER_TIMEOUT, request).await {
            Ok(Ok(answer)) => {
                *self.inner.answered_at.lock() = Instant::now();
                Ok(answer)
            }
            Ok(Err(error)) => Err(self.refusal(error.status())),
            Err(_) => Err(ShopFloorError::Timeout(self.inner.source.clone())),
        }
    }

    fn refusal(&self, status: StatusCode) -> ShopFloorError {
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

/// How many operations go into one request: the server's limit, but not more than we think wise.
pub(super) fn per_request(limit: Option<u32>) -> usize {
    limit
        .map_or(OPERATIONS_DEFAULT, |limit| usize::try_from(limit).unwrap_or(OPERATIONS_DEFAULT))
        .clamp(1, OPERATIONS_DEFAULT)
}
