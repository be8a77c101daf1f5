//! Cookies of sessions that were found lately. Requests with these are looked up however many made-up ones
//! come from the same address.

use std::{collections::HashSet, sync::Arc};

use parking_lot::Mutex;

use super::accounts::SessionId;

/// Most cookies that are remembered; beyond, all are forgotten and come again with their next request.
const COOKIES_MAX: usize = 20_000;
/// Characters of a cookie: 32 random bytes as base64url.
const COOKIE_CHARS: usize = 43;

/// Ids of sessions, by the hash of their cookies. Clones share them.
#[derive(Clone, Default)]
pub(super) struct KnownCookies(Arc<Mutex<HashSet<SessionId>>>);

impl KnownCookies {
    pub(super) fn has(&self, id: &SessionId) -> bool {
        self.0.lock().contains(id)
    }

    pub(super) fn add(&self, id: &SessionId) {
        let mut known = self.0.lock();
        if known.len() >= COOKIES_MAX {
            known.clear();
        }
        known.insert(id.clone());
    }

    pub(super) fn remove(&self, id: &SessionId) {
        self.0.lock().remove(id);
    }
}

/// Returns true for a text that may be the cookie of a session: no other one needs to be looked up.
pub(super) fn has_form_of_cookie(text: &str) -> bool {
    let is_base64url = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_');
    text.len() == COOKIE_CHARS && text.bytes().all(is_base64url)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cookie_has_a_form_that_rubbish_has_not() {
        let cookie = "A9-_".repeat(10) + "abc";
        assert!(has_form_of_cookie(&cookie));
        for rubbish in ["", "x", &cookie[1..], &format!("{cookie}x"), &format!("{}=", &cookie[1..])]
        {
            assert!(!has_form_of_cookie(rubbish), "{rubbish}");
        }
    }

    #[test]
    fn what_is_remembered_is_bounded() {
        let known = KnownCookies::default();
        for number in 0..=COOKIES_MAX {
            known.add(&SessionId::of(&number.to_string()));
        }
        assert_eq!(known.0.lock().len(), 1);
        let last = SessionId::of(&COOKIES_MAX.to_string());
        assert!(known.has(&last));
        known.remove(&last);
        assert!(!known.has(&last));
    }
}
