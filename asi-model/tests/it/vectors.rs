//! Values of every type for foreign decoders, the same on every run.

use std::sync::Arc;

use asi_model::{
    BuiltInType, DataValue, DateTime, NodeId, Scalar, StatusCode, Variant, units,
    values::{
        Array, DiagnosticInfo, ExpandedNodeId, ExtensionBody, ExtensionObject, Identifier,
        LocalizedText, Namespace, QualifiedName, Server, StructureValue,
    },
};

/// The namespaces that indexes in the vectors refer to.
pub fn namespaces() -> Vec<Arc<str>> {
    vec!["urn:one".into(), "urn:two".into()]
}

/// A generator of repeatable numbers (splitmix64).
pub struct Numbers(pub u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
}

fn texts() -> [&'static str; 6] {
    ["", "x", "MakeFrame1", "ü € 😀", "line\nbreak\t\"quoted\" \\ /", "\u{1}\u{7f}"]
}

#[allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap)] // Any bits will do.
pub fn scalars(numbers: &mut Numbers) -> Vec<Scalar> {
    let mut all = vec![
        Scalar::Boolean(true),
        Scalar::Boolean(false),
        Scalar::String(None),
        Scalar::DateTime("2019-03-26T18:28:54.2940194Z".parse().unwrap()),
        // Not the epoch of Unix itself, which open62541 reads two seconds late.
        Scalar::DateTime("1970-01-02T00:00:00Z".parse().unwrap()),
        Scalar::Double(f64::NAN),
        Scalar::Double(f64::INFINITY),
        Scalar::Float(f32::NEG_INFINITY),
        Scalar::Double(f64::MIN_POSITIVE),
        Scalar::Double(1.797e308),
        Scalar::StatusCode(StatusCode::GOOD),
        Scalar::StatusCode(StatusCode::BAD_NOT_CONNECTED),
        // An empty one it takes for null.
        Scalar::ByteString(Some(Arc::from(*b"abc"))),
        Scalar::ExtensionObject(Box::new(range(0.0, 359.99))),
        Scalar::ExtensionObject(Box::new(units::lookup("PIECE").unwrap().to_extension_object())),
    ];
    for value in [i64::MIN, i64::MAX, 0, -1, 1 << 53] {
        all.extend([
            Scalar::Int64(value),
            Scalar::UInt64(value as u64),
            Scalar::Int32(value as i32),
            Scalar::UInt32(value as u32),
            Scalar::Int16(value as i16),
            Scalar::UInt16(value as u16),
            Scalar::SByte(value as i8),
            Scalar::Byte(value as u8),
        ]);
    }
    for text in texts() {
        all.push(text.into());
        all.push(Scalar::XmlElement(Some(text.into())));
        if text.is_empty() {
            // node-opcua-json takes empty texts inside structured values for null.
            continue;
        }
        all.push(Scalar::LocalizedText(Box::new(LocalizedText {
            locale: Some("en".into()),
            text: Some(text.into()),
        })));
        all.push(Scalar::QualifiedName(Box::new(QualifiedName {
            namespace: Namespace::uri("urn:two"),
            name: Some(text.into()),
        })));
    }
    for _ in 0..40 {
        all.extend(random(numbers));
    }
    all
}

/// Scalars of most types from the next numbers.
#[allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap)] // Any bits will do.
fn random(numbers: &mut Numbers) -> [Scalar; 12] {
    let bits = numbers.next();
    let id = match bits % 4 {
        0 => Identifier::Numeric(bits as u32),
        1 => Identifier::String(format!("Node {bits}").into()),
        2 => Identifier::Guid(uuid::Uuid::from_u64_pair(bits, numbers.next())),
        _ => Identifier::Opaque(bits.to_be_bytes().as_slice().into()),
    };
    let namespace = if bits & 16 == 0 { Namespace::Ua } else { Namespace::uri("urn:one") };
    let node_id = NodeId { namespace, identifier: id };
    let number = f64::from_bits(numbers.next());
    [
        Scalar::UInt64(bits),
        Scalar::Int64(bits as i64),
        Scalar::Double(if number.is_nan() { 0.1 } else { number }),
        Scalar::Float((bits as i32 as f32) / 1000.0),
        Scalar::DateTime(DateTime::from_ticks(
            125_000_000_000_000_000 + (bits % 20_000_000_000_000_000) as i64,
        )),
        Scalar::Guid(uuid::Uuid::from_u64_pair(bits, numbers.next())),
        Scalar::ByteString(Some(bits.to_le_bytes()[..1 + (bits % 7) as usize].into())),
        Scalar::ExpandedNodeId(Box::new(ExpandedNodeId {
            node_id: node_id.clone(),
            server: Server::Local,
        })),
        Scalar::NodeId(Box::new(node_id)),
        Scalar::DataValue(Box::new(DataValue::good(
            number_of(bits),
            DateTime::from_ticks(132_000_000_000_000_000 + (bits % 1_000_000_000) as i64),
        ))),
        Scalar::DiagnosticInfo(Box::new(DiagnosticInfo {
            symbolic_id: Some((bits % 100) as i32),
            locale: (bits & 1 == 0).then_some((bits % 7) as i32),
            additional_info: (bits & 2 == 0).then(|| format!("Info {bits}").into()),
            inner_status_code: (bits & 4 == 0).then_some(StatusCode::BAD_TIMEOUT),
            ..DiagnosticInfo::default()
        })),
        // It knows the standard's codes only.
        Scalar::StatusCode(
            [StatusCode::BAD_TIMEOUT, StatusCode::GOOD_CLAMPED, StatusCode::UNCERTAIN]
                [bits as usize % 3],
        ),
    ]
}

/// A value of one type or another.
fn number_of(bits: u64) -> Variant {
    match bits % 3 {
        0 => bits.into(),
        1 => 1.5.into(),
        _ => "text".into(),
    }
}

pub fn range(low: f64, high: f64) -> ExtensionObject {
    let mut structure = StructureValue::default();
    structure.fields.insert("Low".into(), low.into());
    structure.fields.insert("High".into(), high.into());
    ExtensionObject { type_id: NodeId::ua(884).into(), body: ExtensionBody::Structure(structure) }
}

pub fn variants(scalars: &[Scalar]) -> Vec<Variant> {
    let mut all: Vec<Variant> = scalars.iter().cloned().map(Variant::Scalar).collect();
    for built_in_type in BuiltInType::ALL {
        let elements: Vec<Scalar> = scalars
            .iter()
            .filter(|scalar| scalar.built_in_type() == built_in_type)
            .take(6)
            .cloned()
            .collect();
        if elements.len() < 4 {
            continue;
        }
        for (count, dimensions) in [(3, None), (4, Some(vec![2, 2]))] {
            let elements = elements[..count].to_vec();
            all.push(Variant::Array(Arc::new(Array {
                element_type: built_in_type,
                elements,
                dimensions,
            })));
        }
    }
    let mixed = scalars
        .iter()
        .step_by(7)
        .map(|scalar| Scalar::Variant(Box::new(Variant::Scalar(scalar.clone()))));
    all.push(Variant::Array(Arc::new(Array {
        element_type: BuiltInType::Variant,
        elements: mixed.collect(),
        dimensions: None,
    })));
    all
}
