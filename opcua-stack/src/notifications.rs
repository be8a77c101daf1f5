//! Data change notifications (OPC 10000-4 §7.25.2) decoded straight into our values.
//!
//! The stack decodes each number of a message by itself and each time into a calendar date; here a
//! body is read once, and numbers and times are taken from it as they are. Whatever is no plain
//! number is left to the stack.

use std::{any::Any, io::Read, sync::Arc};

use asi_model::values as model;
use opcua::types::{
    self as stack, BinaryDecodable, Context, DynEncodable, EncodingResult, Error, ExpandedNodeId,
    ExtensionObject, NodeId, ObjectId, TypeLoader, TypeLoaderCollection, TypeLoaderPriority,
};

use crate::{NamespaceTable, values::from_stack};

/// Id of the binary encoding of a DataChangeNotification.
const BINARY_ID: ObjectId = ObjectId::DataChangeNotification_Encoding_DefaultBinary;
/// The shortest notification of an item: its handle and an empty data value.
const ITEM_BYTES_MIN: usize = 5;
/// Elements of a body that are believed before they are there.
const TRUSTED_BYTES: usize = 1 << 20;

// The encoding mask of a data value (OPC 10000-6 §5.2.2.17).
const HAS_VALUE: u8 = 0x01;
const HAS_STATUS: u8 = 0x02;
const HAS_SOURCE_TIMESTAMP: u8 = 0x04;
const HAS_SERVER_TIMESTAMP: u8 = 0x08;
const HAS_SOURCE_PICOSECONDS: u8 = 0x10;
const HAS_SERVER_PICOSECONDS: u8 = 0x20;

/// New values by the client handles of their items, in the order of the message.
#[derive(Debug, Clone, PartialEq)]
pub struct DataChanges {
    items: Vec<(u32, Notified)>,
}

#[derive(Debug, Clone, PartialEq)]
enum Notified {
    Number(model::DataValue),
    /// Needs the peer's namespaces and data types.
    Other(Box<stack::DataValue>),
}

impl DataChanges {
    /// The changes in a notification, also in one that the stack has decoded.
    ///
    /// # Errors
    /// The notification, where it is another one.
    pub fn take(notification: ExtensionObject) -> Result<Self, ExtensionObject> {
        if notification.inner_is::<Self>() {
            return Ok(*notification.into_inner_as().expect("it was just seen"));
        }
        if !notification.inner_is::<stack::DataChangeNotification>() {
            return Err(notification);
        }
        let decoded: Box<stack::DataChangeNotification> =
            notification.into_inner_as().expect("it was just seen");
        let items = decoded.monitored_items.into_iter().flatten();
        Ok(Self {
            items: items
                .map(|item| (item.client_handle, Notified::Other(Box::new(item.value))))
                .collect(),
        })
    }

    /// The values; those that cannot be understood are `BadDecodingError` with the times kept.
    #[must_use]
    pub fn into_values(self, namespaces: &NamespaceTable) -> Vec<(u32, model::DataValue)> {
        let value = |notified| match notified {
            Notified::Number(value) => value,
            Notified::Other(value) => from_stack(*value, namespaces),
        };
        self.items.into_iter().map(|(handle, notified)| (handle, value(notified))).collect()
    }
}

/// Makes a session decode data changes as [`DataChanges`] from now on.
pub fn decode_data_changes(loaders: &mut TypeLoaderCollection) {
    // The first that knows a type decodes it: all others come after ours.
    let mut ours = TypeLoaderCollection::new_empty();
    ours.add(Arc::new(DataChangeLoader));
    for other in &*loaders {
        ours.add(Arc::clone(other));
    }
    *loaders = ours;
}

struct DataChangeLoader;

impl TypeLoader for DataChangeLoader {
    fn load_from_binary(
        &self,
        node_id: &NodeId,
        stream: &mut dyn Read,
        context: &Context<'_>,
        length: Option<usize>,
    ) -> Option<EncodingResult<Box<dyn DynEncodable>>> {
        if node_id.namespace != 0 || node_id.as_u32() != Some(BINARY_ID as u32) {
            return None;
        }
        Some(
            read_body(stream, length?)
                .and_then(|body| decode(&body, context))
                .map(|changes| Box::new(changes) as _),
        )
    }

    fn priority(&self) -> TypeLoaderPriority {
        TypeLoaderPriority::Core
    }
}

fn read_body(stream: &mut dyn Read, length: usize) -> EncodingResult<Vec<u8>> {
    let mut body = Vec::with_capacity(length.min(TRUSTED_BYTES));
    stream.take(length as u64).read_to_end(&mut body)?;
    if body.len() == length { Ok(body) } else { Err(ended()) }
}

fn ended() -> Error {
    Error::decoding("a notification ends too early")
}

