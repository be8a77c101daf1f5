//! Ends a call that computes too long, from a thread beside it.

use std::{
    io,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread,
    time::Duration,
};

use deno_core::v8::IsolateHandle;
use script_protocol::worker::process_time;

/// Watches the call at work.
pub struct Timer {
    shared: Arc<Shared>,
}

struct Shared {
    watched: Mutex<Watched>,
    begun: Condvar,
}

#[derive(Default)]
struct Watched {
    /// The isolate at work and the process' computing time at which its call is ended.
    call: Option<(IsolateHandle, Duration)>,
    has_fired: bool,
}

/// Interval between two looks at the call at work, and so the precision of a budget.
const PAUSE: Duration = Duration::from_millis(2);

impl Timer {
    /// Starts the thread. To be called before the sandbox, which lets no thread start.
    pub fn start() -> io::Result<Self> {
        let shared = Arc::new(Shared { watched: Mutex::default(), begun: Condvar::new() });
        let watching = Arc::clone(&shared);
        thread::Builder::new()
            .name("timer".to_owned())
            .stack_size(128 << 10)
            .spawn(move || watching.watch())?;
        Ok(Self { shared })
    }

    /// A call begins.
    pub fn begin(&self, isolate: IsolateHandle, budget: Duration) {
        let mut watched = self.shared.lock();
        watched.has_fired = false;
        watched.call = Some((isolate, process_time() + budget));
        self.shared.begun.notify_one();
    }

    /// The call ended. True if its budget ran out, whatever it returned.
    pub fn end(&self) -> bool {
        let mut watched = self.shared.lock();
        watched.call = None;
        watched.has_fired
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Watched> {
        // Nothing under this lock panics.
        self.watched.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn watch(&self) {
        loop {
            let mut watched = self.lock();
            match &watched.call {
                None => {
                    drop(self.begun.wait(watched));
                    continue;
                }
                Some((isolate, deadline)) if !watched.has_fired && process_time() >= *deadline => {
                    isolate.terminate_execution();
                    watched.has_fired = true;
                }
                Some(_) => {}
            }
            drop(watched);
            thread::sleep(PAUSE);
        }
    }
}
