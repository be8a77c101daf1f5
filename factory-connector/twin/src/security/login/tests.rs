use std::sync::{
    Mutex as StdMutex,
    atomic::{AtomicUsize, Ordering},
};

use futures::future::join_all;
use opcua_stack::opcua::crypto::SecurityPolicy;
use tracing::field::{Field, Visit};

use super::*;

/// Counts how many checks run at once.
#[derive(Default)]
struct Slow {
    running: AtomicUsize,
    most: AtomicUsize,
}

#[async_trait]
impl Authenticator for Slow {
    async fn authenticate(
        &self,
        _: &str,
        password: &str,
        _: Option<IpAddr>,
    ) -> Result<Role, SignInRefusal> {
        let running = self.running.fetch_add(1, Ordering::SeqCst) + 1;
        self.most.fetch_max(running, Ordering::SeqCst);
        tokio::time::sleep(Duration::from_millis(5)).await;
        self.running.fetch_sub(1, Ordering::SeqCst);
        match password {
            "right" => Ok(Role::Viewer),
            "half" => Err(SignInRefusal::SecondFactorImpossible),
            _ => Err(SignInRefusal::WrongCredentials),
        }
    }
}

fn login(authenticator: Arc<Slow>, login_failures_max: u32) -> Login {
    Login::new(authenticator, &SecurityConfig { login_failures_max, ..SecurityConfig::default() })
}

async fn sign_in(login: &Login, user: &str, password: &str, host: u8) -> bool {
    let endpoint = ServerEndpoint::new(
        "/",
        SecurityPolicy::Basic256Sha256,
        MessageSecurityMode::SignAndEncrypt,
        &[],
    );
    let address = Some(SocketAddr::from(([10, 0, 0, host], 4000)));
    let password = Password::new(password.to_owned());
    login
        .authenticate_username_identity_token_from(&endpoint, user, &password, address)
        .await
        .is_ok()
}

#[tokio::test]
async fn few_passwords_are_checked_at_once_and_no_more_wait_than_there_is_room() {
    let authenticator = Arc::new(Slow::default());
    let login = login(Arc::clone(&authenticator), 1000);
    let users: Vec<String> = (0..100).map(|number| format!("user{number}")).collect();
    let attempts = users.iter().map(|user| sign_in(&login, user, "right", 1));
    let accepted = join_all(attempts).await.into_iter().filter(|is_in| *is_in).count();
    assert_eq!(accepted, CHECKS_MAX, "those beyond are refused at once");
    assert_eq!(authenticator.most.load(Ordering::SeqCst), CHECKS_AT_ONCE_MAX);
    assert!(sign_in(&login, "user99", "right", 1).await, "and are no failures");
}

#[tokio::test]
async fn one_client_locks_nobody_out_but_itself() {
    let login = login(Arc::default(), 2);
    let guesses = (0..10).map(|_| sign_in(&login, "anna", "wrong", 1));
    join_all(guesses).await;
    assert!(!sign_in(&login, "anna", "right", 1).await, "guesses at the same time count, too");
    assert!(sign_in(&login, "anna", "right", 2).await, "from elsewhere");
    assert!(sign_in(&login, "bert", "right", 1).await);
    for number in 0..40 {
        sign_in(&login, &format!("user{number}"), "wrong", 1).await;
    }
    assert!(!sign_in(&login, "bert", "right", 1).await);
    assert!(sign_in(&login, "bert", "right", 2).await);
}

/// All that is logged, as text.
struct Log(Arc<StdMutex<String>>);

impl Visit for Log {
    fn record_debug(&mut self, field: &Field, value: &dyn std::fmt::Debug) {
        self.0.lock().expect("not poisoned").push_str(&format!("{field}={value:?} "));
    }
}

impl tracing::Subscriber for Log {
    fn enabled(&self, _: &tracing::Metadata<'_>) -> bool {
        true
    }
    fn new_span(&self, _: &tracing::span::Attributes<'_>) -> tracing::span::Id {
        tracing::span::Id::from_u64(1)
    }
    fn record(&self, _: &tracing::span::Id, _: &tracing::span::Record<'_>) {}
    fn record_follows_from(&self, _: &tracing::span::Id, _: &tracing::span::Id) {}
    fn event(&self, event: &tracing::Event<'_>) {
        event.record(&mut Self(Arc::clone(&self.0)));
    }
    fn enter(&self, _: &tracing::span::Id) {}
    fn exit(&self, _: &tracing::span::Id) {}
}

#[tokio::test]
async fn the_name_of_a_refused_sign_in_is_not_logged() {
    let text = Arc::new(StdMutex::new(String::new()));
    let guard = tracing::subscriber::set_default(Log(Arc::clone(&text)));
    let login = login(Arc::default(), 2);
    // A password in the wrong box; then too often, and too long.
    for _ in 0..4 {
        assert!(!sign_in(&login, "hunter2", "wrong", 1).await);
    }
    assert!(!sign_in(&login, &"hunter2".repeat(1000), "wrong", 1).await);
    assert!(sign_in(&login, "anna", "right", 1).await);
    drop(guard);
    let text = text.lock().expect("not poisoned").clone();
    assert!(text.contains("refused a sign-in") && text.contains("user.name_length=7"), "{text}");
    assert!(!text.contains("hunter2"), "{text}");
    assert!(text.contains("user.name=\"anna\""), "{text}");
}

#[tokio::test]
async fn a_user_with_a_passkey_alone_is_refused_with_a_reason_in_the_log_and_not_throttled() {
    let text = Arc::new(StdMutex::new(String::new()));
    let guard = tracing::subscriber::set_default(Log(Arc::clone(&text)));
    let login = login(Arc::default(), 2);
    for _ in 0..4 {
        assert!(!sign_in(&login, "pia", "half", 1).await);
    }
    drop(guard);
    let text = text.lock().expect("not poisoned").clone();
    assert!(text.contains("user.name=\"pia\""), "{text}");
    assert_eq!(text.matches(SignInRefusal::SecondFactorImpossible.reason()).count(), 4, "{text}");
}