fn decode(mut body: &[u8], context: &Context<'_>) -> EncodingResult<DataChanges> {
    // A negative length is that of an array that is not there.
    let count = usize::try_from(i32::from_le_bytes(take(&mut body)?)).unwrap_or(0);
    if count > context.options().max_array_length {
        return Err(Error::new(
            stack::StatusCode::BadEncodingLimitsExceeded,
            "a notification has more values than an array may have",
        ));
    }
    let expected = count.min(body.len() / ITEM_BYTES_MIN);
    context.options().take_memory(expected * size_of::<(u32, Notified)>())?;
    let mut items = Vec::with_capacity(expected);
    for _ in 0..count {
        let handle = u32::from_le_bytes(take(&mut body)?);
        items.push((handle, notified(&mut body, context)?));
    }
    // What follows are diagnostics, which nobody asked for.
    Ok(DataChanges { items })
}

fn notified(body: &mut &[u8], context: &Context<'_>) -> EncodingResult<Notified> {
    let whole = *body;
    let [mask] = take(body)?;
    let Some(value) =
        (if mask & HAS_VALUE == 0 { Some(model::Variant::Null) } else { number(body)? })
    else {
        *body = whole;
        context.options().take_memory(size_of::<stack::DataValue>())?;
        return Ok(Notified::Other(Box::new(stack::DataValue::decode(body, context)?)));
    };
    let has = |bit| mask & bit != 0;
    let status = if has(HAS_STATUS) { u32::from_le_bytes(take(body)?) } else { 0 };
    let source_timestamp = has(HAS_SOURCE_TIMESTAMP).then(|| time(body)).transpose()?;
    let source_picoseconds =
        if has(HAS_SOURCE_PICOSECONDS) { u16::from_le_bytes(take(body)?) } else { 0 };
    let server_timestamp = has(HAS_SERVER_TIMESTAMP).then(|| time(body)).transpose()?;
    let server_picoseconds =
        if has(HAS_SERVER_PICOSECONDS) { u16::from_le_bytes(take(body)?) } else { 0 };
    Ok(Notified::Number(model::DataValue {
        value,
        status: model::StatusCode(status),
        source_timestamp,
        // Without their time they mean nothing.
        source_picoseconds: if source_timestamp.is_some() { source_picoseconds } else { 0 },
        server_timestamp,
        server_picoseconds: if server_timestamp.is_some() { server_picoseconds } else { 0 },
    }))
}

/// A plain number; `None` where the variant is anything else.
fn number(body: &mut &[u8]) -> EncodingResult<Option<model::Variant>> {
    use model::Scalar;
    let [encoding] = take(body)?;
    Ok(Some(model::Variant::Scalar(match encoding {
        1 => Scalar::Boolean(take::<1>(body)? != [0]),
        2 => Scalar::SByte(i8::from_le_bytes(take(body)?)),
        3 => Scalar::Byte(u8::from_le_bytes(take(body)?)),
        4 => Scalar::Int16(i16::from_le_bytes(take(body)?)),
        5 => Scalar::UInt16(u16::from_le_bytes(take(body)?)),
        6 => Scalar::Int32(i32::from_le_bytes(take(body)?)),
        7 => Scalar::UInt32(u32::from_le_bytes(take(body)?)),
        8 => Scalar::Int64(i64::from_le_bytes(take(body)?)),
        9 => Scalar::UInt64(u64::from_le_bytes(take(body)?)),
        10 => Scalar::Float(f32::from_le_bytes(take(body)?)),
        11 => Scalar::Double(f64::from_le_bytes(take(body)?)),
        _ => return Ok(None),
    })))
}

fn time(body: &mut &[u8]) -> EncodingResult<model::DateTime> {
    Ok(model::DateTime::from_ticks(i64::from_le_bytes(take(body)?)))
}

fn take<const N: usize>(body: &mut &[u8]) -> EncodingResult<[u8; N]> {
    let (taken, rest) = body.split_first_chunk().ok_or_else(ended)?;
    *body = rest;
    Ok(*taken)
}

/// Decoded only: a client never sends notifications.
impl DynEncodable for DataChanges {
    fn encode_binary(
        &self,
        _stream: &mut dyn std::io::Write,
        _context: &Context<'_>,
    ) -> EncodingResult<()> {
        Err(Error::encoding("received notifications are not sent on"))
    }

    fn byte_len_dyn(&self, _context: &Context<'_>) -> usize {
        0
    }

    fn binary_type_id(&self) -> ExpandedNodeId {
        BINARY_ID.into()
    }

    fn data_type_id(&self) -> ExpandedNodeId {
        stack::DataTypeId::DataChangeNotification.into()
    }

    fn as_dyn_any(self: Box<Self>) -> Box<dyn Any + Send + Sync + 'static> {
        self
    }

    fn as_dyn_any_ref(&self) -> &(dyn Any + Send + Sync) {
        self
    }

    fn clone_box(&self) -> Box<dyn DynEncodable> {
        Box::new(self.clone())
    }

    fn dyn_eq(&self, other: &dyn DynEncodable) -> bool {
        other.as_dyn_any_ref().downcast_ref::<Self>() == Some(self)
    }

    fn type_name(&self) -> &'static str {
        std::any::type_name::<Self>()
    }

    fn override_encoding(&self) -> Option<stack::BuiltInDataEncoding> {
        None
    }
}

