//! Reading dynamic data requests and report formats, with the rules on their fields.

use std::collections::HashSet;

use super::{
    FaultCode, LIST_MAX,
    lists::{not_empty, recipients},
    reader::Reader,
};
use crate::{
    ids::FieldName,
    json::{JsonNode, Kind},
    network::{
        DynamicDataRequest, FieldType, ReportDataFormat, ReportField, Semantic,
        UpdateFrequencyUnit, VALUE_RANK_SCALAR,
    },
    pubsub::{ReportHeader, measured_field},
    units,
    values::BuiltInType,
};

/// Most dimensions of a field.
const DIMENSIONS_MAX: i32 = 8;

const FREQUENCY_UNITS: [(&str, UpdateFrequencyUnit); 5] = [
    ("SECOND", UpdateFrequencyUnit::Second),
    ("MINUTE", UpdateFrequencyUnit::Minute),
    ("HOUR", UpdateFrequencyUnit::Hour),
    ("DAY", UpdateFrequencyUnit::Day),
    ("WEEK", UpdateFrequencyUnit::Week),
];

pub(super) fn request(reader: &mut Reader, node: JsonNode<'_, '_>) -> Option<DynamicDataRequest> {
    if !reader.is_object(node, "A dynamic data request") {
        return Some(unreadable(reader));
    }
    let format = reader.required(node, "reportDataFormat", format);
    Some(DynamicDataRequest {
        dynamic_data_request_id: reader.required_id(node, "dynamicDataRequestId"),
        dynamic_data_request_publisher_id: reader.optional(
            node,
            "dynamicDataRequestPublisherId",
            Reader::id,
        ),
        requester_id: reader.required_id(node, "requesterId"),
        recipient_list: recipients(reader, node),
        purpose: reader.required(node, "purpose", Reader::non_empty_text).unwrap_or_default(),
        valid_from: reader.optional(node, "validFrom", Reader::time),
        valid_until: reader.optional(node, "validUntil", Reader::time),
        description: reader.optional(node, "description", Reader::text),
        buffer_id: reader.optional(node, "bufferId", Reader::name),
        update_frequency: reader.optional(node, "updateFrequency", |reader, node| {
            let frequency =
                reader.integer(node, "how often per unit, as a number from 1 to 4294967295")?;
            if frequency == 0 {
                reader.fault(
                    node,
                    FaultCode::InvalidValue,
                    "The update frequency must be at least 1.",
                );
            }
            Some(frequency)
        }),
        update_frequency_unit: reader.optional(node, "updateFrequencyUnit", |reader, node| {
            reader.choice(node, &FREQUENCY_UNITS)
        }),
        report_data_format: format.unwrap_or_else(no_format),
    })
}

/// A request that stands for something else in the list.
fn unreadable(reader: &mut Reader) -> DynamicDataRequest {
    DynamicDataRequest {
        dynamic_data_request_id: reader.placeholder(),
        dynamic_data_request_publisher_id: None,
        requester_id: reader.placeholder(),
        recipient_list: Vec::new(),
        purpose: String::new(),
        valid_from: None,
        valid_until: None,
        description: None,
        buffer_id: None,
        update_frequency: None,
        update_frequency_unit: None,
        report_data_format: no_format(),
    }
}

const fn no_format() -> ReportDataFormat {
    ReportDataFormat { report_name: String::new(), report_field_list: Vec::new() }
}

fn format(reader: &mut Reader, node: JsonNode<'_, '_>) -> Option<ReportDataFormat> {
    if !reader.is_object(node, "A report data format") {
        return None;
    }
    let report_name = reader.required(node, "reportName", |reader, node| {
        let name = reader.name(node)?;
        if name.trim().is_empty() {
            reader.fault(node, FaultCode::InvalidValue, "The report needs a name.");
        }
        Some(name)
    });
    not_empty(reader, node, "reportFieldList");
    Some(ReportDataFormat {
        report_name: report_name.unwrap_or_default(),
        report_field_list: reader.list(node, "reportFieldList", LIST_MAX, field),
    })
}

fn field(reader: &mut Reader, node: JsonNode<'_, '_>) -> Option<ReportField> {
    if !reader.is_object(node, "A report field") {
        return Some(ReportField {
            name: reader.placeholder(),
            field_type: FieldType(BuiltInType::Variant),
            value_rank: VALUE_RANK_SCALAR,
            description: None,
            unit: None,
            semantic: None,
        });
    }
    let field_type = reader.required(node, "type", field_type);
    let semantic = reader.optional(node, "semantic", |reader, node| {
        reader.parsed::<Semantic>(node, "a semantic as PRODUCED_QUANTITY, or an IRI")
    });
    Some(ReportField {
        name: reader.required_id(node, "name"),
        field_type: FieldType(field_type.unwrap_or(BuiltInType::Variant)),
        value_rank: reader
            .optional(node, "valueRank", |reader, node| {
                reader.integer(node, "a value rank as a number")
            })
            .unwrap_or(VALUE_RANK_SCALAR),
        description: reader.optional(node, "description", Reader::text),
        unit: reader.optional(node, "unit", Reader::name),
        // Whether an unreadable type fits cannot be judged.
        semantic: semantic.filter(|_| field_type.is_some()),
    })
}

