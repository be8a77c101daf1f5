//! Messages in words.

use std::io::Write;

use asi_model::{
    messages::PlatformMessage,
    network::{Operation, OperationKind, OperationNetwork},
    opcua_json::{DataEncoding, encode_variant},
    pubsub::{
        DataSetMessage, DataSetMetaData, FieldRepresentation, MetaDataMessage, PubSubMessage,
    },
    schedule::Schedule,
    units,
};
use serde_json::Value;

/// Longest value that is shown in full, in characters.
const VALUE_CHARS_MAX: usize = 100;

/// A message to a factory.
pub fn platform_message(message: &PlatformMessage, out: &mut dyn Write) -> anyhow::Result<()> {
    let PlatformMessage::OperationNetwork(message) = message else {
        writeln!(out, "{} ({})", message.message_type(), message.message_id())?;
        return members(&serde_json::to_value(message)?, out);
    };
    writeln!(
        out,
        "operation-network {} for factory {}: network {}, revision {}, collaboration {}",
        message.message_id,
        message.factory_id,
        message.operation_network.operation_network_id,
        message.revision,
        message.collaboration_id
    )?;
    network(&message.operation_network, out)
}

fn network(network: &OperationNetwork, out: &mut dyn Write) -> anyhow::Result<()> {
    let schedule = Schedule::of(network);
    for (index, found) in network.operation_list.iter().enumerate() {
        writeln!(out, "/operationNetwork/operationList/{index}")?;
        operation(found, out)?;
        if let Some(times) =
            schedule.operations.get(index).filter(|times| times.earliest_start.is_some())
        {
            let slack = times.slack.map_or_else(|| "unknown".to_owned(), |slack| slack.to_string());
            let critical = if times.is_critical { ", on the critical path" } else { "" };
            writeln!(out, "    slack {slack}{critical}")?;
        }
    }
    for (index, relation) in network.operation_relation_list.iter().enumerate() {
        writeln!(out, "/operationNetwork/operationRelationList/{index}")?;
        writeln!(
            out,
            "  relation {}: {} {:?} {}",
            relation.operation_relation_id,
            relation.predecessor_operation_id,
            relation.relation_type,
            relation.successor_operation_id
        )?;
        for condition in &relation.condition_list {
            let bound = match (condition.time, condition.duration) {
                (Some(time), _) => time.to_string(),
                (None, Some(duration)) => duration.to_string(),
                (None, None) => String::new(),
            };
            writeln!(
                out,
                "    condition {}: {:?} {bound}",
                condition.condition_id, condition.condition_kind
            )?;
        }
    }
    Ok(())
}

fn operation(operation: &Operation, out: &mut dyn Write) -> anyhow::Result<()> {
    let name = operation.name.as_deref().unwrap_or("without name");
    let stub = if operation.stub { ", a stub of another factory's" } else { "" };
    writeln!(
        out,
        "  {} operation {} ({name}){stub}",
        operation.kind.name(),
        operation.operation_id
    )?;
    match &operation.kind {
        OperationKind::Production { product_id: Some(product) } => {
            writeln!(out, "    product {product}")?
        }
        OperationKind::Inspection { inspected_operation_id: Some(inspected), .. } => {
            writeln!(out, "    inspects {inspected}")?;
        }
        OperationKind::Transportation { origin: Some(origin), destination: Some(destination) } => {
            writeln!(out, "    from {origin} to {destination}")?;
        }
        _ => {}
    }
    if let (Some(start), Some(end)) = (operation.planned_start, operation.planned_end) {
        writeln!(out, "    planned from {start} to {end}")?;
    }
    if let Some(quantity) = operation.planned_quantity {
        writeln!(
            out,
            "    planned quantity {quantity} {}",
            unit(operation.quantity_unit.as_deref())
        )?;
    }
    for requirement in &operation.equipment_requirement_list {
        writeln!(
            out,
            "    needs {} ({})",
            requirement.equipment_type, requirement.equipment_requirement_id
        )?;
    }
    for request in &operation.dynamic_data_request_list {
        let recipients: Vec<&str> = request.recipient_list.iter().map(|id| id.as_str()).collect();
        writeln!(
            out,
            "    request {} by {} for {}: {}",
            request.dynamic_data_request_id,
            request.requester_id,
            recipients.join(", "),
            request.purpose
        )?;
        if let Some(interval) = request.update_interval() {
            writeln!(out, "      every {} s", interval.as_secs_f64())?;
        }
        for field in &request.report_data_format.report_field_list {
            let rank = if field.value_rank == -1 { "" } else { "[]" };
            let semantic = field.semantic.as_ref().map_or("", |semantic| semantic.as_str());
            let unit = unit(field.unit.as_deref());
            writeln!(
                out,
                "      field {}: {}{rank} {unit} {semantic}",
                field.name, field.field_type.0
            )?;
        }
    }
    Ok(())
}

