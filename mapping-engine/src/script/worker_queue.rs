//! Queue of one worker: fair among scripts, bounded, and sent in one batch at a time.
//!
//! The worker gets its next job when it has completed the last one, so the two sides never wait for
//! each other. Calls collect while a batch is under way: batches grow with the load, and an idle
//! worker answers at once.

use std::{
    collections::{HashMap, VecDeque},
    sync::Arc,
};

use mapping::{Fault, transform::ScriptCall};
use script_protocol::{Call, Load, ScriptId};
use tokio::sync::mpsc;
use tokio_util::sync::CancellationToken;

use super::{ScriptOutcome, config::ScriptConfig, status::WorkerPlace, worker::ScriptWorker};

/// Most calls of a batch.
const BATCH_CALLS_MAX: usize = 256;
/// Approximate size of the largest batch, in bytes. A single call may exceed it.
const BATCH_BYTES_MAX: usize = 1 << 20;
/// Largest capacity, in calls, that an empty queue of a script keeps.
const RESERVED_CALLS_MAX: usize = 8;
/// Most waiting calls of one script; further ones supersede the newest.
const WAITING_PER_SCRIPT_MAX: usize = 64;
/// Most waiting calls of all scripts before each is held to its share. Above this, new calls replace
/// waiting ones instead of queueing. About half a second of work for cheap calls.
const WAITING_MAX: usize = 32_768;

/// Job for a worker.
#[derive(Debug)]
pub(crate) enum Job {
    Load(Load),
    Unload(ScriptId),
    Batch(Vec<Call>),
}

/// Completion of a job by a worker.
#[derive(Debug)]
pub(crate) struct Completion {
    /// Index of the worker.
    pub worker: usize,
    pub done: Done,
}

/// Result of a job.
#[derive(Debug)]
pub(crate) enum Done {
    Loaded(ScriptId, Result<(), Fault>),
    Unloaded,
    Called(Vec<ScriptOutcome>),
}

/// Waiting call, with the data from which the transform resumes.
#[derive(Debug)]
pub(crate) struct Waiting {
    pub call: Call,
    pub resume: ScriptCall,
}

/// Engine's side of a worker.
#[derive(Debug)]
pub(crate) struct WorkerQueue {
    jobs: mpsc::Sender<Job>,
    is_busy: bool,
    /// Loads and unloads, before any call.
    urgent: VecDeque<Job>,
    waiting: HashMap<ScriptId, VecDeque<Waiting>>,
    /// Number of waiting calls of all scripts.
    waiting_calls: usize,
    /// Scripts with waiting calls, in turn.
    turn: VecDeque<ScriptId>,
    under_way: Vec<(ScriptId, ScriptCall)>,
    pub scripts: usize,
}

impl WorkerQueue {
    /// Returns a queue and the future that serves it; `worker` is the index in its completions.
    pub fn new(
        worker: usize,
        config: Arc<ScriptConfig>,
        place: WorkerPlace,
        completions: mpsc::Sender<Completion>,
        shutdown: CancellationToken,
    ) -> (Self, impl Future<Output = ()> + Send) {
        let (jobs, receiver) = mpsc::channel(1);
        let script_worker = ScriptWorker::new(config, place);
        let serving = serve(worker, script_worker, receiver, completions, shutdown);
        let queue = Self {
            jobs,
            is_busy: false,
            urgent: VecDeque::new(),
            waiting: HashMap::new(),
            waiting_calls: 0,
            turn: VecDeque::new(),
            under_way: Vec::new(),
            scripts: 0,
        };
        (queue, serving)
    }

    /// Queues the loading of a script, before all calls.
    pub fn load(&mut self, load: Load) {
        self.scripts += 1;
        self.urgent.push_back(Job::Load(load));
        self.feed();
    }

    /// Queues the unloading of a script and drops its waiting calls.
    pub fn unload(&mut self, script: ScriptId) {
        self.scripts = self.scripts.saturating_sub(1);
        self.drop_waiting(script);
        self.urgent.push_back(Job::Unload(script));
        self.feed();
    }

    /// Drops the waiting calls of a script and returns their number.
    pub fn drop_waiting(&mut self, script: ScriptId) -> usize {
        self.turn.retain(|other| *other != script);
        let forgotten = self.waiting.remove(&script).map_or(0, |calls| calls.len());
        self.waiting_calls -= forgotten;
        forgotten
    }

    /// Queues a call. Returns true if it superseded a waiting one.
    pub fn call(&mut self, mut waiting: Waiting) -> bool {
        let script = waiting.call.script;
        let most = self.waiting_per_script_max();
        let queue = self.waiting.entry(script).or_default();
        if queue.is_empty() {
            self.turn.push_back(script);
        }
        let superseded = if queue.len() >= most { queue.pop_back() } else { None };
        if let Some(Waiting { call, .. }) = &superseded {
            // Changes of other inputs that the superseded call carried go with this one.
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

    /// Marks the worker idle and returns the calls that were under way, in the order of the outcomes.
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
            } else if queue.capacity() > RESERVED_CALLS_MAX {
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
    index: usize,
    mut worker: ScriptWorker,
    mut jobs: mpsc::Receiver<Job>,
    completions: mpsc::Sender<Completion>,
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
        if completions.send(Completion { worker: index, done }).await.is_err() {
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
    use crate::script::status::{ScriptWorkers, WorkerPurpose};

    fn waiting(script: u32) -> Waiting {
        let call =
            Call { script: ScriptId(script), value: CallValue::Input(0), inputs: Vec::new() };
        Waiting { call, resume: ScriptCall::without_value(0) }
    }

    /// A queue whose worker takes nothing, with so many scripts.
    fn queue(scripts: u32) -> WorkerQueue {
        let (completions, _) = mpsc::channel(1);
        let place = ScriptWorkers::default().place(WorkerPurpose::Mappings, 0);
        let (mut queue, _) =
            WorkerQueue::new(0, Arc::default(), place, completions, CancellationToken::new());
        queue.is_busy = true;
        queue.scripts = scripts as usize;
        queue
    }

    /// Offers each script so many calls, in turn; how many superseded another.
    fn offer(queue: &mut WorkerQueue, scripts: u32, calls: usize) -> usize {
        let in_turn = repeat_n((), calls).flat_map(|()| 0..scripts);
        in_turn.filter(|script| queue.call(waiting(*script))).count()
    }

    #[test]
    fn a_script_has_so_many_calls_waiting_and_what_waits_is_bounded_for_all_together() {
        let mut few = queue(2);
        assert_eq!(offer(&mut few, 2, 65), 2, "one each beyond sixty-four");
        assert_eq!(few.waiting_calls, 128);

        let mut many = queue(2000);
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
        let mut queue = queue(3);
        offer(&mut queue, 3, 20);
        assert_eq!(queue.drop_waiting(ScriptId(1)), 20);
        assert_eq!(queue.waiting_calls, 40);
        let Job::Batch(calls) = queue.batch() else { panic!("calls wait") };
        assert_eq!((calls.len(), queue.waiting_calls), (40, 0));
    }
}
