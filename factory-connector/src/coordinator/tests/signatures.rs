//! Signatures of what leaves.

use message_signature::verify;
use serde_json::Value;

use super::*;

/// Reports and all kinds of control messages, signed with the properties that their bodies have and
/// with the lease under which they leave.
#[tokio::test]
async fn all_that_leaves_is_signed() {
    let running = Running::open().await;
    running.receive("operation-network", network(1)).await;
    running.open_fields().await;
    running.enter_both(1).await;
    let mut rows = running.fetch(Lane::Reports).await;
    running.accept(&rows).await;
    running.revoke(Some("Enough.")).await;
    rows.extend(running.fetch(Lane::Control).await);
    assert!(rows.len() > 4, "{} messages", rows.len());
    let mut keys = std::collections::BTreeSet::new();
    for row in rows {
        let mut envelope = row.envelope;
        running.spool.sign(&mut envelope);
        let signature = envelope.signature.expect("signed");
        let signed = verify(&signature, &envelope.body).expect("it holds");
        keys.insert(signed.key.to_string());
        let body: Value = serde_json::from_slice(&envelope.body).expect("JSON");
        let member = |own: &str, pub_sub: &str| {
            body[own].as_str().or(body[pub_sub].as_str()).map(str::to_owned)
        };
        let properties = signed.properties;
        assert_eq!(properties.factory_id.as_str(), "F");
        assert_eq!(member("messageType", "MessageType"), Some(properties.subject));
        assert_eq!(member("messageId", "MessageId"), Some(properties.message_id.to_string()));
        assert_eq!(properties.lease, Some(1));
    }
    assert_eq!(keys.len(), 1, "{keys:?}");
}
