//! Size of a decoded message. Each element of a list, map or array takes far more memory than on the
//! wire, where a null has one byte: so messages with many are refused, and the few are counted.

use fe2o3_amqp_types::{messaging::Body, primitives::Value};

use crate::message::AnyMessage;

/// Elements of one message, over all of its sections: more than any peer of the platform has use for.
pub(crate) const ELEMENTS_MAX: usize = 256;
/// Estimated memory of one element: a value, its key, and its place in an index.
const ELEMENT_BYTES: u64 = 96;

/// Returns true where the body is bytes or text, the only ones that anybody reads.
pub(crate) fn is_plain(message: &AnyMessage) -> bool {
    match &message.body {
        Body::Data(_) => true,
        Body::Value(value) => matches!(value.0, Value::String(_) | Value::Binary(_)),
        Body::Sequence(_) | Body::Empty => false,
    }
}

/// Returns the number of values in all sections of a message, nested ones included.
pub(crate) fn elements(message: &AnyMessage) -> usize {
    let annotations = message.message_annotations.iter().map(|section| &section.0);
    let footers = message.footer.iter().map(|section| &section.0);
    let values = annotations.chain(footers).flat_map(|map| map.iter()).map(|(_, value)| value);
    let properties = message.application_properties.as_ref().map_or(0, |map| map.0.len());
    let body = match &message.body {
        Body::Value(value) => of_value(&value.0),
        Body::Data(sections) => sections.iter().count(),
        Body::Sequence(sections) => {
            sections.iter().map(|section| 1 + section.0.iter().map(of_value).sum::<usize>()).sum()
        }
        Body::Empty => 0,
    };
    values.map(of_value).sum::<usize>() + properties + body
}

fn of_value(value: &Value) -> usize {
    1 + match value {
        Value::Described(inner) => of_value(&inner.value),
        Value::List(all) => all.iter().map(of_value).sum(),
        Value::Array(all) => all.iter().map(of_value).sum(),
        Value::Map(all) => all.iter().map(|(key, value)| of_value(key) + of_value(value)).sum(),
        _ => 0,
    }
}

/// Estimates the memory of a decoded message of so many encoded bytes, its sections left out.
pub(crate) fn memory(bytes: u64, message: &AnyMessage) -> u64 {
    bytes + ELEMENT_BYTES * elements(message) as u64
}

#[cfg(test)]
mod tests {
    use fe2o3_amqp_types::messaging::{AmqpValue, Message};

    use super::*;

    fn of(value: Value) -> AnyMessage {
        Message::from(Body::Value(AmqpValue(value)))
    }

    #[test]
    fn nested_values_are_counted() {
        let list = |n: usize| Value::List(vec![Value::Null; n]);
        assert_eq!(elements(&of(Value::String("{}".to_owned()))), 1);
        assert_eq!(elements(&of(Value::List(vec![list(10), list(20)]))), 33);
        assert!(!is_plain(&of(list(1))) && is_plain(&of(Value::String(String::new()))));
        assert!(memory(66, &of(list(1000))) > 1000 * size_of::<Value>() as u64);
    }
}
