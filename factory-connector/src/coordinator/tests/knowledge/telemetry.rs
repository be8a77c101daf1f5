//! Log and metrics of a plant while it does something.

use std::{fmt, sync::Arc};

use metrics::{
    Counter, CounterFn, Gauge, GaugeFn, Histogram, HistogramFn, Key, KeyName, Metadata, Recorder,
    SharedString, Unit,
};
use parking_lot::Mutex;
use tracing::{
    Event, Subscriber,
    field::{Field, Visit},
    span,
};

/// Lines of log and metrics; clones share them.
#[derive(Clone, Default)]
pub(super) struct RecordedTelemetry(Arc<Mutex<Vec<String>>>);

impl RecordedTelemetry {
    /// Takes the lines since the last call.
    pub(super) fn take(&self) -> Vec<String> {
        std::mem::take(&mut self.0.lock())
    }

    fn metric(&self, key: &Key) -> Arc<Metric> {
        Arc::new(Metric { key: key.clone(), telemetry: self.clone() })
    }
}

impl Subscriber for RecordedTelemetry {
    fn enabled(&self, metadata: &tracing::Metadata<'_>) -> bool {
        // All that the daemon can be told to print, at each level; libraries tell how long statements
        // and requests take.
        const OWN: [&str; 14] = [
            "asi_model",
            "connector_state",
            "daemon",
            "disclosure",
            "factory_connector",
            "ledger",
            "mapping",
            "mapping_engine",
            "messaging",
            "opcua_stack",
            "shop_floor",
            "spool",
            "transparency_log",
            "twin",
        ];
        OWN.contains(&metadata.target().split("::").next().unwrap_or_default())
    }

    fn new_span(&self, span: &span::Attributes<'_>) -> span::Id {
        let mut line = Line(format!("span {}", span.metadata().name()));
        span.record(&mut line);
        self.0.lock().push(line.0);
        span::Id::from_u64(1)
    }

    fn record(&self, _: &span::Id, values: &span::Record<'_>) {
        let mut line = Line("span".to_owned());
        values.record(&mut line);
        self.0.lock().push(line.0);
    }

    fn record_follows_from(&self, _: &span::Id, _: &span::Id) {}

    fn event(&self, event: &Event<'_>) {
        let mut line = Line(format!("log {}", event.metadata().level()));
        event.record(&mut line);
        self.0.lock().push(line.0);
    }

    fn enter(&self, _: &span::Id) {}

    fn exit(&self, _: &span::Id) {}
}

/// A line of the log.
struct Line(String);

impl Visit for Line {
    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        self.0 += &format!(" {field}={value:?}");
    }
}

impl Recorder for RecordedTelemetry {
    fn describe_counter(&self, _: KeyName, _: Option<Unit>, _: SharedString) {}

    fn describe_gauge(&self, _: KeyName, _: Option<Unit>, _: SharedString) {}

    fn describe_histogram(&self, _: KeyName, _: Option<Unit>, _: SharedString) {}

    fn register_counter(&self, key: &Key, _: &Metadata<'_>) -> Counter {
        Counter::from_arc(self.metric(key))
    }

    fn register_gauge(&self, key: &Key, _: &Metadata<'_>) -> Gauge {
        Gauge::from_arc(self.metric(key))
    }

    fn register_histogram(&self, key: &Key, _: &Metadata<'_>) -> Histogram {
        Histogram::from_arc(self.metric(key))
    }
}

/// A metric that tells each of its changes.
struct Metric {
    key: Key,
    telemetry: RecordedTelemetry,
}

impl Metric {
    fn emit(&self, change: impl fmt::Display) {
        self.telemetry.0.lock().push(format!("metric {} {change}", self.key));
    }
}

impl CounterFn for Metric {
    fn increment(&self, value: u64) {
        self.emit(format_args!("+{value}"));
    }

    fn absolute(&self, value: u64) {
        self.emit(value);
    }
}

impl GaugeFn for Metric {
    fn increment(&self, value: f64) {
        self.emit(format_args!("+{value}"));
    }

    fn decrement(&self, value: f64) {
        self.emit(format_args!("-{value}"));
    }

    fn set(&self, value: f64) {
        self.emit(value);
    }
}

impl HistogramFn for Metric {
    fn record(&self, _: f64) {
        // Durations differ from run to run.
        self.emit("a duration");
    }
}
