//! Tests of decoding: good, forged and broken messages.

use asi_model::pubsub::MetaDataVersion;
use messaging::Delivery;
use serde_json::{Value, json};
use uuid::Uuid;

use super::*;

fn ingress() -> LogicalAddress {
    LogicalAddress::FactoryIngress("FOR_MUC".parse().expect("valid"))
}

fn delivery(body: impl Into<bytes::Bytes>) -> Delivery {
    Delivery {
        envelope: Envelope::new("t1".parse().expect("valid"), "any", body),
        is_redelivered: false,
        delivery_count: 0,
        received_at: time::OffsetDateTime::UNIX_EPOCH,
    }
}

fn report() -> Value {
    json!({ "MessageId": "m1", "MessageType": "ua-data", "PublisherId": "FOR_MUC",
      "Messages": [ { "DataSetWriterId": 1, "SequenceNumber": 4,
        "MetaDataVersion": { "MajorVersion": 608_926_829, "MinorVersion": 608_926_829 },
        "Timestamp": "2019-04-18T18:20:30Z",
        "Payload": {
          "reportName": { "Type": 12, "Body": "ProgressReport" },
          "dynamicDataRequestId": { "Type": 12, "Body": "ReqResponse1" },
          "operationId": { "Type": 12, "Body": "MakeFrame1" },
          "operationNetworkId": { "Type": 12, "Body": "frame-4711" },
          "shopfloorTimestamp": { "Type": 13, "Body": "2019-04-18T18:20:05Z" },
          "recipientList": { "Type": 12, "Body": ["acme-aero", "no id"] },
          "progressStatus": { "Type": 9, "Body": "1" },
          "progressStatusUnit": { "Type": 12, "Body": "PIECE" } } } ] })
}

fn check(body: &Value) -> Incoming {
    decode(&ingress(), &delivery(body.to_string()).into(), &(), &SigningState::default())
}

fn code_of(incoming: &Incoming) -> Option<&'static str> {
    match &incoming.content {
        Content::Dead(letter) => Some(letter.code),
        _ => None,
    }
}

#[test]
fn the_report_of_the_contract_is_understood() {
    let incoming = check(&report());
    assert_eq!((incoming.message_id.as_str(), incoming.message_type.as_str()), ("m1", "ua-data"));
    let Content::Reports { reports, keep_alives, .. } = incoming.content else { panic!("reports") };
    assert!(keep_alives.is_empty());
    let report = &reports[0];
    assert_eq!(report.data_set_writer_id, 1);
    assert_eq!(report.epoch, 608_926_829);
    assert_eq!(report.sequence, 4);
    assert_eq!(report.request.to_string(), "frame-4711/MakeFrame1/ReqResponse1");
    assert_eq!(report.released_to, Some(vec!["acme-aero".parse().expect("an id")]));
    assert_eq!(report.fields.len(), 1, "units and reserved members are no fields");
    let (name, value) = &report.fields[0];
    assert_eq!((name.as_str(), value.value.as_f64()), ("progressStatus", Some(1.0)));
    assert_eq!(value.source_timestamp, report.shopfloor_timestamp);
}

/// The platform has a list of recipients of its own. It counts only for connectors of before, whose
/// reports do not say to whom they are released.
#[test]
fn a_report_that_should_name_its_recipients_and_does_not_is_for_nobody() {
    let mut former = report();
    let payload = former["Messages"][0]["Payload"].as_object_mut().expect("members");
    payload.remove("recipientList");
    let check = |names_recipients: bool, major: u32, expected: Option<Vec<OrganisationId>>| {
        let known = Described(DataSetMetaData {
            fields: ReportHeader::meta_data(names_recipients, |_| Uuid::nil()).collect(),
            configuration_version: MetaDataVersion { major, minor: major },
            ..DataSetMetaData::default()
        });
        let delivery = delivery(former.to_string()).into();
        let incoming = decode(&ingress(), &delivery, &known, &SigningState::default());
        let Content::Reports { reports, .. } = incoming.content else { panic!("reports") };
        assert_eq!(reports[0].released_to, expected, "{names_recipients} {major}");
    };
    check(true, 608_926_829, Some(Vec::new()));
    check(false, 608_926_829, None);
    check(true, 608_926_830, None);
}

struct Described(DataSetMetaData);

impl MetaDataLookup for Described {
    fn meta_data(
        &self,
        _publisher: Option<&str>,
        _writer: Option<u16>,
    ) -> Option<&DataSetMetaData> {
        Some(&self.0)
    }
}

#[test]
fn the_sender_is_known_by_the_address() {
    let mut forged = report();
    for (publisher, expected) in [
        ("FOR_MUC.robot%201", None),
        ("INS_HAM", Some("FORGED_PUBLISHER")),
        ("FOR_MUC2", Some("FORGED_PUBLISHER")),
    ] {
        forged["PublisherId"] = json!(publisher);
        assert_eq!(code_of(&check(&forged)), expected, "{publisher}");
    }
    let decision = json!({ "messageType": "gap", "messageId": "m2", "factoryId": "INS_HAM", "dataSetWriterId": 1,
        "epoch": 1, "firstSequence": 1, "lastSequence": 2, "cause": "COALESCED" });
    assert_eq!(code_of(&check(&decision)), Some("FORGED_PUBLISHER"));
}

#[test]
fn invalid_messages_are_rejected_with_a_reason() {
    for (body, expected) in [
        (Vec::from("not JSON"), "INVALID_MESSAGE"),
        (vec![0xff, 0xfe], "NOT_UTF8"),
        (Vec::from("[".repeat(200_000)), "INVALID_MESSAGE"),
        (Vec::from(r#"{"messageType":"decision"}"#), "INVALID_MESSAGE"),
        (vec![b' '; 300 * 1024], "UNREADABLE_BODY"),
    ] {
        let delivery = delivery(body.clone()).into();
        let incoming = decode(&ingress(), &delivery, &(), &SigningState::default());
        assert_eq!(
            code_of(&incoming),
            Some(expected),
            "{:?}",
            String::from_utf8_lossy(&body[..body.len().min(40)])
        );
        assert_eq!(incoming.message_id.as_str(), "t1", "the transport's id stands in");
    }
    let mut without_sequence = report();
    without_sequence["Messages"][0].as_object_mut().expect("an object").remove("SequenceNumber");
    assert_eq!(code_of(&check(&without_sequence)), Some("NO_SEQUENCE"));
    let mut without_request = report();
    without_request["Messages"][0]["Payload"]
        .as_object_mut()
        .expect("an object")
        .remove("operationId");
    assert_eq!(code_of(&check(&without_request)), Some("NO_REQUEST"));
}

#[test]
fn keep_alives_are_no_reports() {
    let body = json!({ "MessageId": "m3", "MessageType": "ua-data", "PublisherId": "FOR_MUC", "Messages": [
        { "DataSetWriterId": 1, "SequenceNumber": 5, "MessageType": "ua-keepalive",
          "MetaDataVersion": { "MajorVersion": 7, "MinorVersion": 7 } } ] });
    let Content::Reports { reports, keep_alives, .. } = check(&body).content else {
        panic!("reports")
    };
    assert_eq!((reports.len(), keep_alives), (0, vec![(1, 7)]));
}
