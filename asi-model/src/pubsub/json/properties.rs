//! Random messages survive every encoding.

use std::{collections::HashSet, sync::Arc};

use proptest::{collection::vec, option, prelude::*, sample::select};
use uuid::Uuid;

use super::*;
use crate::{
    MessageId,
    opcua_json::{
        Leniency,
        arbitrary::{
            arc_text, data_value, date_time, described, is_alike, namespace, node_id, variant,
        },
    },
    pubsub::*,
    values::{
        BuiltInType, DataValue, EnumType, EnumValue, LocalizedText, QualifiedName, Scalar,
        SimpleType, StatusCode, StructureKind, StructureType, Variant,
    },
};

fn message_id() -> impl Strategy<Value = Option<MessageId>> {
    option::of("[!-~]{1,40}".prop_map(|id| id.parse().expect("a message id")))
}

fn some_text() -> impl Strategy<Value = Option<Arc<str>>> {
    option::of(arc_text())
}

fn guid() -> impl Strategy<Value = Uuid> {
    any::<u128>().prop_map(Uuid::from_u128)
}

/// Fields of names that the metadata does not have.
fn fields(representation: FieldRepresentation) -> impl Strategy<Value = Vec<PayloadField>> {
    vec(data_value(variant()), 0..5).prop_map(move |values| {
        let values = values.into_iter().enumerate();
        values
            .map(|(number, value)| {
                PayloadField::with(format!("f{number}"), carried(value, representation))
            })
            .collect()
    })
}

/// The part of a value that the representation carries.
fn carried(value: DataValue, representation: FieldRepresentation) -> DataValue {
    match (representation, &value.value) {
        (FieldRepresentation::DataValue, _) => value,
        (_, _) if value.status.is_bad() => DataValue::status_only(value.status, None),
        // A status in a value's place is that of the field, and so is what a DataValue in a Variant
        // says.
        (_, Variant::Scalar(Scalar::StatusCode(_) | Scalar::DataValue(_))) => DataValue::default(),
        // Good is not written with its info bits where the value stands alone.
        (_, _) if value.status.is_good() => {
            DataValue { value: value.value, ..DataValue::default() }
        }
        (_, _) => DataValue { value: value.value, status: value.status, ..DataValue::default() },
    }
}

fn data_set_message() -> impl Strategy<Value = DataSetMessage> {
    let kinds =
        [DataSetMessageKind::KeyFrame, DataSetMessageKind::DeltaFrame, DataSetMessageKind::Event];
    let versions = option::of(any::<(u32, u32)>());
    let numbers = (option::of(any::<u16>()), option::of(any::<u32>()), versions, any::<u32>());
    let texts = (some_text(), some_text());
    let forms = select(vec![FieldRepresentation::Variant, FieldRepresentation::DataValue]);
    (numbers, texts, option::of(date_time()), select(kinds.to_vec()), forms).prop_flat_map(
        |(numbers, texts, timestamp, kind, representation)| {
            fields(representation).prop_map(move |fields| DataSetMessage {
                data_set_writer_id: numbers.0,
                data_set_writer_name: texts.0.clone(),
                publisher_id: None,
                writer_group_name: texts.1.clone(),
                sequence_number: numbers.1,
                meta_data_version: numbers.2.map(|(major, minor)| MetaDataVersion { major, minor }),
                minor_version: None,
                timestamp,
                status: StatusCode(numbers.3),
                kind,
                // Without a value that shows another form, the plain one is assumed.
                representation: if fields.is_empty() {
                    FieldRepresentation::Variant
                } else {
                    representation
                },
                fields,
            })
        },
    )
}

fn network_message() -> impl Strategy<Value = NetworkMessage> {
    let texts = (some_text(), some_text());
    (message_id(), texts, option::of(guid()), vec(data_set_message(), 0..3)).prop_map(
        |(message_id, (publisher_id, writer_group_name), data_set_class_id, messages)| {
            NetworkMessage {
                message_id,
                publisher_id,
                writer_group_name,
                data_set_class_id,
                messages,
            }
        },
    )
}

fn localized() -> impl Strategy<Value = LocalizedText> {
    (some_text(), some_text()).prop_map(|(locale, text)| LocalizedText { locale, text })
}

fn non_empty_text() -> impl Strategy<Value = Option<LocalizedText>> {
    option::of(
        (some_text(), arc_text())
            .prop_map(|(locale, text)| LocalizedText { locale, text: Some(text) }),
    )
}

