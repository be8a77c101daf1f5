//! State, restarts, rests, checks and load.

use std::os::unix::fs::PermissionsExt as _;

use asi_model::{DataValue, DateTime, StatusCode, Variant};
use mapping_engine::{
    CircuitState, DiagnosticCode, DryRunSample, FaultKind, MappingHealth, MappingStatus,
    PublishRequest, ScriptRuntime, Severity, TransformState,
};

use testkit::wait::eventually;

use super::bench::{Bench, PATIENCE, Worker, mapping_id, published, script_mapping};

/// Takes its worker down: no engine stops each of its native functions. V8 refuses the first one.
const FATAL: &str = "(v) => { if (v) { try { new Array(1e9) + '' } catch {} [].indexOf.call({ length: 2 ** 53 - 1 }, 1) } \
                     return 1 }";
const COUNTING: &str = "(v, ctx) => { const s = ctx.state ?? { n: 0, big: 1n << 60n }; s.n += v; s.big += 1n; \
                        ctx.state = s; return s.n }";

pub async fn state_survives_the_worker(worker: &Worker) {
    let mut bench = Bench::start(worker, |config| config.call_budget_ms = 100);
    bench.put_script("count", &["a", "b"], "Double", COUNTING).await;
    bench.put_script("fatal", &["a"], "Double", FATAL).await;
    bench.feed("count", "b", 0_i32).await;
    assert_eq!(bench.ask("count", 5_i32).await.value, 5.0.into());
    let value = bench.ask("fatal", 1_i32).await;
    assert_eq!(value.status.0 >> 30, 2);
    // The worker is a new one; state and inputs were given to it.
    let candidate = {
        bench.feed("count", "a", 2_i32).await;
        bench.next("count").await
    };
    assert_eq!(candidate.value.value, 7.0.into());
    // The state that came with the candidate is what a restarted connector gives back.
    let stored =
        serde_json::to_string(&candidate.state.expect("the script has state")).expect("serialises");
    bench.stop().await;

    let state: TransformState = serde_json::from_str(&stored).expect("reads back");
    let mut bench = Bench::start(worker, |_| {});
    let mapping = script_mapping("count", &["a", "b"], "Double", COUNTING);
    let last = Some(candidate.value);
    bench
        .publish(PublishRequest { state: Some(state), last: last.clone(), ..published(mapping) })
        .await;
    // Until the source speaks, the last value stands.
    bench
        .feed_value("count", "a", DataValue::status_only(StatusCode::BAD_NOT_CONNECTED, None))
        .await;
    let shown = bench.next("count").await.value;
    assert_eq!(shown.status, StatusCode::UNCERTAIN_NO_COMMUNICATION_LAST_USABLE_VALUE);
    assert_eq!(shown.source_timestamp, last.and_then(|last| last.source_timestamp));
    bench.feed("count", "b", 0_i32).await;
    assert_eq!(bench.ask("count", 3_i32).await.value, 10.0.into());
    bench.stop().await;
}

pub async fn scripts_rest_and_are_reset_by_hand(worker: &Worker) {
    let mut bench = Bench::start(worker, |config| {
        config.call_budget_ms = 50;
        config.exhausted_in_a_row_max = 3;
        config.rest_s = 3600;
    });
    bench.put_script("slow", &["a"], "Double", "(v) => { while (v) {} return 1 }").await;
    for _ in 0..3 {
        assert_eq!(bench.ask("slow", 1_i32).await.status, StatusCode::BAD_TIMEOUT);
    }
    let status = bench.status("slow").await;
    assert!(matches!(status.circuit, CircuitState::Open { .. }), "{status:?}");
    assert_eq!(bench.health("slow").await, MappingHealth::CircuitOpen);
    bench.feed("slow", "a", 0_i32).await;
    let paused = bench.until("slow", |status| status.superseded == 1).await;
    assert_eq!(paused.yielded, 3, "a script is not run while its circuit is open");
    assert!(bench.handle.reset(&mapping_id("slow")).await.expect("the engine runs"));
    assert_eq!(bench.ask("slow", 0_i32).await.value, 1.0.into());
    assert_eq!(bench.status("slow").await.circuit, CircuitState::Closed);
    assert_eq!(bench.health("slow").await, MappingHealth::Well);

    bench.put_script("fatal", &["a"], "Double", FATAL).await;
    bench.ask("fatal", 1_i32).await;
    let status = bench.status("fatal").await;
    let is_open = matches!(status.circuit, CircuitState::Open { .. });
    // Where each limit ends the process, this end is one of those that are counted.
    let is_enough = worker.engine == ScriptRuntime::QuickJs;
    assert_eq!(is_open, is_enough, "once is enough: {status:?}");
    bench.stop().await;
}

