//! Audit trail of access: secure channels, sessions, certificates and the trust list.

use std::sync::{Arc, OnceLock};

use opcua_stack::opcua::{
    crypto::X509,
    server::{
        ChannelDescription, ClientKey, SessionEvent, SessionObserver, SharedResource,
        authenticator::UserToken,
    },
    types::{
        ByteString, ExtensionObject, NodeId, ObjectTypeId, SecurityTokenRequestType, StatusCode,
        UAString, UserNameIdentityToken, Variant,
    },
};

use super::{EventReporter, ServerEvent};
use crate::{certificate_error::CertificateError, session_token::user_of};

/// Longest name of a user or session in an event, in bytes: clients may send any text.
const NAME_BYTES_MAX: usize = 256;

/// ClientUserIds of OPC 10000-4 §6.5.3 for events without a user.
mod system {
    pub const OPEN_SECURE_CHANNEL: &str = "System/OpenSecureChannel";
    pub const CREATE_SESSION: &str = "System/CreateSession";
    pub const UPDATE_CERTIFICATE: &str = "System/UpdateCertificate";
}

/// Reports channels and sessions to the subscribers of the Server object.
pub(crate) struct SessionAudit {
    /// Set once the server is built.
    pub events: Arc<OnceLock<Arc<EventReporter>>>,
}

impl SessionObserver for SessionAudit {
    fn observe(&self, channel: &ChannelDescription, event: SessionEvent, outcome: StatusCode) {
        let Some(events) = self.events.get() else { return };
        match &event {
            SessionEvent::SessionActivated { session_id, .. } if outcome.is_good() => {
                events.sessions.activated(session_id);
            }
            SessionEvent::SessionClosed { session_id, .. } => events.sessions.ended(session_id),
            _ => {}
        }
        if events.has_subscribers() {
            events.send(&events.session_event(channel, event, outcome));
        }
    }

    fn session_expired(&self, session_id: NodeId, user_token: Option<UserToken>) {
        let Some(events) = self.events.get() else { return };
        events.sessions.ended(&session_id);
        if events.has_subscribers() {
            let message = "A session ended because its client was silent for too long.".to_owned();
            events.send(&events.session_ended(
                "Session/Timeout",
                session_id,
                user_token,
                StatusCode::Good,
                message,
            ));
        }
    }

    fn share_exhausted(&self, client: Option<&ClientKey>, resource: SharedResource) {
        let client = match client {
            Some(ClientKey::User(token)) => user_of(&UserToken(token.clone())).name.to_string(),
            Some(ClientKey::Certificate(thumbprint)) => thumbprint.clone(),
            Some(ClientKey::Address(_)) => "anonymous".to_owned(),
            // All together, as other metrics of shares say it.
            None => String::new(),
        };
        let resource = resource.name();
        // No line for each: clients may ask again and again.
        tracing::debug!(client, resource, "A share of the twin's clients is used up.");
        metrics::counter!("twin_client_shares_exhausted_total", "client" => client, "resource" => resource)
            .increment(1);
    }
}

impl EventReporter {
    fn session_event(
        &self,
        channel: &ChannelDescription,
        event: SessionEvent,
        outcome: StatusCode,
    ) -> ServerEvent {
        match event {
            SessionEvent::ChannelOpened { request_type, requested_lifetime } => {
                self.channel_opened(channel, request_type, requested_lifetime, outcome)
            }
            SessionEvent::SessionCreated { session_id, session_name, revised_timeout } => {
                let message = format!("The session {} was asked for.", shortened(&session_name));
                let event_type = ObjectTypeId::AuditCreateSessionEventType;
                let mut event = self.audit(event_type, system::CREATE_SESSION, outcome, message);
                event.set("SourceName", "Session/CreateSession");
                event.set("SessionId", session_id);
                set_channel(&mut event, channel);
                event.set("RevisedSessionTimeout", revised_timeout);
                event
            }
            SessionEvent::SessionActivated { session_id, user_identity_token } => {
                self.session_activated(channel, session_id, &user_identity_token, outcome)
            }
            SessionEvent::SessionClosed { session_id, user_token } => {
                let message = "A client closed its session.".to_owned();
                self.session_ended("Session/CloseSession", session_id, user_token, outcome, message)
            }
        }
    }

