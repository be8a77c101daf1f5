//! Interface to the shop floor, where values come from.

use std::sync::Arc;

use shop_floor::{InputKey, MonitorRequest, ShopFloorError, ShopFloorHandle};

/// Monitoring of variables under keys.
///
/// Neither method waits: values, and the status of a source that is away, arrive as
/// [`shop_floor::InputChange`]s.
pub trait Inputs: Send + Sync + 'static {
    /// Monitors variables; all or none. A key that is used already is moved.
    ///
    /// # Errors
    /// [`ShopFloorError`] at a limit or for options out of range.
    fn monitor(&self, requests: Vec<Arc<MonitorRequest>>) -> Result<(), ShopFloorError>;

    /// Ends the monitoring of these inputs.
    fn unmonitor(&self, inputs: &[InputKey]);
}

impl Inputs for ShopFloorHandle {
    fn monitor(&self, requests: Vec<Arc<MonitorRequest>>) -> Result<(), ShopFloorError> {
        self.monitor_many(requests)
    }

    fn unmonitor(&self, inputs: &[InputKey]) {
        self.unmonitor_many(inputs);
    }
}