fn unit(name: Option<&str>) -> String {
    match name.map(|name| (name, units::lookup(name))) {
        None => String::new(),
        Some((_, Some(unit))) => {
            format!("{} ({}, {})", unit.display_name, unit.description, unit.code)
        }
        Some((name, None)) => name.to_owned(),
    }
}

/// A PubSub message.
pub fn pubsub_message(
    message: &PubSubMessage,
    meta_data: Option<&DataSetMetaData>,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    let id = message.message_id().map_or_else(|| "without id".to_owned(), ToString::to_string);
    let publisher = message.publisher_id().unwrap_or("unknown");
    writeln!(out, "{} {id} from publisher {publisher}", message.message_type())?;
    match message {
        PubSubMessage::Data(message) => {
            message.messages.iter().try_for_each(|part| data_set_message(part, meta_data, out))
        }
        PubSubMessage::MetaData(message) => meta_data_message(message, out),
        PubSubMessage::Status(message) => {
            writeln!(out, "  the publisher is {}", message.status.name())?;
            if let Some(next) = message.next_report_time {
                writeln!(out, "  next report due at {next}")?;
            }
            Ok(())
        }
        PubSubMessage::Other { .. } => {
            writeln!(out, "  receivers ignore messages of this type")?;
            Ok(())
        }
    }
}

fn data_set_message(
    message: &DataSetMessage,
    meta_data: Option<&DataSetMetaData>,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    let number =
        |number: Option<u32>| number.map_or_else(|| "?".to_owned(), |number| number.to_string());
    write!(
        out,
        "  {} of writer {}",
        message.kind.name(),
        number(message.data_set_writer_id.map(u32::from))
    )?;
    write!(out, ", sequence number {}", number(message.sequence_number))?;
    if let Some(version) = message.meta_data_version {
        write!(out, ", metadata {}.{}", version.major, version.minor)?;
    }
    if let Some(time) = message.timestamp {
        write!(out, ", made at {time}")?;
    }
    writeln!(out, ", {}", message.status)?;
    for field in &message.fields {
        let value =
            String::from_utf8(encode_variant(&field.value.value, DataEncoding::NonReversible104))?;
        let known = field.value.value.built_in_type();
        let type_name = known.map_or("null", |built_in_type| built_in_type.name());
        write!(out, "    {}: {type_name} {}", field.name, shortened(&value))?;
        let described = meta_data.and_then(|known| known.field(&field.name));
        if let Some(unit) = described.and_then(|field| field.engineering_unit()) {
            write!(out, " {}", unit.display_name)?;
        }
        if !field.value.status.is_good() {
            write!(out, " [{}]", field.value.status)?;
        }
        if message.representation == FieldRepresentation::DataValue
            && let Some(time) = field.value.source_timestamp
        {
            write!(out, " measured at {time}")?;
        }
        if let Some(semantic) = described.and_then(|field| field.semantic()) {
            write!(out, " ({})", semantic.as_str())?;
        }
        writeln!(out)?;
    }
    Ok(())
}

fn meta_data_message(message: &MetaDataMessage, out: &mut dyn Write) -> anyhow::Result<()> {
    let known = &message.meta_data;
    let version = known.configuration_version;
    writeln!(
        out,
        "  data set {} of writer {}, version {}.{}",
        known.name, message.data_set_writer_id, version.major, version.minor
    )?;
    for field in &known.fields {
        write!(out, "    {}: {}", field.name, field.built_in_type)?;
        if let Some(unit) = field.engineering_unit() {
            write!(out, " in {} ({})", unit.description, unit.code)?;
        }
        if let Some(semantic) = field.semantic() {
            write!(out, ", meaning {}", semantic.as_str())?;
        }
        if let Some(disclosure) = field.disclosure() {
            write!(out, ", disclosed: {disclosure}")?;
        }
        writeln!(out)?;
    }
    Ok(())
}

fn shortened(value: &str) -> String {
    match value.char_indices().nth(VALUE_CHARS_MAX) {
        Some((end, _)) => format!("{}…", &value[..end]),
        None => value.to_owned(),
    }
}

/// Any other message: its members, one a line with its pointer.
pub fn members(message: &Value, out: &mut dyn Write) -> anyhow::Result<()> {
    let mut open = vec![(String::new(), message)];
    while let Some((pointer, value)) = open.pop() {
        match value {
            Value::Object(members) if !members.is_empty() => {
                open.extend(members.iter().rev().map(|(name, value)| {
                    // RFC 6901 §3.
                    let name = name.replace('~', "~0").replace('/', "~1");
                    (format!("{pointer}/{name}"), value)
                }));
            }
            Value::Array(elements) if !elements.is_empty() => {
                open.extend(
                    elements
                        .iter()
                        .enumerate()
                        .rev()
                        .map(|(at, value)| (format!("{pointer}/{at}"), value)),
                );
            }
            value => writeln!(out, "{pointer}: {}", shortened(&value.to_string()))?,
        }
    }
    Ok(())
}
