//! Unit of work: state, store and the changes of the transaction that is being made.

use connector_state::{ChangeSet, ConnectorState};
use ledger::LedgerKey;

use super::{config::CoordinatorConfig, outputs::Outputs};
use crate::store::Store;

/// State and store with their pending changes.
pub(super) struct UnitOfWork {
    pub(super) config: CoordinatorConfig,
    pub(super) store: Store,
    pub(super) state: ConnectorState,
    /// Changes of the transaction that is being made.
    pub(super) pending: ChangeSet,
    pub(super) outputs: Outputs,
    pub(super) key: LedgerKey,
}
