//! How each address stands: one that fails rests, longer each time, without disturbing the others.

use tokio::time::Instant;
use tracing::warn;

use super::{Pump, lane::Lane};
use crate::{
    address::LogicalAddress,
    spool::{Rejection, RowId},
    transport::LaneFault,
};

/// A resting address rests longer with each failure, up to so many times.
const RESTS_MAX: u32 = 64;

/// How one address stands.
#[derive(Default)]
pub(super) struct AddressState {
    pub lane: Option<Lane>,
    pub under_way: usize,
    /// Failures without a success since: after one, messages are tried one at a time.
    pub failures: u32,
    pub resting_until: Option<Instant>,
    /// Whether rows were passed over, so that they must be looked for again.
    pub has_skipped: bool,
}

impl Pump {
    /// Takes a row off those under way.
    pub(super) fn settled(&mut self, id: RowId) -> Option<(LogicalAddress, u32)> {
        let (address, attempts) = self.under_way.remove(&id)?;
        if let Some(state) = self.addresses.get_mut(&address) {
            state.under_way = state.under_way.saturating_sub(1);
            // Rows passed over for want of room are looked for when there is room again.
            if state.has_skipped
                && state.resting_until.is_none()
                && state.under_way * 2 <= self.limits.window
            {
                state.has_skipped = false;
                self.cursor.on_rewind();
            }
        }
        Some((address, attempts))
    }

    pub(super) fn address_works(&mut self, address: &LogicalAddress) {
        let Some(state) = self.addresses.get_mut(address) else { return };
        if state.failures > 0 {
            state.failures = 0;
            self.shared.hinder(&format!("sending to {address}"), None);
            if std::mem::take(&mut state.has_skipped) {
                self.cursor.on_rewind();
            }
        }
    }

    pub(super) fn on_lane_ended(&mut self, address: &LogicalAddress, fault: Option<LaneFault>) {
        if let Some(state) = self.addresses.get_mut(address) {
            state.lane = None;
            if fault.is_none() {
                state.has_skipped = false;
            }
        }
        match fault {
            // Idle; or rows came just as it ended, and are looked for again.
            None => self.cursor.on_rewind(),
            Some(LaneFault::Stalled(reason)) => {
                let _ = self.stalls.try_send(reason);
            }
            Some(LaneFault::Refused(rejection)) if is_oversize(&rejection) => {
                // The broker cuts the link over one message without saying which: one at a time it
                // will show.
                self.rest(address, rejection.to_string());
            }
            Some(fault) => self.rest(address, fault.to_string()),
        }
    }

    /// Lets an address rest, longer each time, without disturbing the others.
    pub(super) fn rest(&mut self, address: &LogicalAddress, reason: String) {
        let Some(state) = self.addresses.get_mut(address) else { return };
        state.has_skipped = true;
        if state.resting_until.is_some() {
            return;
        }
        let times = 1_u32.checked_shl(state.failures).unwrap_or(RESTS_MAX).min(RESTS_MAX);
        let until = Instant::now() + self.limits.address_backoff * times;
        state.failures = state.failures.saturating_add(1);
        state.resting_until = Some(until);
        self.retries.push(until);
        warn!(%address, reason, rest_ms = (self.limits.address_backoff * times).as_millis(), "an address rests");
        self.shared.hinder(&format!("sending to {address}"), Some(reason));
    }

    /// The end of a rest or of a pause: what was passed over is looked for again.
    pub(super) fn retry(&mut self) {
        let now = Instant::now();
        self.retries.retain(|at| *at > now);
        for state in self.addresses.values_mut() {
            if state.resting_until.is_some_and(|until| until <= now) {
                state.resting_until = None;
                state.has_skipped = false;
            }
        }
        self.cursor.on_rewind();
    }
}

fn is_oversize(rejection: &Rejection) -> bool {
    rejection.code == "amqp:link:message-size-exceeded"
}
