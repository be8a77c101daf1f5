//! Samples of what the platform shows of the order, taken all the time.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
    time::{Duration, Instant},
};

use serde_json::Value;
use time::{OffsetDateTime, format_description::well_known::Rfc3339};
use tokio::task::JoinHandle;

use crate::{frame_order::NETWORK, harness::Api};

/// Time between two samples.
const EACH: Duration = Duration::from_millis(300);

/// One operation as the platform shows it.
#[derive(Debug, Clone, Default)]
pub(super) struct ShownOperation {
    /// State; empty where none is known.
    pub state: String,
    pub quantity: Option<f64>,
    pub scrap: Option<f64>,
    pub planned_quantity: f64,
    pub planned_end: Option<OffsetDateTime>,
    /// Seconds between the planned end and the expected one; 0 where none is expected.
    pub expected_late_s: i64,
    /// Age of its last report; none where there is none.
    pub silence: Option<time::Duration>,
}

/// The network at one moment.
#[derive(Debug, Clone)]
pub(super) struct Sample {
    pub taken_at: Instant,
    pub revision: u64,
    /// Reason of an interruption, as the machine reports it.
    pub interrupted_by: String,
    pub operations: BTreeMap<String, ShownOperation>,
}

impl Sample {
    /// Returns an operation; one of which nothing is known where the network has none of this id.
    pub(super) fn of(&self, operation_id: &str) -> ShownOperation {
        self.operations.get(operation_id).cloned().unwrap_or_default()
    }

    fn read(view: &Value) -> Self {
        let list = |list: &Value| list.as_array().cloned().unwrap_or_default();
        let planned = list(&view["network"]["operationList"]);
        let operations = list(&view["operations"]).into_iter().map(|shown| {
            let id = shown["operationId"].as_str().unwrap_or_default().to_owned();
            let plan = planned.iter().find(|operation| operation["operationId"] == id.as_str());
            let planned_end = plan.and_then(|operation| moment(&operation["plannedEnd"]));
            let late = moment(&shown["expectedEnd"]).zip(planned_end);
            let operation = ShownOperation {
                state: shown["state"].as_str().unwrap_or_default().to_owned(),
                quantity: shown["quantity"].as_f64(),
                scrap: shown["scrapQuantity"].as_f64(),
                planned_quantity: shown["plannedQuantity"].as_f64().unwrap_or_default(),
                planned_end,
                expected_late_s: late.map_or(0, |(end, planned)| (end - planned).whole_seconds()),
                silence: moment(&shown["lastReportAt"]).map(|at| OffsetDateTime::now_utc() - at),
            };
            (id, operation)
        });
        let fields = list(&view["fields"]);
        let reason = fields.iter().find(|field| field["key"]["fieldName"] == "interruptedBy");
        Self {
            taken_at: Instant::now(),
            revision: view["revision"].as_u64().unwrap_or_default(),
            interrupted_by: reason
                .and_then(|field| field["value"].as_str())
                .unwrap_or_default()
                .to_owned(),
            operations: operations.collect(),
        }
    }
}

fn moment(time: &Value) -> Option<OffsetDateTime> {
    OffsetDateTime::parse(time.as_str()?, &Rfc3339).ok()
}

/// All samples so far; they end when it is dropped.
pub(super) struct Samples {
    taken: Arc<Mutex<Vec<Sample>>>,
    taking: JoinHandle<()>,
}

impl Samples {
    /// Takes samples from now on.
    pub(super) fn take(platform: Api) -> Self {
        let taken: Arc<Mutex<Vec<Sample>>> = Arc::default();
        let into = Arc::clone(&taken);
        let taking = tokio::spawn(async move {
            let mut ticks = tokio::time::interval(EACH);
            loop {
                ticks.tick().await;
                let path = format!("/api/v1/operation-networks/{NETWORK}");
                // A platform that does not answer now shows nothing.
                if let Ok(view) = platform.get::<Value>(&path).await {
                    let sample = Sample::read(&view);
                    into.lock().unwrap_or_else(PoisonError::into_inner).push(sample);
                }
            }
        });
        Self { taken, taking }
    }

    /// Returns the first sample that shows something.
    pub(super) fn find(&self, shows: &dyn Fn(&Sample) -> bool) -> Option<Sample> {
        let taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
        taken.iter().find(|sample| shows(sample)).cloned()
    }

    pub(super) fn last(&self) -> Option<Sample> {
        self.taken.lock().unwrap_or_else(PoisonError::into_inner).last().cloned()
    }

    pub(super) fn count(&self) -> usize {
        self.taken.lock().unwrap_or_else(PoisonError::into_inner).len()
    }
}

impl Drop for Samples {
    fn drop(&mut self) {
        self.taking.abort();
    }
}
