//! Answers to callers: of a failed use case at once, of others once they are committed.

use connector_state::use_cases::decide::DecisionError;

use super::*;

/// A value waits for the publishing interval. A use case that failed has nothing to wait for: its
/// caller hears the error before what was asked earlier is committed, and nothing was changed.
#[tokio::test]
async fn the_caller_of_a_failed_use_case_hears_it_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let long = Duration::from_secs(3600);
    let running = Running::open_with(folder.path().to_owned(), Some(folder), long).await;
    running.receive("operation-network", network(1)).await;
    running.open_fields().await;
    let last_row = || running.coordinator.read(ConnectorState::last_row);
    let before = last_row().await.expect("read");

    let (answers, mut answered) = mpsc::unbounded_channel();
    let value = DataValue::good(7_u64, now());
    let written = async {
        let source = ValueSource::Manual;
        let written = running.coordinator.write_value(field("made"), source, value).await;
        assert!(matches!(written, Ok(WriteOutcome::Accepted(_))), "{written:?}");
        answers.send("written").expect("heard");
    };
    let failed = async {
        let command = DecisionCommand::Refuse;
        let (decided_by, basis) = ("eve".to_owned(), DecisionBasis::default());
        let request = DecisionRequest { command, reason: None, decided_by, basis, preview: None };
        let key = field("made");
        let refused =
            running.coordinator.execute(move |state, now| decide(state, &key, request, now)).await;
        assert_eq!(refused, Ok(Err(DecisionError::NoReason)));
        assert_eq!(last_row().await, Ok(before), "nothing is queued");
        answers.send("failed").expect("heard");
    };
    tokio::join!(written, failed);
    assert_eq!(answered.recv().await, Some("failed"));
    assert_eq!(answered.recv().await, Some("written"));
    let is_mapped = running
        .coordinator
        .read(|state| state.field(&field("made")).is_some_and(|field| field.decision().is_mapped()))
        .await;
    assert_eq!(is_mapped, Ok(true), "the decision is as it was");
    running.close().await;
}