    /// Builds an AuditSessionEventType (OPC 10000-5 §6.4.7) with the sources of OPC 10000-4 §6.5.5.
    fn session_ended(
        &self,
        source: &str,
        session_id: NodeId,
        user_token: Option<UserToken>,
        outcome: StatusCode,
        message: String,
    ) -> ServerEvent {
        let user = user_token.map(|token| user_of(&token).name);
        let user = user.as_deref().unwrap_or_default();
        let mut event = self.audit(ObjectTypeId::AuditSessionEventType, user, outcome, message);
        event.set("SourceName", source);
        event.set("SessionId", session_id);
        event
    }

    /// Builds an AuditOpenSecureChannelEventType (OPC 10000-5 §6.4.6).
    fn channel_opened(
        &self,
        channel: &ChannelDescription,
        request_type: Option<SecurityTokenRequestType>,
        requested_lifetime: u32,
        outcome: StatusCode,
    ) -> ServerEvent {
        let message = match (outcome.is_good(), request_type) {
            (false, _) => "A secure channel was not opened.",
            (true, Some(SecurityTokenRequestType::Renew)) => "A secure channel was renewed.",
            (true, _) => "A secure channel was opened.",
        };
        let event_type = ObjectTypeId::AuditOpenSecureChannelEventType;
        let mut event =
            self.audit(event_type, system::OPEN_SECURE_CHANNEL, outcome, message.to_owned());
        event.set("SourceName", "SecureChannel/OpenSecureChannel");
        set_channel(&mut event, channel);
        event.set("RequestType", request_type.unwrap_or(SecurityTokenRequestType::Issue) as i32);
        event.set("SecurityPolicyUri", channel.security_policy.to_uri());
        event.set("SecurityMode", channel.security_mode as i32);
        event.set("RequestedLifetime", f64::from(requested_lifetime));
        event
    }

    /// Builds an AuditActivateSessionEventType (OPC 10000-5 §6.4.10) for an attempt to sign in.
    fn session_activated(
        &self,
        channel: &ChannelDescription,
        session_id: NodeId,
        token: &ExtensionObject,
        outcome: StatusCode,
    ) -> ServerEvent {
        // The token without its secret.
        let shown = token.inner_as::<UserNameIdentityToken>().map(|token| UserNameIdentityToken {
            policy_id: token.policy_id.clone(),
            user_name: shortened(token.user_name.as_ref()).into(),
            password: ByteString::null(),
            encryption_algorithm: token.encryption_algorithm.clone(),
        });
        let user = shown.as_ref().map_or("anonymous", |token| token.user_name.as_ref()).to_owned();
        let message =
            if outcome.is_good() { "A user signed in." } else { "A user was not signed in." };
        let event_type = ObjectTypeId::AuditActivateSessionEventType;
        let mut event = self.audit(event_type, &user, outcome, message.to_owned());
        event.set("SourceName", "Session/ActivateSession");
        event.set("SessionId", session_id);
        event.set("SecureChannelId", channel.secure_channel_id.to_string());
        event.set_variant(
            "UserIdentityToken",
            Variant::from(shown.map_or_else(ExtensionObject::null, ExtensionObject::from_message)),
        );
        event
    }

    /// Reports that the twin ended a session, with the reason; no user where it was never activated.
    pub fn report_terminated(
        &self,
        session_id: NodeId,
        user_token: Option<UserToken>,
        message: &str,
    ) {
        self.sessions.ended(&session_id);
        if self.has_subscribers() {
            self.send(&self.session_ended(
                "Session/Terminated",
                session_id,
                user_token,
                StatusCode::Good,
                message.to_owned(),
            ));
        }
    }

