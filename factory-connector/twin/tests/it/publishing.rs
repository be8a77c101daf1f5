//! Notifications: what they have in them, and their order.

use std::time::Duration;

use opcua_stack::opcua::types::{
    AttributeId, DataChangeNotification, EventFilter, ExtensionObject, MonitoredItemCreateRequest,
    MonitoringMode, MonitoringParameters, NodeId, ObjectId, ObjectTypeId, ReadValueId,
    SimpleAttributeOperand,
};

use crate::{
    harness::{TestTwin, document, instance, message},
    raw_session::RawSession,
};

async fn twin() -> TestTwin {
    let twin =
        TestTwin::start_with(|config| config.security.allow_anonymous_unencrypted = true).await;
    twin.handle.apply(document(message("net", 1)));
    twin
}

fn item(
    node_id: NodeId,
    attribute: AttributeId,
    filter: ExtensionObject,
) -> MonitoredItemCreateRequest {
    MonitoredItemCreateRequest {
        item_to_monitor: ReadValueId {
            node_id,
            attribute_id: attribute as u32,
            ..ReadValueId::default()
        },
        monitoring_mode: MonitoringMode::Reporting,
        requested_parameters: MonitoringParameters {
            client_handle: 1,
            filter,
            queue_size: 10,
            ..MonitoringParameters::default()
        },
    }
}

#[tokio::test]
async fn the_subscription_of_the_highest_priority_is_served_first() {
    let twin = twin().await;
    let mut session = RawSession::sign_in(&twin).await;
    for (low, high) in [(1, 200), (200, 1)] {
        let mut subscriptions = Vec::new();
        for priority in [low, high] {
            let subscription = session.subscribe(priority).await;
            let value = item(instance("net#Revision"), AttributeId::Value, ExtensionObject::null());
            session.monitor(subscription, value).await;
            subscriptions.push((priority, subscription));
        }
        // Both are late, so that one request decides between them.
        tokio::time::sleep(Duration::from_millis(500)).await;
        let first = session.publish().await.subscription_id;
        subscriptions.sort_unstable();
        assert_eq!(first, subscriptions[1].1, "of {subscriptions:?}");
        session = RawSession::sign_in(&twin).await;
    }
    twin.stop().await;
}

#[tokio::test]
async fn who_waits_for_events_gets_no_value_before_the_first() {
    let twin = twin().await;
    let mut session = RawSession::sign_in(&twin).await;
    let subscription = session.subscribe(0).await;
    let filter = ExtensionObject::from_message(EventFilter {
        select_clauses: Some(vec![SimpleAttributeOperand {
            type_definition_id: ObjectTypeId::BaseEventType.into(),
            browse_path: Some(vec!["Message".into()]),
            attribute_id: AttributeId::Value as u32,
            ..SimpleAttributeOperand::default()
        }]),
        ..EventFilter::default()
    });
    session
        .monitor(subscription, item(ObjectId::Server.into(), AttributeId::EventNotifier, filter))
        .await;
    for _ in 0..2 {
        let message = session.publish().await.notification_message;
        let data: Vec<_> = message.notification_data.into_iter().flatten().collect();
        let values = data.iter().filter(|data| data.inner_is::<DataChangeNotification>());
        assert_eq!(values.count(), 0, "{data:?}");
    }
    twin.stop().await;
}
