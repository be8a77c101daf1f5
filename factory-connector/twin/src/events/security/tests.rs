use metrics::{
    Counter, CounterFn, Gauge, Histogram, Key, KeyName, Metadata, Recorder, SharedString, Unit,
};
use parking_lot::Mutex;

use super::*;

/// Keeps what counters are asked for.
#[derive(Default)]
struct Counted(Mutex<Vec<String>>);

struct Ignored;

impl CounterFn for Ignored {
    fn increment(&self, _: u64) {}
    fn absolute(&self, _: u64) {}
}

impl Recorder for Counted {
    fn describe_counter(&self, _: KeyName, _: Option<Unit>, _: SharedString) {}
    fn describe_gauge(&self, _: KeyName, _: Option<Unit>, _: SharedString) {}
    fn describe_histogram(&self, _: KeyName, _: Option<Unit>, _: SharedString) {}

    fn register_counter(&self, key: &Key, _: &Metadata<'_>) -> Counter {
        let labels: Vec<String> =
            key.labels().map(|label| format!("{}={}", label.key(), label.value())).collect();
        self.0.lock().push(format!("{}{{{}}}", key.name(), labels.join(",")));
        Counter::from_arc(Arc::new(Ignored))
    }

    fn register_gauge(&self, _: &Key, _: &Metadata<'_>) -> Gauge {
        Gauge::noop()
    }

    fn register_histogram(&self, _: &Key, _: &Metadata<'_>) -> Histogram {
        Histogram::noop()
    }
}

#[test]
fn a_share_that_is_used_up_is_counted_with_its_client() {
    let audit = SessionAudit { events: Arc::default() };
    let counted = Counted::default();
    metrics::with_local_recorder(&counted, || {
        let vera = ClientKey::User("viewer:vera".to_owned());
        audit.share_exhausted(Some(&vera), SharedResource::Sessions);
        audit.share_exhausted(Some(&ClientKey::Address(None)), SharedResource::RequestBytes);
        audit.share_exhausted(None, SharedResource::QueuedValues);
    });
    assert_eq!(
        *counted.0.lock(),
        [
            "twin_client_shares_exhausted_total{client=vera,resource=sessions}",
            "twin_client_shares_exhausted_total{client=anonymous,resource=request_bytes}",
            "twin_client_shares_exhausted_total{client=,resource=queued_values}",
        ]
    );
}
