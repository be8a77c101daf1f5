//! SASL PLAIN (RFC 4616), the only mechanism that the broker offers.

use std::{
    net::IpAddr,
    sync::{Arc, OnceLock},
    time::Instant,
};

use fe2o3_amqp::{
    acceptor::{SaslAcceptor, sasl_acceptor::SaslServerFrame},
    types::{
        primitives::{Array, Symbol},
        sasl::{SaslCode, SaslInit, SaslOutcome, SaslResponse},
    },
};

use crate::{
    core::Core,
    credentials::{CredentialSource, is_authentic},
    guesses::Guesses,
};

/// Value of the metric label `reason` for sign-ins that were not looked at.
pub(super) const TOO_MANY_FAILURES: &str = "too-many-failures";

/// SASL exchange of one connection. The library clones its acceptor, so the result is shared
/// between clones.
#[derive(Clone)]
pub(super) struct SaslExchange {
    credentials: Arc<dyn CredentialSource>,
    user: Arc<OnceLock<Arc<str>>>,
    guesses: Arc<Guesses>,
    /// Address of the peer, where it has one.
    peer: Option<IpAddr>,
    refusal: Arc<OnceLock<&'static str>>,
}

impl SaslExchange {
    pub(super) fn new(core: &Core, peer: Option<IpAddr>) -> Self {
        Self {
            credentials: Arc::clone(&core.credentials),
            user: Arc::default(),
            guesses: Arc::clone(&core.guesses),
            peer,
            refusal: Arc::default(),
        }
    }

    /// Name of the signed-in user; none when the peer has skipped SASL.
    pub(super) fn user_name(&self) -> Option<Arc<str>> {
        self.user.get().cloned()
    }

    /// Value of the metric label `reason` after a handshake that failed.
    pub(super) fn failure(&self) -> &'static str {
        self.refusal.get().copied().unwrap_or("protocol")
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
        let begin = |peer| self.guesses.begin(peer, name, Instant::now());
        let attempt = match self.peer.map(begin) {
            // Before the secret is compared: the answer is the same for right and wrong ones.
            Some(None) => return SaslCode::SysTemp,
            attempt => attempt.flatten(),
        };
        let may_act = acting_as.is_empty() || acting_as == name.as_bytes();
        let user = self.credentials.user(name);
        if is_authentic(user.as_ref(), secret) && may_act && self.user.set(Arc::from(name)).is_ok()
        {
            if let Some(attempt) = attempt {
                self.guesses.succeeded(&attempt, Instant::now());
            }
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
        let refusal = match code {
            SaslCode::Ok => None,
            SaslCode::SysTemp => Some(TOO_MANY_FAILURES),
            _ => Some("credentials"),
        };
        if let Some(refusal) = refusal {
            let _ = self.refusal.set(refusal);
        }
        SaslServerFrame::Outcome(SaslOutcome { code, additional_data: None })
    }

    fn on_response(&mut self, _response: SaslResponse) -> SaslServerFrame {
        SaslServerFrame::Outcome(SaslOutcome { code: SaslCode::Auth, additional_data: None })
    }
}
