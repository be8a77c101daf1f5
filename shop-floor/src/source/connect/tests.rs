use opcua_stack::opcua::crypto::X509Data;

use super::*;
use crate::Config;

#[tokio::test]
async fn a_key_that_is_too_short_is_the_servers_and_no_question_of_trust() {
    let folder = tempfile::tempdir().expect("a folder");
    let (context, _changes) =
        SourceContext::new(Config::new(folder.path(), "Shop floor", "urn:test:shop-floor"));
    let description = X509Data { key_size: 1024, ..X509Data::sample_cert() };
    let (certificate, _) = X509::cert_and_pkey(&description).expect("a certificate");
    let endpoint = EndpointDescription {
        server_certificate: certificate.as_byte_string(),
        security_policy_uri: crypto::SecurityPolicy::Basic256Sha256.to_uri().into(),
        ..EndpointDescription::default()
    };
    let problem = check_trust(&context, &endpoint).await.expect_err("it is too short");
    assert_eq!(problem.kind, Kind::ServerKeyTooShort, "{problem:?}");
    assert!(problem.message.contains("1024"), "{problem:?}");
    let waiting = context.with_certificates(PkiDirectory::list).await.expect("it ran");
    assert!(waiting.expect("a list").is_empty(), "nobody is asked to trust what cannot be used");
}
