//! Session expiry, timeouts and defaults of MQTT connections.

use std::time::Duration;

use rumqttc::v5::mqttbytes::v5::ConnAckProperties;

/// Time for which a broker retains the session of a disconnected client.
pub(super) const SESSION_EXPIRY: Duration = Duration::from_secs(7 * 24 * 3600);
/// Time limit of a close.
pub(super) const CLOSE_TIMEOUT: Duration = Duration::from_secs(2);

/// The properties of a broker that grants the defaults of MQTT 5.
pub(super) fn no_properties() -> ConnAckProperties {
    ConnAckProperties {
        session_expiry_interval: None,
        receive_max: None,
        max_qos: None,
        retain_available: None,
        max_packet_size: None,
        assigned_client_identifier: None,
        topic_alias_max: None,
        reason_string: None,
        user_properties: Vec::new(),
        wildcard_subscription_available: None,
        subscription_identifiers_available: None,
        shared_subscription_available: None,
        server_keep_alive: None,
        response_information: None,
        server_reference: None,
        authentication_method: None,
        authentication_data: None,
    }
}
