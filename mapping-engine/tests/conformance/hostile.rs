//! Scripts that want to take the machine down.

use std::{
    fs,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use mapping_engine::{CircuitState, FaultKind as K};

use super::bench::{Bench, Worker};

/// The budget of a call in these tests.
const BUDGET_MS: u64 = 300;
/// Attempts to see a script end in time, because a busy machine does not share its
/// time evenly.
const ATTEMPTS: u32 = 3;

const TIME: &[K] = &[K::ScriptTimeout];
const MEMORY: &[K] = &[K::ScriptOutOfMemory, K::ScriptTimeout];
const ERROR: &[K] = &[K::ScriptError, K::ScriptOutOfMemory, K::ScriptTimeout];
const RESULT: &[K] = &[K::ScriptResult, K::ScriptError];
/// Faults that end the process and faults that the engine catches.
const ANY: &[K] = &[K::ScriptTimeout, K::ScriptOutOfMemory, K::ScriptError, K::ScriptCrash];

/// Each with the kinds of fault it may end as.
const TABLE: &[(&str, &str, &[K])] = &[
    ("endless loop", "(v) => { for (;;) {} }", TIME),
    (
        "loop that catches",
        "(v) => { for (;;) { try { for (;;) {} } catch {} finally { continue } } }",
        TIME,
    ),
    ("generator", "(v) => { function* g() { for (;;) yield 1 } for (const x of g()); }", TIME),
    ("getter", "(v) => { const o = { get x() { for (;;) {} } }; return o.x }", TIME),
    ("getter of the result", "(v) => ({ get value() { for (;;) {} } })", TIME),
    ("proxy", "(v) => { const p = new Proxy({}, { get() { for (;;) {} } }); return p.x }", TIME),
    ("sort callback", "(v) => { [3, 1, 2].sort(() => { for (;;) {} }) }", TIME),
    ("promise executor", "(v) => { new Promise((r) => { for (;;) r() }); return 1 }", TIME),
    (
        "state with a getter",
        "(v, ctx) => { ctx.state = { get x() { for (;;) {} } }; return 1 }",
        TIME,
    ),
    (
        "state with toJSON",
        "(v, ctx) => { ctx.state = { toJSON() { for (;;) {} } }; return 1 }",
        TIME,
    ),
    (
        "arrays without end",
        "(v) => { const a = []; for (;;) a.push(new Array(1e6).fill(1)) }",
        MEMORY,
    ),
    (
        "objects without end",
        "(v) => { const a = []; for (;;) a.push({ x: a.length, y: [1, 2, 3] }) }",
        MEMORY,
    ),
    (
        "map without end",
        "(v) => { const m = new Map(); for (let i = 0; ; i++) m.set(i, String(i)) }",
        MEMORY,
    ),
    (
        "buffers without end",
        "(v) => { const a = []; for (;;) a.push(new ArrayBuffer(1 << 20)) }",
        ERROR,
    ),
    (
        "allocation that catches",
        "(v) => { const a = []; for (;;) { try { a.push(new Array(1e5).fill(1)) } catch {} } }",
        MEMORY,
    ),
    ("text doubling", "(v) => { let s = 'ab'; for (;;) s += s }", ERROR),
    ("huge text", "(v) => 'a'.repeat(2 ** 29)", ERROR),
    ("regular expression", "(v) => /^(a+)+$/.test('a'.repeat(40) + 'b')", TIME),
    ("deep recursion", "(v) => { const f = (n) => 1 + f(n + 1); return f(0) }", ERROR),
    ("deep JSON", "(v) => JSON.parse('['.repeat(1e6))", ERROR),
    ("native search", "const s = 'x'.repeat(4e6); (v) => { for (;;) s.indexOf('y') }", ANY),
    ("native number", "(v) => (2n ** 30000000n).toString().length", ANY),
    ("native join", "(v) => (new Array(1e9) + '').length", ANY),
    (
        "length of a proxy",
        "(v) => new Proxy([], { get: (t, k) => k === 'length' ? 1.5 : 7 })",
        RESULT,
    ),
    (
        "length that changes",
        "(v) => { let n = 0; const length = { valueOf: () => (n++ < 2 ? 1 : 3) }; \
         return new Proxy([], { get: (t, k) => k === 'length' ? length : 7 }) }",
        RESULT,
    ),
    ("native walk", "(v) => [].indexOf.call({ length: 2 ** 53 - 1 }, 1)", TIME),
];

pub async fn hostile_scripts_end_in_time_and_disturb_nobody(worker: &Worker) {
    let budget = Duration::from_millis(BUDGET_MS);
    let mut bench = Bench::start(worker, |config| {
        config.call_budget_ms = BUDGET_MS;
        config.rest_s = 3600;
    });
    let counting = "(v, ctx) => { ctx.state = (ctx.state ?? 0) + 1; return ctx.state * 1000 + v }";
    bench.put_script("neighbour", &["a"], "Double", counting).await;
    let mut calls = 0.0;
    let mut report = String::new();
    for (name, source, kinds) in TABLE {
        let mut fastest = Duration::MAX;
        for attempt in 0..ATTEMPTS {
            let id = format!("{name} {attempt}");
            bench.put_script(&id, &["a"], "Double", source).await;
            let share = Share::measure();
            let begun = Instant::now();
            bench.feed(&id, "a", 1_i32).await;
            bench.feed("neighbour", "a", 7_i32).await;
            let value = bench.next(&id).await.value;
            fastest = fastest.min(begun.elapsed().mul_f64(share.end()));
            let fault =
                bench.status(&id).await.last_fault.unwrap_or_else(|| panic!("{name}: {value:?}"));
            assert!(kinds.contains(&fault.kind), "{name}: {fault:?}");
            assert!(value.status.0 >> 30 == 2 && value.value.is_null(), "{name}: {value:?}");
            // The neighbour was asked meanwhile: it answered, in order, and remembers every call.
            calls += 1.0;
            assert_eq!(
                bench.next("neighbour").await.value.value,
                (calls * 1000.0 + 7.0).into(),
                "{name}"
            );
            bench.remove(&id).await;
            if fastest <= 2 * budget {
                break;
            }
        }
        report.push_str(&format!("{name}: {fastest:?}\n"));
        assert!(
            fastest <= 2 * budget,
            "{name} ended after {fastest:?}, more than twice its budget\n{report}"
        );
    }
    let neighbour = bench.status("neighbour").await;
    assert_eq!(neighbour.faults, 0, "{neighbour:?}");
    bench.stop().await;
}

/// Its time would suffice: the memory is what ends it. An engine may end its process then; that is no crash.
pub async fn a_full_memory_is_said_and_disturbs_nobody(worker: &Worker) {
    let mut bench = Bench::start(worker, |config| {
        config.call_budget_ms = 20_000;
        config.address_space_bytes = 256 << 20;
    });
    let counting = "(v, ctx) => { ctx.state = (ctx.state ?? 0) + 1; return ctx.state * 1000 + v }";
    bench.put_script("neighbour", &["a"], "Double", counting).await;
    assert_eq!(bench.ask("neighbour", 7_i32).await.value, 1007.0.into());
    let filling = "(v) => { const a = []; while (v) a.push(new Array(1e6).fill(1)); return 1 }";
    bench.put_script("full", &["a"], "Double", filling).await;
    let value = bench.ask("full", 1_i32).await;
    let status = bench.status("full").await;
    let fault = status.last_fault.unwrap_or_else(|| panic!("{value:?}"));
    assert_eq!(fault.kind, K::ScriptOutOfMemory, "{fault:?}");
    assert_eq!(status.circuit, CircuitState::Closed, "once is not enough");
    assert_eq!(bench.ask("full", 0_i32).await.value, 1.0.into(), "it starts again");
    assert_eq!(bench.ask("neighbour", 7_i32).await.value, 2007.0.into());
    bench.stop().await;
}

/// Share of a processor that a thread gets while a script runs. Budgets are computing time: on a
/// busy machine wall clock times must be read with it.
struct Share {
    stop: Arc<AtomicBool>,
    thread: thread::JoinHandle<f64>,
}

impl Share {
    fn measure() -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        let thread = thread::spawn(move || {
            let (begun, computed) = (Instant::now(), computing_time());
            while !stopped.load(Ordering::Relaxed) {
                std::hint::spin_loop();
            }
            let share = (computing_time() - computed).as_secs_f64() / begun.elapsed().as_secs_f64();
            share.clamp(0.01, 1.0)
        });
        Self { stop, thread }
    }

    /// 1 on an idle machine.
    fn end(self) -> f64 {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.join().expect("it only spins")
    }
}

/// The computing time of this thread.
fn computing_time() -> Duration {
    let line = fs::read_to_string("/proc/thread-self/schedstat").expect("a /proc");
    let nanos = line.split_whitespace().next().and_then(|first| first.parse().ok());
    Duration::from_nanos(nanos.expect("the first number is the computing time"))
}
