//! Read service: the attributes of a [`ProvidedNode`] by its class (OPC 10000-3 §5).

use opcua_stack::opcua::{
    server::{
        address_space::{AccessLevel, EventNotifier},
        node_manager::ParsedReadValueId,
    },
    types::{
        AttributeId, DataEncoding, DataValue, NodeId, NumericRange, StatusCode, TimestampsToReturn,
        Variant,
    },
};

use super::ProviderTable;
use crate::{
    access::Role,
    clock,
    provider::{NodeKind, ProvidedNode},
};

/// Reads one attribute as a user in a role sees it.
pub(super) fn read(
    table: &ProviderTable,
    item: &ParsedReadValueId,
    role: Role,
    timestamps: TimestampsToReturn,
) -> DataValue {
    match read_or_fail(table, item, role) {
        Ok(mut value) => {
            select_timestamps(&mut value, timestamps);
            value
        }
        Err(status) => DataValue {
            status: Some(status),
            server_timestamp: Some(clock::stack_now()),
            ..DataValue::default()
        },
    }
}

fn read_or_fail(
    table: &ProviderTable,
    item: &ParsedReadValueId,
    role: Role,
) -> Result<DataValue, StatusCode> {
    let provider = table.owner(&item.node_id).ok_or(StatusCode::BadNodeIdUnknown)?;
    if !matches!(item.data_encoding, DataEncoding::Binary) {
        return Err(StatusCode::BadDataEncodingInvalid);
    }
    if item.attribute_id == AttributeId::Value {
        // The value first: it is read most, and the node need not be computed for it.
        if let Some(value) = provider.value(&item.node_id) {
            return in_range(value, &item.index_range);
        }
        let node = provider.node(&item.node_id).ok_or(StatusCode::BadNodeIdUnknown)?;
        return Err(match node.class {
            NodeKind::Variable { .. } => StatusCode::BadNotReadable,
            _ => StatusCode::BadAttributeIdInvalid,
        });
    }
    let node = provider.node(&item.node_id).ok_or(StatusCode::BadNodeIdUnknown)?;
    if item.index_range.has_range() {
        return Err(StatusCode::BadIndexRangeNoData);
    }
    let value = attribute(&item.node_id, node, item.attribute_id, role)
        .ok_or(StatusCode::BadAttributeIdInvalid)?;
    Ok(DataValue { value: Some(value), status: Some(StatusCode::Good), ..DataValue::default() })
}

/// Checks whether an existing node lacks an attribute; what does not exist lacks none.
pub(super) fn is_absent(table: &ProviderTable, node_id: &NodeId, wanted: AttributeId) -> bool {
    table.node(node_id).is_some_and(|node| match wanted {
        AttributeId::Value => !matches!(node.class, NodeKind::Variable { .. }),
        _ => attribute(node_id, node, wanted, Role::Viewer).is_none(),
    })
}

/// Returns an attribute other than Value; `None` when the class does not have it.
fn attribute(
    node_id: &NodeId,
    node: ProvidedNode,
    attribute: AttributeId,
    role: Role,
) -> Option<Variant> {
    let class = node.class.node_class();
    Some(match attribute {
        AttributeId::NodeId => node_id.clone().into(),
        AttributeId::NodeClass => (class as i32).into(),
        AttributeId::BrowseName => node.browse_name.into(),
        AttributeId::DisplayName => node.display_name.into(),
        AttributeId::Description => node.description.into(),
        AttributeId::WriteMask | AttributeId::UserWriteMask => 0_u32.into(),
        other => return class_attribute(node.class, other, role),
    })
}

fn class_attribute(kind: NodeKind, attribute: AttributeId, role: Role) -> Option<Variant> {
    Some(match (kind, attribute) {
        (NodeKind::Object, AttributeId::EventNotifier) => EventNotifier::empty().bits().into(),
        (NodeKind::Variable { data_type, .. }, AttributeId::DataType) => data_type.into(),
        (NodeKind::Variable { value_rank, .. }, AttributeId::ValueRank) => value_rank.into(),
        (NodeKind::Variable { value_rank, .. }, AttributeId::ArrayDimensions) if value_rank > 0 => {
            // 0 allows any length.
            vec![0_u32; usize::try_from(value_rank).unwrap_or(1)].into()
        }
        (NodeKind::Variable { is_writable, .. }, AttributeId::AccessLevel) => {
            access_level(is_writable).into()
        }
        (NodeKind::Variable { is_writable, .. }, AttributeId::UserAccessLevel) => {
            access_level(is_writable && role.may_write()).into()
        }
        (NodeKind::Variable { is_writable, .. }, AttributeId::AccessLevelEx) => {
            u32::from(access_level(is_writable)).into()
        }
        // -1 is the fastest rate: values are reported when they change.
        (NodeKind::Variable { .. }, AttributeId::MinimumSamplingInterval) => (-1_f64).into(),
        (NodeKind::Variable { .. }, AttributeId::Historizing) => false.into(),
        (NodeKind::Method { .. }, AttributeId::Executable) => true.into(),
        (NodeKind::Method { callable_by }, AttributeId::UserExecutable) => {
            role.includes(callable_by).into()
        }
        (
            NodeKind::ObjectType { is_abstract } | NodeKind::ReferenceType { is_abstract, .. },
            AttributeId::IsAbstract,
        ) => is_abstract.into(),
        (NodeKind::DataType { .. }, AttributeId::IsAbstract) => false.into(),
        (NodeKind::ReferenceType { is_symmetric, .. }, AttributeId::Symmetric) => {
            is_symmetric.into()
        }
        (NodeKind::ReferenceType { inverse_name, .. }, AttributeId::InverseName) => {
            inverse_name.into()
        }
        (NodeKind::DataType { definition: Some(definition) }, AttributeId::DataTypeDefinition) => {
            Variant::ExtensionObject(*definition)
        }
        _ => return None,
    })
}

fn access_level(is_writable: bool) -> u8 {
    let level = if is_writable {
        AccessLevel::CURRENT_READ | AccessLevel::CURRENT_WRITE
    } else {
        AccessLevel::CURRENT_READ
    };
    level.bits()
}

fn in_range(value: DataValue, range: &NumericRange) -> Result<DataValue, StatusCode> {
    if matches!(range, NumericRange::None) {
        return Ok(value);
    }
    match &value.value {
        Some(variant) => Ok(DataValue { value: Some(variant.range_of(range)?), ..value }),
        None => Err(StatusCode::BadIndexRangeNoData),
    }
}

fn select_timestamps(value: &mut DataValue, requested: TimestampsToReturn) {
    if !matches!(requested, TimestampsToReturn::Source | TimestampsToReturn::Both) {
        (value.source_timestamp, value.source_picoseconds) = (None, None);
    }
    if matches!(requested, TimestampsToReturn::Server | TimestampsToReturn::Both) {
        value.server_timestamp.get_or_insert_with(clock::stack_now);
    } else {
        (value.server_timestamp, value.server_picoseconds) = (None, None);
    }
}