fn enum_type() -> impl Strategy<Value = EnumType> {
    let value = (any::<i64>(), arc_text(), localized(), localized()).prop_map(
        |(value, name, display_name, description)| EnumValue {
            value,
            name,
            display_name,
            description,
        },
    );
    let built_in = select(vec![BuiltInType::Int32, BuiltInType::Byte, BuiltInType::UInt64]);
    (node_id(), arc_text(), built_in, vec(value, 0..4)).prop_map(
        |(type_id, name, built_in_type, values)| EnumType { type_id, name, built_in_type, values },
    )
}

fn simple_type() -> impl Strategy<Value = SimpleType> {
    (node_id(), arc_text(), node_id(), select(BuiltInType::ALL.to_vec())).prop_map(
        |(type_id, name, base_type, built_in_type)| SimpleType {
            type_id,
            name,
            base_type,
            built_in_type,
        },
    )
}

/// The described structures, one of them with fields of a described enumeration and of an alias.
fn structure_types(enum_types: &[EnumType], simple_types: &[SimpleType]) -> Vec<StructureType> {
    let mut types = described();
    let named = enum_types.iter().map(|known| (&known.type_id, known.built_in_type));
    let named = named.chain(simple_types.iter().map(|known| (&known.type_id, known.built_in_type)));
    let fields =
        named.enumerate().map(|(number, (id, built_in_type))| crate::values::StructureField {
            data_type: id.clone(),
            description: (number % 2 == 0).then(|| LocalizedText {
                locale: Some("en".into()),
                text: Some(format!("what f{number} means").into()),
            }),
            array_dimensions: vec![0; number % 3],
            max_string_length: u32::try_from(number).expect("few"),
            ..crate::values::StructureField::scalar(&format!("f{number}"), built_in_type)
        });
    types.push(StructureType {
        type_id: crate::NodeId::string("urn:types", "Named"),
        encoding_ids: vec![crate::NodeId::string("urn:types", "NamedJson")],
        name: "Named".into(),
        kind: StructureKind::Plain,
        fields: fields.collect(),
    });
    types
}

fn field() -> impl Strategy<Value = FieldMetaData> {
    let shape = (
        select(BuiltInType::ALL.to_vec()),
        node_id(),
        -3_i32..4,
        vec(any::<u32>(), 0..3),
        any::<u32>(),
    );
    let name = (namespace(), arc_text())
        .prop_map(|(namespace, name)| QualifiedName { namespace, name: Some(name) });
    (arc_text(), non_empty_text(), any::<bool>(), shape, guid(), vec((name, variant()), 0..3))
        .prop_map(|(name, description, is_promoted, shape, data_set_field_id, properties)| {
            let (built_in_type, data_type, value_rank, array_dimensions, max_string_length) = shape;
            FieldMetaData {
                name,
                description,
                is_promoted,
                built_in_type,
                data_type,
                value_rank,
                array_dimensions,
                max_string_length,
                data_set_field_id,
                properties,
            }
        })
}

fn meta_data() -> impl Strategy<Value = DataSetMetaData> {
    let uris =
        vec("urn:[a-z]{1,8}", 0..4).prop_map(|uris| uris.into_iter().map(Arc::from).collect());
    // Two types of one id would leave it open which of them a structure's field has.
    let types = (vec(enum_type(), 0..3), vec(simple_type(), 0..3)).prop_filter(
        "each type has an id of its own",
        |(enum_types, simple_types)| {
            let ids = enum_types.iter().map(|known| &known.type_id);
            let ids: HashSet<_> =
                ids.chain(simple_types.iter().map(|known| &known.type_id)).collect();
            ids.len() == enum_types.len() + simple_types.len()
        },
    );
    (
        arc_text(),
        non_empty_text(),
        uris,
        types,
        vec(field(), 0..4),
        option::of(guid()),
        any::<(u32, u32)>(),
    )
        .prop_map(
            |(
                name,
                description,
                namespaces,
                (enum_types, simple_types),
                fields,
                class,
                (major, minor),
            )| DataSetMetaData {
                name,
                description,
                namespaces,
                structure_types: structure_types(&enum_types, &simple_types),
                enum_types,
                simple_types,
                fields,
                data_set_class_id: class,
                configuration_version: MetaDataVersion { major, minor },
            },
        )
}

/// Knows the structures, and the fields' types not.
struct Structures(DataSetMetaData);

impl MetaDataLookup for Structures {
    fn meta_data(&self, _: Option<&str>, _: Option<u16>) -> Option<&DataSetMetaData> {
        Some(&self.0)
    }
}

