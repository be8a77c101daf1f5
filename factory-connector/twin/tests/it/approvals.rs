//! Certificates that are trusted though no person approved them.

use std::{
    fs,
    sync::{Arc, Mutex},
};

use tracing::field::{Field, Visit};

use crate::harness::TestTwin;

/// All that is logged, as text.
#[derive(Clone, Default)]
struct StartLog(Arc<Mutex<String>>);

impl StartLog {
    fn text(&self) -> String {
        self.0.lock().unwrap().clone()
    }
}

impl Visit for StartLog {
    fn record_debug(&mut self, field: &Field, value: &dyn std::fmt::Debug) {
        self.0.lock().unwrap().push_str(&format!("{field}={value:?} "));
    }
}

impl tracing::Subscriber for StartLog {
    fn enabled(&self, _: &tracing::Metadata<'_>) -> bool {
        true
    }
    fn new_span(&self, _: &tracing::span::Attributes<'_>) -> tracing::span::Id {
        tracing::span::Id::from_u64(1)
    }
    fn record(&self, _: &tracing::span::Id, _: &tracing::span::Record<'_>) {}
    fn record_follows_from(&self, _: &tracing::span::Id, _: &tracing::span::Id) {}
    fn event(&self, event: &tracing::Event<'_>) {
        event.record(&mut self.clone());
    }
    fn enter(&self, _: &tracing::span::Id) {}
    fn exit(&self, _: &tracing::span::Id) {}
}

fn certificate(name: &str) -> Vec<u8> {
    let mut params = rcgen::CertificateParams::default();
    params.distinguished_name.push(rcgen::DnType::CommonName, name);
    let key = rcgen::KeyPair::generate().unwrap();
    params.self_signed(&key).unwrap().der().to_vec()
}

#[tokio::test]
async fn a_certificate_that_no_person_approved_is_named_at_each_start_until_one_does() {
    const SAID: &str = "no person is known to have approved";
    let log = StartLog::default();
    let guard = tracing::subscriber::set_default(log.clone());
    let twin = TestTwin::start_with(|config| {
        let trusted = config.pki_directory.join("trusted");
        fs::create_dir_all(&trusted).unwrap();
        fs::write(trusted.join("former.der"), certificate("former client")).unwrap();
    })
    .await;
    drop(guard);
    let text = log.text();
    assert!(text.contains(SAID) && text.contains("certificates=1"), "{text}");
    assert!(text.contains("former client"), "{text}");

    let list = twin.handle.trust_list().clone();
    let unapproved = list.unapproved().unwrap();
    assert_eq!((unapproved.len(), &unapproved[0].approval), (1, &None));
    assert!(list.trust(&unapproved[0].thumbprint, "anna").unwrap());
    assert!(list.unapproved().unwrap().is_empty());
    let folder = twin.stop_but_keep().await;

    let log = StartLog::default();
    let guard = tracing::subscriber::set_default(log.clone());
    let twin =
        TestTwin::start_with(|config| config.pki_directory = folder.path().join("pki")).await;
    drop(guard);
    assert!(!log.text().contains(SAID), "{}", log.text());
    let known = twin.handle.trust_list().list().unwrap();
    assert_eq!(known[0].approval.as_ref().map(|approval| approval.by.as_str()), Some("anna"));
    twin.stop().await;
}
