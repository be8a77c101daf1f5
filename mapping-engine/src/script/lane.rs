//! The way from the engine to one worker: a fair, bounded queue, and one batch at a time.
//!
//! The worker asks for the next job when it is done with the last, so neither side ever waits for
//! the other while the other waits for it. While a batch is under way calls gather; so batches grow
//! with the load and an idle worker answers at once.

use mapping::{Fault, transform::ScriptCall};
use std::{
    collections::{HashMap, VecDeque},
    sync::Arc,
};

use script_protocol::{Call, Load, ScriptId};
use tokio::sync::mpsc;
use tokio_util::sync::CancellationToken;

use super::{CallOutcome, config::ScriptConfig, worker::ScriptWorker};

/// Most calls of a batch.
const BATCH_CALLS_MAX: usize = 256;
/// About how long a batch may get, in bytes. A single call may exceed it.
const BATCH_BYTES_MAX: usize = 1 << 20;
/// Room for so many calls stays reserved for a script.
const QUEUE_KEPT_MAX: usize = 8;
/// Most calls of one script that wait; further ones supersede the newest.
const WAITING_PER_SCRIPT_MAX: usize = 64;
/// Once so many calls of all scripts wait, none gets more waiting than its share: what is asked of
/// a worker beyond its power costs values, not memory. Of cheap calls a worker does as many in
/// about half a second.
const WAITING_MAX: usize = 32_768;

/// What a worker is to do.
#[derive(Debug)]
pub(crate) enum Job {
    Load(Load),
    Unload(ScriptId),
    Batch(Vec<Call>),
}

/// What became of it.
#[derive(Debug)]
pub(crate) struct Report {
    pub lane: usize,
    pub done: Done,
}

#[derive(Debug)]
pub(crate) enum Done {
    Loaded(ScriptId, Result<(), Fault>),
    Unloaded,
    Called(Vec<CallOutcome>),
}

/// A call that waits, with what the transform needs to go on.
#[derive(Debug)]
pub(crate) struct Waiting {
    pub call: Call,
    pub resume: ScriptCall,
}

/// The engine's side of a worker.
#[derive(Debug)]
pub(crate) struct Lane {
    jobs: mpsc::Sender<Job>,
    is_busy: bool,
    /// Loads and unloads, before any call.
    urgent: VecDeque<Job>,
    waiting: HashMap<ScriptId, VecDeque<Waiting>>,
    /// How many calls wait, of all scripts.
    waiting_calls: usize,
    /// Scripts with waiting calls, in turn.
    turn: VecDeque<ScriptId>,
    under_way: Vec<(ScriptId, ScriptCall)>,
    pub scripts: usize,
}

impl Lane {
    /// A lane and the future that serves it.
    pub fn new(
        lane: usize,
        config: Arc<ScriptConfig>,
        reports: mpsc::Sender<Report>,
        shutdown: CancellationToken,
    ) -> (Self, impl Future<Output = ()> + Send) {
        let (jobs, receiver) = mpsc::channel(1);
        let serving = serve(lane, ScriptWorker::new(config), receiver, reports, shutdown);
        let lane = Self {
            jobs,
            is_busy: false,
            urgent: VecDeque::new(),
            waiting: HashMap::new(),
            waiting_calls: 0,
            turn: VecDeque::new(),
            under_way: Vec::new(),
            scripts: 0,
        };
        (lane, serving)
    }

    pub fn load(&mut self, load: Load) {
        self.scripts += 1;
        self.urgent.push_back(Job::Load(load));
        self.feed();
    }

    pub fn unload(&mut self, script: ScriptId) {
        self.scripts = self.scripts.saturating_sub(1);
        self.forget(script);
        self.urgent.push_back(Job::Unload(script));
        self.feed();
    }

    /// Drops the waiting calls of a script; how many there were.
    pub fn forget(&mut self, script: ScriptId) -> usize {
        self.turn.retain(|other| *other != script);
        let forgotten = self.waiting.remove(&script).map_or(0, |calls| calls.len());
        self.waiting_calls -= forgotten;
        forgotten
    }

    /// Queues a call. True if it superseded one that waited.
    pub fn call(&mut self, mut waiting: Waiting) -> bool {
        let script = waiting.call.script;
        let most = self.waiting_per_script_max();
        let queue = self.waiting.entry(script).or_default();
        if queue.is_empty() {
            self.turn.push_back(script);
        }
        let superseded = if queue.len() >= most { queue.pop_back() } else { None };
        if let Some(Waiting { call, .. }) = &superseded {
            // What the superseded call would have told of other inputs is told by this one.
            for input in &call.inputs {
                if !waiting.call.inputs.iter().any(|newer| newer.input == input.input) {
                    waiting.call.inputs.push(input.clone());
                }
            }
        }
        queue.push_back(waiting);
        if superseded.is_none() {
            self.waiting_calls += 1;
        }
        superseded.is_some()
    }

    fn waiting_per_script_max(&self) -> usize {
        if self.waiting_calls < WAITING_MAX {
            return WAITING_PER_SCRIPT_MAX;
        }
        (WAITING_MAX / self.scripts.max(1)).clamp(1, WAITING_PER_SCRIPT_MAX)
    }

