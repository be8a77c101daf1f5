//! Caps in the store: they are read again, and what they hold back stays so.

use connector_state::{
    queries::fields_held_back,
    use_cases::{alliances::put_alliance, caps::put_cap},
};

use super::*;

#[tokio::test]
async fn caps_and_what_they_hold_back_survive_a_restart() {
    let running = Running::with_two_open_fields().await;
    running.enter_both(1).await;
    let alliance = json!({ "name": "Yard", "memberList": ["acme", "hull"] });
    let alliance = serde_json::from_value(alliance).expect("an alliance");
    let id: disclosure::DocumentId = "yard".parse().expect("an id");
    let put = running.coordinator.execute({
        let id = id.clone();
        move |state, now| put_alliance(state, &id, alliance, None, "eve", now)
    });
    put.await.expect("written").expect("stored");
    let cap = json!({ "name": "Yard", "subject": { "allianceId": "yard" }, "bitsPerHourMax": 9 });
    let cap = serde_json::from_value(cap).expect("a cap");
    let put = running.coordinator.execute({
        let id = id.clone();
        move |state, now| put_cap(state, &id, cap, None, "eve", now)
    });
    let (_, held_back) = put.await.expect("written").expect("stored");
    assert_eq!(held_back.len(), 2, "fields without a bound fit no cap");

    let folder = running.close().await;
    let path = folder.path().to_owned();
    let running = Running::open_in(path, Some(folder)).await;
    let found = running.coordinator.read(move |state| {
        let held_back = fields_held_back(state).remove(&id);
        let budgets = state.budgets();
        (held_back, budgets.alliances().count(), budgets.caps().count())
    });
    let (again, alliances, caps) = found.await.expect("read");
    let mut held_back = held_back;
    held_back.sort();
    assert_eq!(again, Some(held_back));
    assert_eq!(alliances, 1);
    assert_eq!(caps, 1);
    // The plant sees which cap it was; the recipient's chain commits to it without its name.
    let filter = LedgerFilter { recipient: "acme".parse().ok(), ..LedgerFilter::default() };
    let mut cursor = LedgerCursor::new(filter);
    let rows = running.session().await.ledger().next(&mut cursor).await.expect("read");
    let bases = rows.iter().filter_map(|row| serde_json::to_value(row.basis.as_ref()?).ok());
    let bases: Vec<Value> = bases.collect();
    assert_eq!(bases, vec![json!({ "caps": [{ "id": "yard", "version": 1 }] }); 2]);
    let committed = rows.iter().filter(|row| row.content.contains(r#""commitment":""#)).count();
    assert_eq!(committed, 2, "{rows:?}");
    assert!(!rows.iter().any(|row| row.content.contains("yard")), "{rows:?}");
    running.close().await;
}

#[tokio::test]
async fn what_ended_is_kept_over_a_restart_for_caps_and_rules() {
    let running = Running::with_two_open_fields().await;
    let made = field("made");
    decide_field(&running.coordinator, made.clone(), DecisionCommand::LeavePending).await;
    let ended = running.session().await.former_disclosures().all().await.expect("read");
    let [former] = &ended[..] else { panic!("{ended:?}") };
    assert!(former.document.contains(r#""fieldName":"made""#), "{former:?}");

    let folder = running.close().await;
    let path = folder.path().to_owned();
    let running = Running::open_in(path, Some(folder)).await;
    let command = DecisionCommand::Map {
        value_source: ValueSource::Manual,
        mapping: None,
        policy: disclosure::DisclosurePolicy::default(),
    };
    decide_field(&running.coordinator, made.clone(), command).await;
    decide_field(&running.coordinator, made, DecisionCommand::LeavePending).await;
    let again = running.session().await.former_disclosures().all().await.expect("read");
    assert_eq!(again.len(), 1, "the same once more: {again:?}");
    assert_eq!((again[0].id, &again[0].document), (former.id, &former.document));
    assert!(again[0].ended_at > former.ended_at);
    running.close().await;
}