    /// Reports a TrustListUpdatedAuditEventType (OPC 10000-12 §7.8.2.12).
    pub fn report_trust_list(&self, by: &str, message: String) {
        if self.has_subscribers() {
            let event_type = ObjectTypeId::TrustListUpdatedAuditEventType;
            let mut event = self.audit(event_type, by, StatusCode::Good, message);
            event.set("SourceName", "Method/UpdateTrustList");
            self.send(&event);
        }
    }

    /// Reports a CertificateUpdatedAuditEventType (OPC 10000-12 §7.10.18): the twin uses another
    /// certificate from now on.
    pub fn report_application_certificate(&self, certificate: &X509) {
        if self.has_subscribers() {
            let message = format!(
                "The server uses the certificate {} now.",
                certificate.thumbprint().as_hex_string()
            );
            let event_type = ObjectTypeId::CertificateUpdatedAuditEventType;
            let mut event =
                self.audit(event_type, system::UPDATE_CERTIFICATE, StatusCode::Good, message);
            event.set("SourceName", "Method/UpdateCertificate");
            self.send(&event);
        }
    }

    /// Reports a certificate that was not accepted, as a subtype of AuditCertificateEventType (OPC
    /// 10000-5 §6.4.12).
    pub fn report_certificate(&self, certificate: &X509, error: CertificateError) {
        if !self.has_subscribers() {
            return;
        }
        let (event_type, status) = match error {
            CertificateError::Unreadable => {
                (ObjectTypeId::AuditCertificateInvalidEventType, StatusCode::BadCertificateInvalid)
            }
            CertificateError::Denied | CertificateError::Waiting | CertificateError::Unknown => (
                ObjectTypeId::AuditCertificateUntrustedEventType,
                StatusCode::BadCertificateUntrusted,
            ),
            CertificateError::OutOfTime => (
                ObjectTypeId::AuditCertificateExpiredEventType,
                StatusCode::BadCertificateTimeInvalid,
            ),
            CertificateError::Revoked => {
                (ObjectTypeId::AuditCertificateRevokedEventType, StatusCode::BadCertificateRevoked)
            }
            CertificateError::RevocationUnknown => (
                ObjectTypeId::AuditCertificateRevokedEventType,
                StatusCode::BadCertificateRevocationUnknown,
            ),
            CertificateError::TrustListUnreadable => (
                ObjectTypeId::AuditCertificateRevokedEventType,
                StatusCode::BadCertificateRevocationUnknown,
            ),
            CertificateError::Usage => (
                ObjectTypeId::AuditCertificateMismatchEventType,
                StatusCode::BadCertificateUseNotAllowed,
            ),
            CertificateError::KeyLength => (
                ObjectTypeId::AuditCertificateInvalidEventType,
                StatusCode::BadCertificatePolicyCheckFailed,
            ),
        };
        let message = format!("A client's certificate was not accepted: {error}.");
        let mut event = self.audit(event_type, system::CREATE_SESSION, status, message);
        event.set("SourceName", "Security/Certificate");
        event.set("Certificate", certificate.as_byte_string());
        self.send(&event);
    }
}

/// The fields that AuditOpenSecureChannelEventType and AuditCreateSessionEventType share.
fn set_channel(event: &mut ServerEvent, channel: &ChannelDescription) {
    let certificate = channel.client_certificate.as_ref();
    event.set("SecureChannelId", channel.secure_channel_id.to_string());
    event.set("ClientCertificate", certificate.map_or_else(ByteString::null, X509::as_byte_string));
    let thumbprint = certificate.map(|certificate| certificate.thumbprint().as_hex_string());
    event
        .set("ClientCertificateThumbprint", thumbprint.map_or_else(UAString::null, UAString::from));
}

fn shortened(text: &str) -> &str {
    let end = (0..=NAME_BYTES_MAX.min(text.len())).rev().find(|at| text.is_char_boundary(*at));
    &text[..end.unwrap_or(0)]
}

#[cfg(test)]
mod tests;
