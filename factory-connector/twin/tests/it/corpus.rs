//! The inputs of the fuzz target, replayed in every run.

use std::collections::BTreeSet;

use opcua_stack::opcua::{
    crypto::SecurityPolicy,
    types::{MessageSecurityMode, NodeId},
};

use crate::{harness::TestTwin, raw_client::RawClient, raw_session::RawSession};

#[path = "../../fuzz/inputs/requests.rs"]
mod requests;

#[test]
fn the_corpus_of_requests_replays() {
    testkit::corpus::replay(env!("CARGO_MANIFEST_DIR"), "twin", 61, requests::requests);
}

#[tokio::test]
async fn every_service_is_among_the_inputs() {
    let twin = TestTwin::start_with(|config| {
        config.security.allow_anonymous_unencrypted = true;
        config.security.trust_unknown_certificates = true;
    })
    .await;
    let mode = MessageSecurityMode::SignAndEncrypt;
    let client = RawClient::new(&twin, SecurityPolicy::Basic256Sha256, mode).await;
    let channel = client.open_channel().await;
    let service = |id, rest: &[u8]| {
        requests::decoded(&channel, &NodeId::null(), id, rest).map(|request| request.type_name())
    };
    // Each request can be read from noughts: no elements, no texts, null ids.
    let all: BTreeSet<&str> = (0..=u16::MAX).filter_map(|id| service(id, &[0; 512])).collect();
    assert!(all.len() > 35, "{all:?}");
    let inputs = testkit::corpus::inputs(env!("CARGO_MANIFEST_DIR"), "twin");
    let named = inputs.iter().flat_map(|input| requests::split(&input[1..]));
    let played: BTreeSet<&str> = named.filter_map(|(id, rest)| service(id, rest)).collect();
    assert_eq!(played, all);
    // They reach the services: a session that does not end itself is answered.
    let mut session = RawSession::sign_in(&twin).await;
    let of_nothing = [0; 16];
    let answers = session.play(&[(631, of_nothing.as_slice()); 3]).await;
    assert!(answers.is_some(), "the server goes on");
    drop(channel);
    twin.stop().await;
}
