//! Holders whose credentials were revoked: what is for them waits until they enrol again.

use asi_model::DateTime;
use messaging::{Fetch, Lane, LogicalAddress, RowId};
use platform::store::{Holder, NewOutgoing, Store, Work};

async fn add(work: &mut Work, address: &str, number: u32) {
    let message = NewOutgoing {
        address: address.parse().expect("an address"),
        message_id: format!("m{number}").parse().expect("an id"),
        subject: "comment".into(),
        correlation_id: None,
        created_at: DateTime::from_ticks(0),
        time_to_live: None,
        content_encoding: None,
        body: "{}".into(),
    };
    work.outgoing().add(&message).await.expect("stored");
}

/// Number and message of each row that the link would send.
async fn sent(work: &mut Work, after: i64) -> Vec<(i64, String)> {
    let fetch = Fetch { lane: Lane::Control, after: RowId(after), through: None, limit: 10 };
    let rows = work.outgoing().fetch(fetch).await.expect("read");
    let id = |row: &messaging::SpoolRow| row.envelope.message_id.as_ref().map(ToString::to_string);
    rows.iter().map(|row| (row.id.0, id(row).expect("an id"))).collect()
}

#[tokio::test]
async fn what_is_for_a_revoked_holder_waits_until_it_enrols_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = Store::open(&folder.path().join("store.sqlite")).await.expect("it opens");
    let mut work = store.begin().await.expect("begun");
    let holder = Holder::Factory("F".parse().expect("an id"));
    let ingress: LogicalAddress = "factory.F.ingress".parse().expect("an address");
    let now = DateTime::from_ticks(7);
    add(&mut work, "factory.F.requests", 1).await;
    assert_eq!(work.revoked_access().of(&ingress).await.expect("read"), None);
    work.credentials().revoke(&holder, now).await.expect("revoked");
    assert_eq!(work.revoked_access().of(&ingress).await.expect("read"), Some(now));
    for (number, address) in (2..).zip([
        "factory.F.requests",
        "factory.F.leases",
        "factory.G.requests",
        "tool.F.reports",
    ]) {
        add(&mut work, address, number).await;
    }
    assert_eq!(sent(&mut work, 0).await, [(4, "m4".to_owned()), (5, "m5".to_owned())]);
    work.credentials().revoke(&holder, now).await.expect("a second time");

    work.revoked_access().admit(&holder).await.expect("admitted");
    assert_eq!(work.revoked_access().of(&ingress).await.expect("read"), None);
    let waited: Vec<String> = sent(&mut work, 5).await.into_iter().map(|(_, id)| id).collect();
    assert_eq!(waited, ["m1", "m2", "m3"], "behind what the link has sent already");
    assert_eq!(sent(&mut work, 0).await.len(), 5, "and each once");
}
