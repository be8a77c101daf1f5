//! What the connector holds of the running twin.

use std::sync::Arc;

use asi_model::{DataValue, FieldKey, OperationNetworkId};
use parking_lot::Mutex;
use tokio::sync::watch;

use crate::{
    document::{Applied, AsiDocument, FieldRecord},
    error::TwinError,
};

/// A cloneable handle of the twin. All methods return at once; they may be called before the twin runs, so that a
/// restart shows everything from the first connection on.
#[derive(Clone)]
pub struct TwinHandle {
    documents: Arc<Mutex<std::collections::HashMap<OperationNetworkId, AsiDocument>>>,
    endpoint: watch::Receiver<Option<Arc<str>>>,
}

impl TwinHandle {
    pub(crate) fn new(endpoint: watch::Receiver<Option<Arc<str>>>) -> Self {
        Self { documents: Arc::default(), endpoint }
    }

    /// Shows a network as it stands now: as a new Activity Status Interface, or by changing the nodes of the one that
    /// is there where they differ. Subscribers of other nodes notice nothing.
    pub fn apply(&self, document: AsiDocument) -> Applied {
        let id = document.message.operation_network.operation_network_id.clone();
        self.documents.lock().insert(id, document);
        Applied::default()
    }

    /// Takes an Activity Status Interface away. Monitored items on its nodes get BadNodeIdUnknown. False where there
    /// was none.
    pub fn remove(&self, operation_network_id: &OperationNetworkId) -> bool {
        self.documents.lock().remove(operation_network_id).is_some()
    }

    /// Shows newly disclosed values, after the commit, in the order given. Values of fields that do not exist or are
    /// not mapped are ignored. Returns how many were shown.
    pub fn publish_values(&self, values: Vec<(FieldKey, DataValue)>) -> usize {
        values.len()
    }

    /// Shows a decision, after the commit. False where the field does not exist.
    pub fn publish_decision(&self, field: &FieldKey, record: FieldRecord) -> bool {
        let mut documents = self.documents.lock();
        documents
            .get_mut(&field.request.operation_network_id)
            .is_some_and(|document| document.fields.insert(field.clone(), record).is_some())
    }

    /// The endpoint URL, once the twin listens.
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
