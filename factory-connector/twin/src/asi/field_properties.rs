//! Properties of report fields: the definition of the request, and the decision of the connector.

use asi_model::{
    messages::MappingState,
    network::{ReportField, Semantic},
    units,
};
use opcua_stack::{
    opcua::types::{
        DataValue, EUInformation, ExtensionObject, LocalizedText, Range, StatusCode, UAString,
        Variant,
    },
    values::time_to_stack,
};

use super::{data_values::status_only, model::Part};
use crate::document::FieldRecord;

/// Computes a property of a field: `Err` with a value that the request defines, `Ok` with one from
/// the record, with its time.
pub(super) fn property(
    definition: &ReportField,
    planned_quantity: Option<f64>,
    record: &FieldRecord,
    part: &Part,
) -> Option<Result<DataValue, Variant>> {
    let decided = |value: Variant, status: StatusCode| DataValue {
        value: Some(value),
        status: Some(status),
        source_timestamp: record.decision_time.map(time_to_stack),
        ..DataValue::default()
    };
    let decided_text = |text: Option<&std::sync::Arc<str>>| {
        let text = text.map_or_else(UAString::null, |text| UAString::from(text.as_ref()));
        Some(Ok(decided(text.into(), StatusCode::Good)))
    };
    match part.name {
        "EngineeringUnits" if definition.field_type.0.is_numeric() => {
            definition.unit.as_deref().map(|unit| Err(engineering_units(unit).into()))
        }
        "EURange" if definition.field_type.0.is_numeric() => {
            engineering_range(definition, planned_quantity)
                .map(|range| Err(ExtensionObject::from_message(range).into()))
        }
        "Semantic" => {
            definition.semantic.as_ref().map(|semantic| Err(Variant::from(semantic.as_str())))
        }
        "IsMapped" => Some(Ok(match record.mapping_state {
            MappingState::Pending => decided(false.into(), StatusCode::UncertainInitialValue),
            MappingState::Mapped => decided(true.into(), StatusCode::Good),
            MappingState::Refused => decided(false.into(), StatusCode::Good),
        })),
        "MappingState" => Some(Ok(decided((record.mapping_state as i32).into(), StatusCode::Good))),
        "ValueSource" => Some(Ok(match record.value_source {
            Some(source) => decided((source as i32).into(), StatusCode::Good),
            None => status_only(StatusCode::BadNoData),
        })),
        "Disclosure" => decided_text(record.disclosure.as_ref()),
        "DecisionReason" => decided_text(record.reason.as_ref()),
        "DecidedBy" => decided_text(record.decided_by.as_ref()),
        "DecisionTime" => Some(Ok(match record.decision_time {
            Some(at) => decided(time_to_stack(at).into(), StatusCode::Good),
            None => status_only(StatusCode::BadNoData),
        })),
        _ => None,
    }
}

/// Returns the normal range of a field's values; none when its semantic does not define one.
pub(super) fn engineering_range(
    definition: &ReportField,
    planned_quantity: Option<f64>,
) -> Option<Range> {
    let high = match definition.semantic.as_ref()? {
        Semantic::PercentComplete => 100.0,
        Semantic::ProducedQuantity | Semantic::GoodQuantity | Semantic::ScrapQuantity => {
            planned_quantity?
        }
        _ => return None,
    };
    (high > 0.0).then_some(Range { low: 0.0, high })
}

/// Encodes a unit as in OPC 10000-8 §5.6.3; one that the table lacks has its name only.
pub(super) fn engineering_units(unit: &str) -> ExtensionObject {
    let known = units::lookup(unit);
    let text = |text: &str| LocalizedText::new("en", text);
    ExtensionObject::from_message(EUInformation {
        namespace_uri: units::UNECE_NAMESPACE_URI.into(),
        unit_id: known.map_or(-1, |known| known.unit_id()),
        display_name: text(known.map_or(unit, |known| known.display_name)),
        description: text(known.map_or(unit, |known| known.description)),
    })
}