pub async fn checks_and_dry_runs_show_everything(worker: &Worker) {
    let bench = Bench::start(worker, |config| config.call_budget_ms = 100);
    for (source, code, line) in [
        ("(v) =>\n  v +* 2", DiagnosticCode::Syntax, Some(2)),
        ("'no function'", DiagnosticCode::ScriptFault, None),
        ("for (;;) {}", DiagnosticCode::ScriptFault, None),
        ("new Array(1e9) + ''; (v) => v", DiagnosticCode::ScriptFault, None),
    ] {
        let found = bench
            .handle
            .check(script_mapping("m", &["a"], "Double", source))
            .await
            .expect("the engine runs");
        let error = found
            .iter()
            .find(|d| d.severity == Severity::Error)
            .unwrap_or_else(|| panic!("{source}"));
        assert_eq!(
            (error.code, error.pointer.as_str()),
            (code, "/steps/0/source"),
            "{source}: {error:?}"
        );
        assert!(line.is_none() || error.line == line, "{source}: {error:?}");
    }
    let closure = script_mapping("m", &["a"], "Double", "let n = 0;\n(v) => n += v");
    let found = bench.handle.check(closure).await.expect("the engine runs");
    assert_eq!(found.iter().map(|d| d.code).collect::<Vec<_>>(), [DiagnosticCode::ClosureState]);

    let mut mapping = script_mapping(
        "m",
        &["a"],
        "Int32",
        "(v, ctx) => { ctx.state = (ctx.state ?? 0) + Number(v); return ctx.state }",
    );
    let steps = serde_json::json!([
        { "function": "scale", "factor": 10 },
        mapping.steps[0],
        { "function": "debounce", "quietMs": 500 },
        { "function": "expression", "expression": "value / 20 + 1" },
    ]);
    mapping.steps = serde_json::from_value(steps).expect("steps");
    let at = |seconds: i64| DateTime::from_unix_micros(1_600_000_000_000_000 + seconds * 1_000_000);
    let samples = [1_i32, 2, 3].into_iter().zip(0_i64..).map(|(value, index)| DryRunSample {
        input: "a".to_owned(),
        at: at(index),
        value: DataValue::good(value, at(index)),
    });
    let trace = bench.dry_run(mapping, samples.collect(), None).await;
    assert!(trace.diagnostics.iter().all(|d| !d.is_error()), "{trace:?}");
    let plain = |run: &mapping_engine::TraceRun| {
        let values = run
            .steps
            .iter()
            .map(|step| step.value.as_ref().map_or("-".into(), |v| v.value.to_string()));
        let values: Vec<String> = values.collect();
        let outcome = match (&run.candidate, &run.fault) {
            (_, Some(fault)) => format!("{:?}", fault.kind),
            (Some(candidate), None) => candidate.value.to_string(),
            (None, None) => "silence".to_owned(),
        };
        format!("{} = {outcome}", values.join(" "))
    };
    let runs: Vec<String> = trace.runs.iter().map(plain).collect();
    assert_eq!(
        runs,
        [
            "\"10\" 10.0 - = silence",
            "10.0 1.5 = OutOfRange",
            "\"20\" 30.0 - = silence",
            "30.0 2.5 = OutOfRange",
            "\"30\" 60.0 - = silence",
            "60.0 4.0 = 4",
        ]
    );
    bench.stop().await;
}

