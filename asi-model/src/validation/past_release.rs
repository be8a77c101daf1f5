//! Reading releases of the past.

use super::{
    FaultCode, LIST_MAX,
    lists::not_empty,
    message_members::{factory_id, number, writer_id},
    reader::Reader,
};
use crate::{
    json::JsonNode,
    messages::{PastRelease, ReportRange},
};

pub(super) fn past_release(reader: &mut Reader, root: JsonNode<'_, '_>) -> Option<PastRelease> {
    let message_id = reader.required_id(root, "messageId");
    let factory_id = factory_id(reader, root, None);
    let operation_network_id = reader.required_id(root, "operationNetworkId");
    let operation_id = reader.required_id(root, "operationId");
    let dynamic_data_request_id = reader.required_id(root, "dynamicDataRequestId");
    let recipient_id = reader.required_id(root, "recipientId");
    let decided_at = reader.required(root, "decidedAt", Reader::time);
    let range_list = reader.list(root, "rangeList", LIST_MAX, range);
    not_empty(reader, root, "rangeList");
    Some(PastRelease {
        message_id,
        factory_id,
        operation_network_id,
        operation_id,
        dynamic_data_request_id,
        recipient_id,
        decided_at: decided_at?,
        range_list,
    })
}

fn range(reader: &mut Reader, node: JsonNode<'_, '_>) -> Option<ReportRange> {
    if !reader.is_object(node, "A range of reports") {
        return None;
    }
    let data_set_writer_id = writer_id(reader, node);
    let epoch = number(reader, node, "epoch");
    let first_sequence = number(reader, node, "firstSequence");
    let last_sequence = number(reader, node, "lastSequence");
    let range = ReportRange {
        data_set_writer_id: data_set_writer_id?,
        epoch: epoch?,
        first_sequence: first_sequence?,
        last_sequence: last_sequence?,
    };
    if range.last_sequence < range.first_sequence {
        let message = "The last report of a range is not before the first.";
        reader.fault(node, FaultCode::InvalidValue, message);
        return None;
    }
    Some(range)
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use crate::validation::parse_factory_message;

    /// Codes and pointers of the faults of the example with another `rangeList`.
    fn faults(ranges: Value) -> Vec<(String, String)> {
        let example = include_str!("../../examples/past-release.json");
        let mut message: Value = serde_json::from_str(example).expect("JSON");
        message["rangeList"] = ranges;
        let parsed = parse_factory_message(message.to_string().as_bytes());
        let faults = parsed.err().map(|rejection| rejection.faults).unwrap_or_default();
        faults.into_iter().map(|fault| (fault.code, fault.pointer)).collect()
    }

    #[test]
    fn ranges_are_ordered_and_bounded() {
        let range = |first: u32, last: u32| {
            json!({ "dataSetWriterId": 1, "epoch": 9, "firstSequence": first,
                "lastSequence": last })
        };
        let fault = |code: &str, pointer: &str| vec![(code.to_owned(), pointer.to_owned())];
        assert_eq!(faults(json!([range(0, 0), range(2, 7)])), []);
        assert_eq!(faults(json!([range(2, 1)])), fault("INVALID_VALUE", "/rangeList/0"));
        assert_eq!(faults(json!([])), fault("EMPTY_LIST", "/rangeList"));
        assert_eq!(faults(json!(vec![range(0, 0); 501])), fault("TOO_MANY_ELEMENTS", "/rangeList"));
    }
}
