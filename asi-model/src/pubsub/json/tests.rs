//! Figures of the DIGICOR paper, layouts and round trips.

use super::*;
use crate::pubsub::*;
use crate::values::{DataValue, DateTime, StatusCode};

fn time(text: &str) -> DateTime {
    text.parse().expect("a valid time")
}

/// The report of figure 4, as `messages.md` fixes it.
fn progress_report() -> NetworkMessage {
    NetworkMessage {
        message_id: Some("3ea281da-fad0-42e0-8c9a-713bd4257fec".parse().expect("valid")),
        publisher_id: Some("FOR_MUC".into()),
        messages: vec![DataSetMessage {
            data_set_writer_id: Some(1),
            sequence_number: Some(0),
            meta_data_version: Some(MetaDataVersion { major: 608_926_829, minor: 608_926_829 }),
            timestamp: Some(time("2019-04-18T18:20:30Z")),
            fields: vec![
                PayloadField::new("reportName", "ProgressReport"),
                PayloadField::new("dynamicDataRequestId", "ReqResponse1"),
                PayloadField::new("operationId", "MakeFrame1"),
                PayloadField::new("operationNetworkId", "frame-4711"),
                PayloadField::new("shopfloorTimestamp", time("2019-04-18T18:20:05Z")),
                PayloadField::new("progressStatus", 1_u64),
                PayloadField::new("progressStatusUnit", "PIECE"),
            ],
            ..DataSetMessage::default()
        }],
        ..NetworkMessage::default()
    }
}

fn encoded(message: &NetworkMessage, encoding: Encoding) -> String {
    String::from_utf8(encode(message, encoding)).expect("UTF-8")
}

#[test]
fn the_contract_s_example_is_written_to_the_letter() {
    let expected = concat!(
        r#"{"MessageId":"3ea281da-fad0-42e0-8c9a-713bd4257fec","MessageType":"ua-data","PublisherId":"FOR_MUC","#,
        r#""Messages":[{"DataSetWriterId":1,"SequenceNumber":0,"#,
        r#""MetaDataVersion":{"MajorVersion":608926829,"MinorVersion":608926829},"Timestamp":"2019-04-18T18:20:30Z","#,
        r#""Payload":{"reportName":{"Type":12,"Body":"ProgressReport"},"#,
        r#""dynamicDataRequestId":{"Type":12,"Body":"ReqResponse1"},"operationId":{"Type":12,"Body":"MakeFrame1"},"#,
        r#""operationNetworkId":{"Type":12,"Body":"frame-4711"},"#,
        r#""shopfloorTimestamp":{"Type":13,"Body":"2019-04-18T18:20:05Z"},"#,
        r#""progressStatus":{"Type":9,"Body":"1"},"progressStatusUnit":{"Type":12,"Body":"PIECE"}}}]}"#,
    );
    assert_eq!(encoded(&progress_report(), Encoding::Digicor), expected);
}

#[test]
fn every_encoding_reads_back() {
    let mut message = progress_report();
    message.messages[0].fields.push(PayloadField::with(
        "held",
        DataValue { value: 1.5.into(), status: StatusCode::UNCERTAIN_LAST_USABLE_VALUE, ..DataValue::default() },
    ));
    message.messages[0]
        .fields
        .push(PayloadField::with("lost", DataValue::status_only(StatusCode::BAD_NOT_CONNECTED, None)));
    for encoding in [Encoding::Digicor, Encoding::Compact105] {
        let bytes = encode(&message, encoding);
        let decoded = decode(&bytes).expect("our own message");
        assert_eq!(decoded.diagnostics, []);
        assert_eq!(decoded.message, PubSubMessage::Data(message.clone()), "{encoding}");
    }
}