fn field_type(reader: &mut Reader, node: JsonNode<'_, '_>) -> Option<BuiltInType> {
    let found = match node.kind() {
        Kind::Number => node.integer().and_then(BuiltInType::from_id),
        _ => node.text().and_then(|name| name.parse().ok()),
    };
    if found.is_none() {
        reader.fault(
            node,
            FaultCode::UnknownType,
            "The type must be an OPC UA built-in type: an id from 1 to 25 or a name as UInt64.",
        );
    }
    found
}

/// The rules on a request that its structure does not express.
pub(super) fn check(request: &DynamicDataRequest, pointer: &str, reader: &mut Reader) {
    if let (Some(from), Some(until)) = (request.valid_from, request.valid_until)
        && from >= until
    {
        let message = "The request ends before it begins: validUntil must be later than validFrom.";
        reader.faults.push(format!("{pointer}/validUntil"), FaultCode::TimeFrameInverted, message);
    }
    if request.update_frequency.is_some() != request.update_frequency_unit.is_some() {
        let missing = if request.update_frequency.is_some() {
            "updateFrequencyUnit"
        } else {
            "updateFrequency"
        };
        reader.faults.push(
            format!("{pointer}/{missing}"),
            FaultCode::UpdateFrequencyIncomplete,
            "updateFrequency and updateFrequencyUnit must be given together.",
        );
    }
    check_fields(&request.report_data_format.report_field_list, pointer, reader);
}

fn check_fields(fields: &[ReportField], pointer: &str, reader: &mut Reader) {
    let names: HashSet<&str> = fields.iter().map(|field| field.name.as_str()).collect();
    let mut seen: HashSet<&FieldName> = HashSet::new();
    for (index, field) in fields.iter().enumerate() {
        let place =
            |member: &str| format!("{pointer}/reportDataFormat/reportFieldList/{index}/{member}");
        let name = field.name.as_str();
        if !seen.insert(&field.name) {
            let message = format!("The report already has a field {name}.");
            reader.faults.push(place("name"), FaultCode::DuplicateField, message);
        }
        if ReportHeader::is_member(name) {
            let message =
                format!("Every report has a member {name} of its own; choose another name.");
            reader.faults.push(place("name"), FaultCode::ReservedFieldName, message);
        }
        if let Some(measured) = measured_field(name).filter(|measured| names.contains(measured)) {
            let message =
                format!("{name} is the unit member of the field {measured}; choose another name.");
            reader.faults.push(place("name"), FaultCode::UnitFieldCollision, message);
        }
        if field.value_rank != VALUE_RANK_SCALAR
            && !(1..=DIMENSIONS_MAX).contains(&field.value_rank)
        {
            let message = format!(
                "The value rank must be -1 (single value) or 1 to {DIMENSIONS_MAX} (dimensions)."
            );
            reader.faults.push(place("valueRank"), FaultCode::InvalidValueRank, message);
        }
        if let Some(unit) = &field.unit {
            check_unit(unit, || place("unit"), reader);
        }
        check_semantic(field, place("semantic"), reader);
    }
}

/// A unit by its code or alias.
pub(super) fn check_unit(unit: &str, pointer: impl FnOnce() -> String, reader: &mut Reader) {
    if units::lookup(unit).is_none() {
        let message = format!(
            "The unit {unit} is not known: \
             use a UNECE Recommendation 20 code as H87, or its name as PIECE."
        );
        reader.faults.push(pointer(), FaultCode::UnknownUnit, message);
    }
}

fn check_semantic(field: &ReportField, pointer: String, reader: &mut Reader) {
    use BuiltInType as T;
    let Some(semantic) = &field.semantic else { return };
    let field_type = field.field_type.0;
    let (fits, wanted) = match semantic {
        Semantic::ProducedQuantity
        | Semantic::GoodQuantity
        | Semantic::ScrapQuantity
        | Semantic::PercentComplete => (field_type.is_numeric(), "a single number"),
        Semantic::OperationState => {
            (field_type.is_integer() || field_type == T::String, "a single String or integer")
        }
        Semantic::ActualStart | Semantic::ActualEnd | Semantic::ExpectedEnd => {
            (field_type == T::DateTime, "a single DateTime")
        }
        Semantic::Iri(_) => return,
    };
    if !fits || field.value_rank >= 1 {
        let message = format!("A field with the semantic {} must be {wanted}.", semantic.as_str());
        reader.faults.push(pointer, FaultCode::SemanticTypeMismatch, message);
    }
}
