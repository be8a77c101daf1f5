//! Ends a call that computes too long, without reading a clock on the fast path.

use std::{cell::Cell, rc::Rc, time::Duration};

use rquickjs::Runtime;
use script_protocol::worker::thread_time;

/// Shared between the caller and the engine's interrupt.
#[derive(Default)]
pub struct Guard {
    /// The number of the call at work; 0 while none is, so that a stale budget never fires.
    call: Cell<u64>,
    /// The call that the interrupt saw last, and when.
    seen: Cell<u64>,
    since: Cell<Duration>,
    budget: Cell<Duration>,
    /// Scripts can swallow the interrupt (a promise's executor does): this tells.
    has_fired: Cell<bool>,
    calls: Cell<u64>,
}

impl Guard {
    /// A guard on a runtime.
    pub fn install(runtime: &Runtime, budget: Duration) -> Rc<Self> {
        let guard = Rc::new(Self { budget: Cell::new(budget), ..Self::default() });
        let polled = Rc::clone(&guard);
        runtime.set_interrupt_handler(Some(Box::new(move || polled.poll())));
        guard
    }

    /// Runs something under the budget. The second value is true if the budget ran out, whatever
    /// the first says.
    pub fn watch<R>(&self, run: impl FnOnce() -> R) -> (R, bool) {
        let call = self.calls.get() + 1;
        self.calls.set(call);
        self.has_fired.set(false);
        self.call.set(call);
        let result = run();
        self.call.set(0);
        (result, self.has_fired.get())
    }

    /// The first poll of a call only reads the clock: the call has then run ten thousand jumps at
    /// most.
    fn poll(&self) -> bool {
        let call = self.call.get();
        if call == 0 {
            return false;
        }
        if self.seen.get() != call {
            self.seen.set(call);
            self.since.set(thread_time());
            return false;
        }
        let is_over = thread_time().saturating_sub(self.since.get()) > self.budget.get();
        if is_over {
            self.has_fired.set(true);
        }
        is_over
    }
}