#[cfg(test)]
mod tests {
    use opcua::types::{
        BinaryEncodable as _, ContextOwned, DataChangeNotification, DataValue, DecodingOptions,
        LocalizedText, MonitoredItemNotification, NamespaceMap, StatusCode, Variant,
    };

    use super::*;

    fn context() -> ContextOwned {
        let mut context = ContextOwned::new_default(NamespaceMap::new(), DecodingOptions::test());
        decode_data_changes(context.loaders_mut());
        context
    }

    fn time(ticks: i64) -> Option<stack::DateTime> {
        Some(stack::DateTime::from(ticks))
    }

    /// One of each kind that a server may send.
    fn values() -> Vec<DataValue> {
        let good = |value: Variant| DataValue { value: Some(value), ..DataValue::null() };
        let timed = |value: Variant, ticks| DataValue {
            status: Some(StatusCode::UncertainLastUsableValue),
            source_timestamp: time(ticks),
            source_picoseconds: Some(9_999),
            server_timestamp: time(ticks.saturating_add(7)),
            server_picoseconds: Some(1),
            ..good(value)
        };
        vec![
            good(Variant::Boolean(true)),
            good(Variant::SByte(-3)),
            good(Variant::Byte(250)),
            good(Variant::Int16(-30_000)),
            good(Variant::UInt16(60_000)),
            good(Variant::Int32(i32::MIN)),
            good(Variant::UInt32(u32::MAX)),
            timed(Variant::Int64(i64::MIN), 133_000_000_000_000_001),
            timed(Variant::UInt64(u64::MAX), 1),
            timed(Variant::Float(1.5), i64::MAX),
            timed(Variant::Double(-2.25), -5),
            timed(Variant::from("text"), 132_000_000_000_000_000),
            good(Variant::from(LocalizedText::new("de", "Fr\u{e4}se"))),
            good(Variant::from(vec![1_i32, 2, 3])),
            timed(Variant::Empty, 132_000_000_000_000_000),
            DataValue { status: Some(StatusCode::BadNotConnected), ..DataValue::null() },
            DataValue {
                source_picoseconds: Some(5),
                server_picoseconds: Some(6),
                ..DataValue::null()
            },
            DataValue::null(),
        ]
    }

    fn notification(values: Vec<DataValue>) -> ExtensionObject {
        let item = |(client_handle, value)| MonitoredItemNotification { client_handle, value };
        let items = (7_u32..).zip(values).map(item).collect();
        ExtensionObject::new(DataChangeNotification {
            monitored_items: Some(items),
            diagnostic_infos: None,
        })
    }

    #[test]
    fn values_are_those_that_the_stack_decodes() {
        let context = context();
        let bytes = notification(values()).encode_to_vec(&context.context());
        let decoded =
            ExtensionObject::decode(&mut bytes.as_slice(), &context.context()).expect("decoded");
        let namespaces = NamespaceTable::new(["http://opcfoundation.org/UA/"]);
        let found = DataChanges::take(decoded).expect("data changes").into_values(&namespaces);

        let plain = ContextOwned::new_default(NamespaceMap::new(), DecodingOptions::test());
        let decoded =
            ExtensionObject::decode(&mut bytes.as_slice(), &plain.context()).expect("decoded");
        let taken =
            DataChanges::take(decoded.clone()).expect("data changes").into_values(&namespaces);
        let expected = decoded.into_inner_as::<DataChangeNotification>().expect("the stack's own");
        let expected = expected.monitored_items.into_iter().flatten();
        let expected: Vec<_> = expected
            .map(|item| (item.client_handle, from_stack(item.value, &namespaces)))
            .collect();
        assert_eq!(found, expected);
        assert_eq!(taken, expected, "both decoders yield the same");
        assert_eq!(found.len(), values().len());
    }

    #[test]
    fn a_body_that_ends_anywhere_is_an_error() {
        let context = context();
        let bytes = notification(values()).encode_to_vec(&context.context());
        // Before the body stand the id, the encoding and the length.
        let body = &bytes[9..];
        let needed = body.len() - 4;
        for end in 0..needed {
            assert!(decode(&body[..end], &context.context()).is_err(), "{end} of {needed} bytes");
        }
        assert!(decode(&body[..needed], &context.context()).is_ok(), "diagnostics are not needed");
        assert!(read_body(&mut &body[..10], 11).is_err());
    }

    #[test]
    fn lengths_are_not_believed() {
        let context = context();
        let too_many = i32::MAX.to_le_bytes();
        let problem =
            decode(&too_many, &context.context()).expect_err("more than an array may have");
        assert_eq!(problem.status(), StatusCode::BadEncodingLimitsExceeded);
        assert_eq!(decode(&(-1_i32).to_le_bytes(), &context.context()).expect("none").items, []);
        assert!(read_body(&mut std::io::empty(), usize::MAX >> 1).is_err());
    }

    #[test]
    fn other_notifications_are_left_alone() {
        let other = ExtensionObject::new(stack::StatusChangeNotification::default());
        assert!(
            DataChanges::take(other)
                .is_err_and(|other| other.inner_is::<stack::StatusChangeNotification>())
        );
        assert!(DataChanges::take(ExtensionObject::null()).is_err());
    }
}
