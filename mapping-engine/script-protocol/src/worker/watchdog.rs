//! Ends the worker when a call cannot be ended otherwise.
//!
//! Engines poll their interrupt between bytecodes, not inside their native functions: a sort of a
//! huge array or the printing of a huge BigInt runs to its end. A thread cannot be killed safely, a
//! process can. So a second thread looks at the call at work, and when it overran sends what was
//! reached so far and exits. The host then knows the culprit without trying, and no result is lost.

use std::{
    fs::File,
    io,
    sync::{
        Arc, Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use super::clock::process_time;
use crate::{CallResult, ScriptId, ScriptLimits, WorkerMessage, frame};

/// A call that neither computes nor ends (it cannot, but who knows) is ended after so many budgets
/// by the wall clock.
const WALL_FACTOR: u32 = 20;

pub(super) struct Watchdog {
    shared: Arc<Shared>,
}

struct Shared {
    state: Mutex<WatchdogState>,
    /// Wakes the watching thread when there is something to watch.
    busy: Condvar,
    /// Odd while a script is at work; each call has its own number.
    call: AtomicU64,
    overrun: Duration,
}

struct WatchdogState {
    output: File,
    results: Vec<CallResult>,
    loading: Option<ScriptId>,
    is_busy: bool,
}

impl Watchdog {
    /// Starts the watching thread; `output` carries all messages of the worker.
    pub fn start(output: File, limits: &ScriptLimits) -> io::Result<Self> {
        let state = WatchdogState { output, results: Vec::new(), loading: None, is_busy: false };
        let shared = Arc::new(Shared {
            state: Mutex::new(state),
            busy: Condvar::new(),
            call: AtomicU64::new(0),
            overrun: limits.overrun_budget,
        });
        let watching = Arc::clone(&shared);
        thread::Builder::new()
            .name("watchdog".to_owned())
            .stack_size(128 << 10)
            .spawn(move || watching.watch())?;
        Ok(Self { shared })
    }

    /// Sends a message to the host as one frame, and notes that no script is at work.
    pub fn say(&self, message: &WorkerMessage) -> io::Result<()> {
        let mut state = self.shared.lock();
        state.is_busy = false;
        frame::write(&mut state.output, &message.encode())
    }

    /// Sends the results collected.
    pub fn say_results(&self) -> io::Result<()> {
        let mut state = self.shared.lock();
        state.is_busy = false;
        let results = std::mem::take(&mut state.results);
        frame::write(&mut state.output, &WorkerMessage::Results(results).encode())
    }

    /// Keeps a result until all are sent.
    pub fn push(&self, result: CallResult) {
        self.shared.lock().results.push(result);
    }

    /// Watches the loading of a script.
    pub fn loading<R>(&self, script: ScriptId, load: impl FnOnce() -> R) -> R {
        self.shared.lock().loading = Some(script);
        let result = self.calling(load);
        self.shared.lock().loading = None;
        result
    }

    /// Watches a call.
    pub fn calling<R>(&self, call: impl FnOnce() -> R) -> R {
        self.shared.call.fetch_add(1, Ordering::Release);
        {
            let mut state = self.shared.lock();
            if !state.is_busy {
                state.is_busy = true;
                self.shared.busy.notify_one();
            }
        }
        let result = call();
        self.shared.call.fetch_add(1, Ordering::Release);
        result
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, WatchdogState> {
        // A panic under the lock ends the process; the state is never half-written.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn watch(&self) {
        let pause = (self.overrun / 16).clamp(Duration::from_millis(1), Duration::from_millis(100));
        let mut seen = (0, Duration::ZERO, Instant::now());
        loop {
            let state = self.lock();
            if !state.is_busy {
                drop(self.busy.wait(state));
                continue;
            }
            drop(state);
            thread::sleep(pause);
            let call = self.call.load(Ordering::Acquire);
            let (now, wall) = (process_time(), Instant::now());
            if seen.0 != call {
                seen = (call, now, wall);
            } else if call % 2 == 1
                && (now - seen.1 >= self.overrun || wall - seen.2 >= self.overrun * WALL_FACTOR)
            {
                self.end(call);
            }
        }
    }

    /// The call may have ended in the last moment; then nothing happens.
    fn end(&self, call: u64) {
        let mut state = self.lock();
        if self.call.load(Ordering::Acquire) != call {
            return;
        }
        let message = match state.loading {
            Some(script) => WorkerMessage::LoadOverrun(script),
            None => WorkerMessage::Overrun(std::mem::take(&mut state.results)),
        };
        // Whether the host still reads or not, this process ends here.
        let _ = frame::write(&mut state.output, &message.encode());
        std::process::exit(1);
    }
}
