//! Logs on stderr and metrics for Prometheus.

use std::{
    sync::{Arc, OnceLock},
    time::Duration,
};

use metrics_exporter_prometheus::{PrometheusBuilder, PrometheusHandle};
use parking_lot::Mutex;
use serde::{Deserialize, Serialize};
use tokio_util::sync::CancellationToken;
use tracing_subscriber::{EnvFilter, Layer, layer::SubscriberExt, util::SubscriberInitExt};

/// Format and level of the log.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LogConfig {
    /// Lines for people or JSON for collectors.
    pub format: LogFormat,
    /// Directives of `tracing`: a level, or `target=level` pairs parted by commas.
    pub filter: String,
}

impl Default for LogConfig {
    fn default() -> Self {
        Self { format: LogFormat::Text, filter: "info".to_owned() }
    }
}

/// The form of a log line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LogFormat {
    /// One line for people.
    Text,
    /// One JSON object per line.
    Json,
}

/// Telemetry could not be set up.
#[derive(Debug, thiserror::Error)]
pub enum TelemetryError {
    /// The filter's directives are wrong.
    #[error(
        "the log filter {filter:?} is not understood; use a level as `info` or pairs as `platform=debug,info`"
    )]
    ParseFilter {
        /// The filter as given.
        filter: String,
        source: tracing_subscriber::filter::ParseError,
    },
    /// A subscriber or recorder is installed already.
    #[error("logging is set up already in this process")]
    InstallLogs(#[source] tracing_subscriber::util::TryInitError),
    /// The metrics recorder could not be installed.
    #[error("cannot install the metrics recorder")]
    InstallMetrics(#[source] metrics_exporter_prometheus::BuildError),
}

/// Begins to log to stderr.
///
/// # Errors
/// [`TelemetryError`] when the filter is wrong or logging is set up already.
pub fn install_logs(config: &LogConfig) -> Result<(), TelemetryError> {
    let filter = EnvFilter::try_new(&config.filter)
        .map_err(|source| TelemetryError::ParseFilter { filter: config.filter.clone(), source })?;
    let layer = tracing_subscriber::fmt::layer().with_writer(std::io::stderr);
    let layer = match config.format {
        LogFormat::Text => {
            layer.with_ansi(std::io::IsTerminal::is_terminal(&std::io::stderr())).boxed()
        }
        LogFormat::Json => layer.json().flatten_event(true).boxed(),
    };
    tracing_subscriber::registry()
        .with(layer.with_filter(filter))
        .try_init()
        .map_err(TelemetryError::InstallLogs)
}

/// Buckets of every histogram in seconds, from a tenth of a millisecond to a minute.
const BUCKETS_SECONDS: [f64; 14] =
    [0.000_1, 0.000_5, 0.001, 0.002_5, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 1.0, 5.0, 15.0, 60.0];

/// Pause between drains of the histograms, which otherwise grow until the next scrape.
const UPKEEP_INTERVAL: Duration = Duration::from_secs(5);

/// The process's metrics, ready to be scraped.
#[derive(Clone)]
pub struct Metrics {
    recorder: PrometheusHandle,
    /// Metrics of other processes of the daemon, in the text format.
    others: Arc<Mutex<Vec<Arc<Mutex<String>>>>>,
}

impl Metrics {
    /// The recorder of this process, installed at the first call. The `metrics` facade allows one
    /// per process, so this is the one place with a static.
    ///
    /// # Errors
    /// [`TelemetryError::InstallMetrics`] when another recorder is installed.
    pub fn install() -> Result<Self, TelemetryError> {
        static RECORDER: OnceLock<PrometheusHandle> = OnceLock::new();
        static GUARD: Mutex<()> = Mutex::new(());
        let _one_at_a_time = GUARD.lock();
        if let Some(recorder) = RECORDER.get() {
            return Ok(Self { recorder: recorder.clone(), others: Arc::default() });
        }
        let handle = PrometheusBuilder::new()
            .set_buckets(&BUCKETS_SECONDS)
            .and_then(PrometheusBuilder::install_recorder)
            .map_err(TelemetryError::InstallMetrics)?;
        let recorder = RECORDER.get_or_init(|| handle).clone();
        Ok(Self { recorder, others: Arc::default() })
    }

    /// Shows the metrics of another process of this daemon, too, as they are in the text. Their names
    /// are not those of this process.
    pub fn include(&self, text: Arc<Mutex<String>>) {
        self.others.lock().push(text);
    }

    /// All metrics in the Prometheus text format.
    #[must_use]
    pub fn render(&self) -> String {
        let mut text = self.recorder.render();
        for other in self.others.lock().iter() {
            text.push_str(&other.lock());
        }
        text
    }

    /// Folds histograms from time to time, so that they do not grow without being scraped.
    pub async fn run(self, shutdown: CancellationToken) {
        let mut ticks = tokio::time::interval(UPKEEP_INTERVAL);
        while shutdown.run_until_cancelled(ticks.tick()).await.is_some() {
            self.recorder.run_upkeep();
        }
    }
}

impl std::fmt::Debug for Metrics {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Metrics")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_counted_is_rendered() {
        let metrics = Metrics::install().expect("the first recorder");
        metrics::counter!("verbund_test_total", "reason" => "why").increment(2);
        assert!(Metrics::install().is_ok(), "a second call gives the same recorder");
        assert!(
            metrics.render().contains("verbund_test_total{reason=\"why\"} 2"),
            "{}",
            metrics.render()
        );
    }

    #[test]
    fn a_wrong_filter_is_refused() {
        let config = LogConfig { filter: "platform=loud".into(), ..LogConfig::default() };
        assert!(matches!(install_logs(&config), Err(TelemetryError::ParseFilter { .. })));
    }
}