    /// Gives the worker its next job if it is idle.
    pub fn feed(&mut self) {
        if self.is_busy {
            return;
        }
        let job = match self.urgent.pop_front() {
            Some(job) => job,
            None if self.turn.is_empty() => return,
            None => self.batch(),
        };
        // An idle worker has taken everything, so there is room; a closed channel means the engine
        // is shutting down.
        self.is_busy = self.jobs.try_send(job).is_ok();
    }

    /// The worker is idle again. The calls that were under way, in the order of the outcomes.
    pub fn done(&mut self) -> Vec<(ScriptId, ScriptCall)> {
        self.is_busy = false;
        std::mem::take(&mut self.under_way)
    }

    /// One call of each script in turn, until the batch is full. A script's calls keep their order.
    fn batch(&mut self) -> Job {
        let mut calls = Vec::new();
        let mut bytes = 0;
        while calls.len() < BATCH_CALLS_MAX && bytes < BATCH_BYTES_MAX {
            let Some(script) = self.turn.pop_front() else { break };
            let Some(queue) = self.waiting.get_mut(&script) else { continue };
            let Some(Waiting { call, resume }) = queue.pop_front() else { continue };
            self.waiting_calls -= 1;
            if !queue.is_empty() {
                self.turn.push_back(script);
            } else if queue.capacity() > QUEUE_KEPT_MAX {
                // A short queue is kept, since the next call comes soon.
                self.waiting.remove(&script);
            }
            bytes += size(&call);
            calls.push(call);
            self.under_way.push((script, resume));
        }
        Job::Batch(calls)
    }
}

/// Scalars are small; only what can be long is measured.
fn size(call: &Call) -> usize {
    use script_protocol::{CallValue, ScriptValue};
    let is_long = |value: &ScriptValue| {
        matches!(
            value,
            ScriptValue::Text(_)
                | ScriptValue::Bytes(_)
                | ScriptValue::List(_)
                | ScriptValue::Record(_)
        )
    };
    let own = matches!(&call.value, CallValue::Own(spoken) if is_long(&spoken.value));
    if own || call.inputs.iter().any(|input| is_long(&input.spoken.value)) {
        call.size()
    } else {
        64
    }
}

async fn serve(
    lane: usize,
    mut worker: ScriptWorker,
    mut jobs: mpsc::Receiver<Job>,
    reports: mpsc::Sender<Report>,
    shutdown: CancellationToken,
) {
    loop {
        let job = tokio::select! {
            () = shutdown.cancelled() => break,
            job = jobs.recv() => job,
        };
        let Some(job) = job else { break };
        let working = async {
            match job {
                Job::Load(load) => {
                    let script = load.script;
                    Done::Loaded(script, worker.load(load).await)
                }
                Job::Unload(script) => {
                    worker.unload(script).await;
                    Done::Unloaded
                }
                Job::Batch(calls) => Done::Called(worker.run(calls).await),
            }
        };
        let done = tokio::select! {
            () = shutdown.cancelled() => break,
            done = working => done,
        };
        if reports.send(Report { lane, done }).await.is_err() {
            break;
        }
    }
    worker.take_down().await;
}

#[cfg(test)]
mod tests {
    use std::iter::repeat_n;

    use script_protocol::CallValue;

    use super::*;

    fn waiting(script: u32) -> Waiting {
        let call =
            Call { script: ScriptId(script), value: CallValue::Input(0), inputs: Vec::new() };
        Waiting { call, resume: ScriptCall::without_value(0) }
    }

    /// A lane whose worker takes nothing, with so many scripts.
    fn lane(scripts: u32) -> Lane {
        let (reports, _) = mpsc::channel(1);
        let (mut lane, _) = Lane::new(0, Arc::default(), reports, CancellationToken::new());
        lane.is_busy = true;
        lane.scripts = scripts as usize;
        lane
    }

    /// Offers each script so many calls, in turn; how many superseded another.
    fn offer(lane: &mut Lane, scripts: u32, calls: usize) -> usize {
        let in_turn = repeat_n((), calls).flat_map(|()| 0..scripts);
        in_turn.filter(|script| lane.call(waiting(*script))).count()
    }

    #[test]
    fn a_script_has_so_many_calls_waiting_and_what_waits_is_bounded_for_all_together() {
        let mut few = lane(2);
        assert_eq!(offer(&mut few, 2, 65), 2, "one each beyond sixty-four");
        assert_eq!(few.waiting_calls, 128);

        let mut many = lane(2000);
        assert_eq!(offer(&mut many, 2000, 16), 0, "a burst of each finds room");
        assert_eq!(
            offer(&mut many, 2000, 48),
            2000 * 64 - WAITING_MAX,
            "further ones do where all is taken"
        );
        assert_eq!(many.waiting_calls, WAITING_MAX);
        assert!(
            many.waiting.values().all(|queue| queue.len() >= WAITING_MAX / 2000),
            "none has less than its share"
        );
    }

    #[test]
    fn what_waits_is_counted_whatever_becomes_of_it() {
        let mut lane = lane(3);
        offer(&mut lane, 3, 20);
        assert_eq!(lane.forget(ScriptId(1)), 20);
        assert_eq!(lane.waiting_calls, 40);
        let Job::Batch(calls) = lane.batch() else { panic!("calls wait") };
        assert_eq!((calls.len(), lane.waiting_calls), (40, 0));
    }
}
