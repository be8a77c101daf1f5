//! Refresh of conditions: the server is asked to name those that are active (OPC 10000-9 §5.5.7).

use std::{
    collections::BTreeSet,
    time::{Duration, Instant},
};

use opcua_stack::opcua::types::{CallMethodRequest, MethodId, ObjectTypeId, StatusCode};

use crate::{
    ShopFloorError,
    source::{connection::Connection, notification_sink::NotificationSink, record::SourceRecord},
};

/// Pause between two refreshes. A server whose queue overflows during each is not asked without end.
const PAUSE: Duration = Duration::from_secs(1);
/// Longest wait for the end of a refresh that the server accepted.
const END_MAX: Duration = Duration::from_secs(10);

/// Times of the refreshes of a session.
#[derive(Debug, Default)]
pub(super) struct ConditionRefresh {
    is_needed: bool,
    /// Time before which the server is not asked again.
    not_before: Option<Instant>,
    /// Time by which the server should have named all conditions.
    ends_by: Option<Instant>,
    /// The server does not know the method for single items (ConditionRefresh2), which is of version 1.03.
    is_of_subscriptions: bool,
}

impl ConditionRefresh {
    pub(super) fn need(&mut self) {
        self.is_needed = true;
    }

    /// Returns true once when it is time to ask the server.
    fn begin(&mut self, now: Instant) -> bool {
        let is_due = self.is_needed && self.not_before.is_none_or(|at| at <= now);
        if is_due {
            self.is_needed = false;
            self.not_before = Some(now + PAUSE);
        }
        is_due
    }

    /// Awaits the end. A refresh that is repeated because its events were lost has no later one.
    fn accepted(&mut self, now: Instant) {
        self.ends_by.get_or_insert(now + END_MAX);
    }

    fn ended(&mut self) {
        self.ends_by = None;
    }

    fn awaits_end(&self) -> bool {
        self.ends_by.is_some()
    }

    /// Returns true once when the server should have named all conditions.
    fn is_over(&mut self, now: Instant) -> bool {
        self.ends_by.take_if(|by| *by <= now).is_some()
    }
}

/// Answer of a server to the request to name its conditions.
enum Answer {
    Accepted,
    /// A refresh runs; the server is asked again after it.
    InProgress,
    Refused(StatusCode),
}

/// Server that is asked, and where its events go.
pub(super) struct ConditionSource<'a> {
    pub(super) record: &'a SourceRecord,
    pub(super) connection: &'a Connection,
    pub(super) sink: &'a NotificationSink,
}

impl ConditionRefresh {
    /// Asks the server for its conditions when that is needed and due; goes on without them where it does not name them.
    /// The items are those whose value follows from conditions, each with the id of its subscription.
    pub(super) async fn run(
        &mut self,
        source: &ConditionSource<'_>,
        items: impl Iterator<Item = (u32, u32)>,
    ) -> Result<(), ShopFloorError> {
        let now = Instant::now();
        if self.awaits_end() && !source.sink.awaits_conditions() {
            self.ended();
        }
        if self.is_over(now) {
            tracing::info!(source.id = %source.record.id,
                "A server accepted to name its active conditions and did not.");
            source.sink.give_up_refresh();
        }
        if !self.begin(now) {
            return Ok(());
        }
        let items: Vec<(u32, u32)> = items.collect();
        let (mut is_accepted, mut refusal) = (false, None);
        let mut subscriptions = BTreeSet::new();
        for (subscription, item_id) in items {
            let of_item = (!self.is_of_subscriptions).then_some(item_id);
            if of_item.is_none() && !subscriptions.insert(subscription) {
                continue;
            }
            let mut answer = source.ask(subscription, of_item).await?;
            if of_item.is_some() && matches!(answer, Answer::Refused(_)) {
                // All items of the subscription then hear of its conditions again.
                self.is_of_subscriptions = true;
                subscriptions.insert(subscription);
                answer = source.ask(subscription, None).await?;
            }
            match answer {
                Answer::Accepted => is_accepted = true,
                Answer::InProgress => {
                    // One that never ends is given up as one that was accepted.
                    is_accepted = true;
                    self.need();
                }
                Answer::Refused(status) => refusal = Some(status),
            }
        }
        if is_accepted {
            self.accepted(now);
        } else if let Some(status) = refusal {
            tracing::info!(source.id = %source.record.id, %status,
                "A server does not name the conditions that were active before.");
            source.sink.give_up_refresh();
        }
        Ok(())
    }
}

impl ConditionSource<'_> {
    /// Asks for the conditions of a subscription, or of one of its items.
    async fn ask(&self, subscription: u32, item_id: Option<u32>) -> Result<Answer, ShopFloorError> {
        let (method, arguments) = match item_id {
            Some(item_id) => (
                MethodId::ConditionType_ConditionRefresh2,
                vec![subscription.into(), item_id.into()],
            ),
            None => (MethodId::ConditionType_ConditionRefresh, vec![subscription.into()]),
        };
        let request = CallMethodRequest {
            object_id: ObjectTypeId::ConditionType.into(),
            method_id: method.into(),
            input_arguments: Some(arguments),
        };
        let call = self.connection.session().call(vec![request]);
        let status = match self.connection.request(call).await {
            Ok(answers) => {
                answers.first().map_or(StatusCode::BadUnexpectedError, |answer| answer.status_code)
            }
            Err(ShopFloorError::Refused { status }) => StatusCode::from(status.0),
            Err(error) => return Err(error),
        };
        Ok(match status {
            status if status.is_good() => Answer::Accepted,
            StatusCode::BadRefreshInProgress => Answer::InProgress,
            status => Answer::Refused(status),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refresh_is_asked_for_once_and_not_without_end() {
        let mut refresh = ConditionRefresh::default();
        let start = Instant::now();
        assert!(!refresh.begin(start), "not needed");
        refresh.need();
        refresh.need();
        assert!(refresh.begin(start));
        assert!(!refresh.begin(start + 2 * PAUSE), "it was answered");
        refresh.need();
        assert!(!refresh.begin(start + PAUSE / 2), "too soon");
        assert!(refresh.begin(start + PAUSE));
        refresh.accepted(start);
        refresh.accepted(start + END_MAX / 2);
        assert!(refresh.awaits_end() && !refresh.is_over(start + END_MAX / 2));
        assert!(refresh.is_over(start + END_MAX));
        assert!(!refresh.is_over(start + 2 * END_MAX), "said once");
        refresh.accepted(start);
        refresh.ended();
        assert!(!refresh.is_over(start + END_MAX));
    }
}
