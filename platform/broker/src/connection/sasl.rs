//! SASL PLAIN (RFC 4616), the only mechanism that the broker offers.

use std::sync::{Arc, OnceLock};

use fe2o3_amqp::{
    acceptor::{SaslAcceptor, sasl_acceptor::SaslServerFrame},
    types::{
        primitives::{Array, Symbol},
        sasl::{SaslCode, SaslInit, SaslOutcome, SaslResponse},
    },
};

use crate::credentials::{CredentialSource, is_authentic};

/// SASL exchange of one connection. The library clones its acceptor, so the result is shared
/// between clones.
#[derive(Clone)]
pub(super) struct SaslExchange {
    credentials: Arc<dyn CredentialSource>,
    user: Arc<OnceLock<Arc<str>>>,
    is_refused: Arc<OnceLock<()>>,
}

impl SaslExchange {
    pub(super) fn new(credentials: Arc<dyn CredentialSource>) -> Self {
        Self { credentials, user: Arc::default(), is_refused: Arc::default() }
    }

    /// Name of the signed-in user; none when the peer has skipped SASL.
    pub(super) fn user_name(&self) -> Option<Arc<str>> {
        self.user.get().cloned()
    }

    /// Value of the metric label `reason` after a handshake that failed.
    pub(super) fn failure(&self) -> &'static str {
        if self.is_refused.get().is_some() { "credentials" } else { "protocol" }
    }

    fn check(&self, init: &SaslInit) -> SaslCode {
        if init.mechanism.as_str() != "PLAIN" {
            return SaslCode::Auth;
        }
        // authorisation identity, NUL, user name, NUL, secret
        let response = init.initial_response.as_ref().map(|r| r.as_slice()).unwrap_or_default();
        let mut parts = response.split(|byte| *byte == 0);
        let (Some(acting_as), Some(name), Some(secret), None) =
            (parts.next(), parts.next(), parts.next(), parts.next())
        else {
            return SaslCode::Auth;
        };
        let Ok(name) = std::str::from_utf8(name) else { return SaslCode::Auth };
        let may_act = acting_as.is_empty() || acting_as == name.as_bytes();
        let user = self.credentials.user(name);
        if is_authentic(user.as_ref(), secret) && may_act && self.user.set(Arc::from(name)).is_ok()
        {
            SaslCode::Ok
        } else {
            SaslCode::Auth
        }
    }
}

impl SaslAcceptor for SaslExchange {
    fn mechanisms(&self) -> Array<Symbol> {
        Array::from(vec![Symbol::from("PLAIN")])
    }

    fn on_init(&mut self, init: SaslInit) -> SaslServerFrame {
        let code = self.check(&init);
        if !matches!(code, SaslCode::Ok) {
            let _ = self.is_refused.set(());
        }
        SaslServerFrame::Outcome(SaslOutcome { code, additional_data: None })
    }

    fn on_response(&mut self, _response: SaslResponse) -> SaslServerFrame {
        SaslServerFrame::Outcome(SaslOutcome { code: SaslCode::Auth, additional_data: None })
    }
}