pub async fn values_keep_their_order_under_load(worker: &Worker) {
    let mut bench = Bench::start(worker, |_| {});
    let scripts = 20_usize;
    let values = 50_i32;
    for index in 0..scripts {
        let id = format!("m{index}");
        bench
            .put_script(&id, &["a"], "Double", "(v, ctx) => { ctx.state = v; return v + 0.5 }")
            .await;
    }
    for index in 0..scripts {
        bench.feed_all(&format!("m{index}"), "a", (0..values).map(Variant::from)).await;
    }
    for index in 0..scripts {
        for value in 0..values {
            let candidate = bench.next(&format!("m{index}")).await;
            assert_eq!(candidate.value.value, (f64::from(value) + 0.5).into());
        }
    }
    // More than may wait: the newest wins, and that is counted.
    bench.put_script("flood", &["a"], "Double", "(v) => v").await;
    bench.feed_all("flood", "a", (0..5000).map(Variant::from)).await;
    let mut last = -1.0;
    while last < 4999.0 {
        let value = bench.next("flood").await.value.value.as_f64().expect("a number");
        assert!(value > last, "{value} after {last}");
        last = value;
    }
    let status = bench.status("flood").await;
    assert_eq!(status.superseded + status.yielded, 5000, "{status:?}");
    bench.stop().await;
}

/// Programs that are no workers: each is a diagnostic, and the engine lives.
pub async fn a_broken_worker_is_a_diagnostic(worker: &Worker) {
    let folder = tempfile::tempdir().expect("a folder");
    // As root, workers run as another user.
    let open = std::fs::Permissions::from_mode(0o755);
    std::fs::set_permissions(folder.path(), open).expect("ours");
    let programs = [
        ("ends", "#!/bin/sh\nexit 0\n"),
        ("echoes", "#!/bin/sh\nexec /bin/cat\n"),
        ("babbles", "#!/bin/sh\nwhile :; do echo nonsense; done\n"),
    ];
    for (name, program) in programs {
        let path = folder.path().join(name);
        std::fs::write(&path, program).expect("a file");
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755))
            .expect("executable");
        let broken = Worker { path, ..worker.clone() };
        diagnosed(&broken).await;
    }
    diagnosed(&Worker { path: folder.path().join("absent"), ..worker.clone() }).await;
}

async fn diagnosed(worker: &Worker) {
    let mut bench = Bench::start(worker, |_| {});
    bench.put_script("m", &["a"], "Double", "(v) => v").await;
    let value = bench.next("m").await.value;
    assert_eq!(value.status, StatusCode::BAD_OUT_OF_SERVICE, "{worker:?}");
    let fault = bench.status("m").await.last_fault.expect("a fault");
    assert_eq!(fault.kind, FaultKind::WorkerUnavailable, "{fault:?}");
    let found = bench
        .handle
        .check(script_mapping("m", &["a"], "Double", "(v) => v"))
        .await
        .expect("the engine runs");
    assert_eq!(
        found.iter().map(|d| d.code).collect::<Vec<_>>(),
        [DiagnosticCode::WorkerUnavailable]
    );
    bench.stop().await;
}

impl Bench {
    /// Gives an input a value with a status and time of its own.
    async fn feed_value(&mut self, id: &str, input: &str, value: DataValue) {
        self.send(id, input, vec![value]).await;
    }

    /// Polls the status until something holds.
    async fn until(&self, id: &str, holds: impl Fn(&MappingStatus) -> bool) -> MappingStatus {
        let status = eventually("a status of the mapping", PATIENCE, || async {
            let status = self.status(id).await;
            if holds(&status) { Ok(status) } else { Err(format!("{status:?}")) }
        });
        status.await.unwrap_or_else(|error| panic!("{error}"))
    }
}