/// The metadata of a message's fields as they are.
fn described_as(message: &DataSetMessage) -> DataSetMetaData {
    let fields = message.fields.iter().map(|field| {
        let value = &field.value.value;
        let built_in_type = value.built_in_type().unwrap_or(BuiltInType::Double);
        let mut known = FieldMetaData::new(Arc::clone(&field.name), built_in_type, Uuid::nil());
        if let Variant::Array(array) = value {
            let dimensions = array.dimensions.as_ref().map_or(1, Vec::len);
            known.value_rank = i32::try_from(dimensions).expect("few");
        }
        known
    });
    DataSetMetaData {
        fields: fields.collect(),
        structure_types: described(),
        ..DataSetMetaData::default()
    }
}

/// A null text, name or ByteString without its type is null alone.
fn without_null_type(value: DataValue, representation: FieldRepresentation) -> DataValue {
    let is_null = match &value.value {
        Variant::Scalar(
            Scalar::String(None) | Scalar::XmlElement(None) | Scalar::ByteString(None),
        ) => true,
        Variant::Scalar(Scalar::QualifiedName(name)) => name.name.is_none(),
        _ => false,
    };
    let stands_alone = representation == FieldRepresentation::DataValue || value.status.is_good();
    if is_null && stands_alone { DataValue { value: Variant::Null, ..value } } else { value }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn data_reads_back(message in network_message()) {
        let known = Structures(DataSetMetaData { structure_types: described(), ..DataSetMetaData::default() });
        for encoding in [Encoding::Digicor, Encoding::Compact105] {
            let text = encode_described(&message, encoding, &known);
            let decoded = decode_described(&text, Leniency::Strict, &known)
                .map_err(|error| TestCaseError::fail(format!("{error}: {}", String::from_utf8_lossy(&text))))?;
            prop_assert_eq!(&decoded.diagnostics, &[]);
            let expected = PubSubMessage::Data(message.clone());
            prop_assert!(is_alike(&decoded.message, &expected), "{}: {:?}", encoding, decoded.message);
        }
    }

    /// Verbose leaves types to the metadata, and with them whether a value stood for itself or in a Variant.
    #[test]
    fn verbose_data_reads_back_with_its_metadata(message in data_set_message()) {
        let known = described_as(&message);
        let message = NetworkMessage { messages: vec![message], ..NetworkMessage::default() };
        let text = encode_described(&message, Encoding::Verbose105, &known);
        let shown = String::from_utf8_lossy(&text);
        let decoded = decode_described(&text, Leniency::Strict, &known)
            .map_err(|error| TestCaseError::fail(format!("{error}: {shown}")))?;
        prop_assert_eq!(&decoded.diagnostics, &[], "{}", shown);
        let PubSubMessage::Data(found) = decoded.message else {
            return Err(TestCaseError::fail("no data"));
        };
        let mut expected = message;
        let part = &mut expected.messages[0];
        let form = part.representation;
        for field in &mut part.fields {
            field.value = without_null_type(std::mem::take(&mut field.value), form);
        }
        if form == FieldRepresentation::Variant {
            part.representation = found.messages[0].representation;
        }
        prop_assert!(is_alike(&found, &expected), "{}: {:?}", shown, found);
    }

    #[test]
    fn wrapped_parts_equal_the_whole_message(message in network_message()) {
        for encoding in Encoding::ALL {
            let parts = message.messages.iter().map(|part| encode_data_set_message(part, encoding));
            let wrapped = NetworkMessageHeader::from(&message).wrap(parts);
            prop_assert_eq!(wrapped, encode(&message, encoding), "{}", encoding);
        }
    }

    #[test]
    fn metadata_reads_back(id in message_id(), texts in (some_text(), some_text(), some_text()), writer: u16,
        time in option::of(date_time()), known in meta_data()) {
        let message = MetaDataMessage {
            message_id: id,
            publisher_id: texts.0,
            data_set_writer_id: writer,
            writer_group_name: texts.1,
            data_set_writer_name: texts.2,
            timestamp: time,
            meta_data: known,
        };
        for encoding in Encoding::ALL {
            let text = encode_meta_data(&message, encoding);
            let decoded = decode_described(&text, Leniency::Strict, &())
                .map_err(|error| TestCaseError::fail(format!("{error}: {}", String::from_utf8_lossy(&text))))?;
            prop_assert_eq!(&decoded.diagnostics, &[]);
            let expected = PubSubMessage::MetaData(Box::new(message.clone()));
            prop_assert!(is_alike(&decoded.message, &expected), "{}: {:?}", encoding, decoded.message);
        }
    }
}
