//! Writes and method calls of clients: checked here, decided by the connector.

use std::{sync::Arc, time::Duration};

use asi_model::{
    BuiltInType, Variant as ModelVariant,
    instance::{self, FieldState, Instance},
    messages::MappingState,
    network::{OperationState, ReportField, Semantic, VALUE_RANK_SCALAR},
    node_set,
};
use opcua_stack::{
    opcua::types::{AttributeId, ByteString, Identifier, NodeId, StatusCode, Variant},
    values::{from_stack, status_to_stack},
};

use super::{
    field_properties::engineering_range,
    interface::Interface,
    location::{Located, Location},
    model,
    node_address::NodeAddress,
    provider::AsiProvider,
    types::TypeProvider,
};
use crate::{
    access::{TwinDecision, TwinUser},
    clock,
    events::AuditWrite,
    provider::{MethodOutcome, WriteRequest},
};

/// Time limit of the connector's answer to a client.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(30);
/// Longest reason for a decision, in bytes.
const REASON_BYTES_MAX: usize = 2000;

impl AsiProvider {
    pub(super) async fn write_field(
        &self,
        user: &TwinUser,
        request: WriteRequest<'_>,
    ) -> StatusCode {
        let located = self.locate(request.node_id);
        let Some(Located::Node(Location {
            interface,
            address: NodeAddress::Field(field),
            part: None,
            ..
        })) = located
        else {
            return match located {
                Some(_) => StatusCode::BadNotWritable,
                None => StatusCode::BadNodeIdUnknown,
            };
        };
        let old = interface.record(field);
        let status = match self.check_write(user, &request, &interface, field) {
            Err(status) => status,
            Ok(()) => {
                let mut value = request.value.clone();
                value.source_timestamp.get_or_insert_with(clock::stack_now);
                let value = from_stack(value, &self.values.namespaces);
                let key = interface.key_of(field);
                let write = self.writer.write(&key, value, user);
                match tokio::time::timeout(ANSWER_TIMEOUT, write).await {
                    Ok(status) => status_to_stack(status),
                    Err(_) => StatusCode::BadTimeout,
                }
            }
        };
        metrics::counter!("twin_writes_total", "outcome" => if status.is_bad() { "refused" } else { "accepted" })
            .increment(1);
        self.events.report_write(|| AuditWrite {
            node_id: request.node_id.clone(),
            user: user.name.to_string(),
            status,
            old_value: self.values.field(&old).value.unwrap_or_default(),
            // Good without more says that the gate discloses the value as it is; of any other
            // one even those who may write learn no more than partners.
            new_value: request
                .value
                .value
                .clone()
                .filter(|_| status == StatusCode::Good)
                .unwrap_or_default(),
            message: "A client wrote the value of a report field.".to_owned(),
        });
        status
    }

    fn check_write(
        &self,
        user: &TwinUser,
        request: &WriteRequest<'_>,
        interface: &Interface,
        field: u32,
    ) -> Result<(), StatusCode> {
        if request.attribute != AttributeId::Value
            || !interface.records.read()[field as usize].is_writable()
        {
            return Err(StatusCode::BadNotWritable);
        }
        if !user.role.may_write() {
            return Err(StatusCode::BadUserAccessDenied);
        }
        // The node shows the disclosed value. A part written into it would mix it with the raw one.
        if request.has_index_range {
            return Err(StatusCode::BadWriteNotSupported);
        }
        let value = from_stack(request.value.clone(), &self.values.namespaces).value;
        let (owner, definition) = interface.field(field);
        let operation = interface.operation(interface.slot(owner).operation);
        let planned = (operation.quantity_unit == definition.unit)
            .then_some(operation.planned_quantity)
            .flatten();
        check_value(definition, planned, &value)
    }

    pub(super) async fn call_method(
        &self,
        user: &TwinUser,
        object: &NodeId,
        method: &NodeId,
        arguments: &[Variant],
    ) -> MethodOutcome {
        let Some(Located::Node(Location { interface, address, part: None, .. })) =
            self.locate(object)
        else {
            return MethodOutcome::failed(StatusCode::BadNodeIdUnknown);
        };
        let Some(name) = self.method_name(&interface, address, method) else {
            return MethodOutcome::failed(StatusCode::BadMethodInvalid);
        };
        match (address, name) {
            (NodeAddress::Request(request), "Decide") => {
                self.decide(user, &interface, request, arguments).await
            }
            (NodeAddress::Interface, "ExportNodeSet") if arguments.is_empty() => {
                Self::export(&interface)
            }
            (NodeAddress::Interface, "ExportNodeSet") => {
                MethodOutcome::failed(StatusCode::BadTooManyArguments)
            }
            _ => MethodOutcome::failed(StatusCode::BadMethodInvalid),
        }
    }

    /// Returns the name of a method of this node, given as its own node or as its type's
    /// declaration.
    fn method_name(
        &self,
        interface: &Interface,
        address: NodeAddress,
        method: &NodeId,
    ) -> Option<&'static str> {
        let type_id = interface.type_of(address)?;
        let identifier = interface.identifier(address);
        model::object_type(type_id)?.parts.iter().map(|part| part.name).find(|name| {
            match &method.identifier {
                Identifier::String(id) if method.namespace == self.ids.instances => {
                    id.as_ref()
                        .strip_prefix(identifier.as_str())
                        .and_then(|rest| rest.strip_prefix('#'))
                        == Some(name)
                }
                _ => {
                    TypeProvider::method_declaration(self.ids.types, type_id, name).as_ref()
                        == Some(method)
                }
            }
        })
    }

    async fn decide(
        &self,
        user: &TwinUser,
        interface: &Interface,
        request: u32,
        arguments: &[Variant],
    ) -> MethodOutcome {
        if arguments.len() != 3 {
            let status = if arguments.len() < 3 {
                StatusCode::BadArgumentsMissing
            } else {
                StatusCode::BadTooManyArguments
            };
            return MethodOutcome::failed(status);
        }
        let field = text(&arguments[0]).map(|name| interface.find_field(request, name));
        let state = mapping_state(&arguments[1]);
        let reason = optional_text(&arguments[2]);
        let (field, mapping_state, reason) = match (field, state, reason) {
            (Some(Some(field)), Ok(state), Ok(reason))
                if state != MappingState::Refused || reason.is_some() =>
            {
                (field, state, reason)
            }
            (field, state, reason) => {
                let unknown = if field.is_some() {
                    StatusCode::BadNotFound
                } else {
                    StatusCode::BadTypeMismatch
                };
                return MethodOutcome::invalid_arguments(vec![
                    if matches!(field, Some(Some(_))) { StatusCode::Good } else { unknown },
                    state.err().unwrap_or(StatusCode::Good),
                    // The remaining fault is a refusal without a reason.
                    match reason {
                        Err(status) => status,
                        Ok(None) if state == Ok(MappingState::Refused) => {
                            StatusCode::BadInvalidArgument
                        }
                        Ok(_) => StatusCode::Good,
                    },
                ]);
            }
        };
        let decision = TwinDecision { mapping_state, reason };
        let key = interface.key_of(field);
        let decide = self.writer.decide(&key, decision, user);
        let status = match tokio::time::timeout(ANSWER_TIMEOUT, decide).await {
            Ok(status) => status_to_stack(status),
            Err(_) => StatusCode::BadTimeout,
        };
        if status.is_bad() {
            let node_id = self.ids.instance(format!(
                "{}#MappingState",
                interface.identifier(NodeAddress::Field(field))
            ));
            let old_value = Variant::from(interface.record(field).mapping_state as i32);
            self.events.report_decision(|| AuditWrite {
                node_id,
                user: user.name.to_string(),
                status,
                old_value,
                new_value: (mapping_state as i32).into(),
                message: "A decision about a report field was not accepted.".to_owned(),
            });
        }
        MethodOutcome { status, outputs: Vec::new(), argument_statuses: Vec::new() }
    }

    /// Exports the interface in its present state as a NodeSet, which other servers load.
    fn export(interface: &Interface) -> MethodOutcome {
        let records = interface.records.read().clone();
        let fields = (0_u32..).zip(&records).map(|(number, record)| {
            let owned = |text: &Option<Arc<str>>| text.as_deref().map(ToOwned::to_owned);
            let state = FieldState {
                mapping_state: record.mapping_state,
                value_source: record.value_source,
                value: record.shown_value().value,
                disclosure: owned(&record.disclosure),
                reason: owned(&record.reason),
                decided_by: owned(&record.decided_by),
                decision_time: record.decision_time,
            };
            (interface.key_of(number), state)
        });
        let instance = Instance {
            message: &interface.message,
            received_at: Some(interface.received_at),
            writers: interface.writers(),
            fields: fields.collect(),
        };
        let document = node_set::write(&instance::node_set(&instance));
        MethodOutcome::good(vec![ByteString::from(document.into_bytes()).into()])
    }
}

fn text(variant: &Variant) -> Option<&str> {
    match variant {
        Variant::String(text) if !text.is_null() => Some(text.as_ref()),
        _ => None,
    }
}

fn optional_text(variant: &Variant) -> Result<Option<String>, StatusCode> {
    let text = match variant {
        Variant::Empty => return Ok(None),
        Variant::String(text) => text.as_ref(),
        Variant::LocalizedText(text) => text.text.as_ref(),
        _ => return Err(StatusCode::BadTypeMismatch),
    };
    if text.len() > REASON_BYTES_MAX {
        return Err(StatusCode::BadOutOfRange);
    }
    Ok((!text.trim().is_empty()).then(|| text.to_owned()))
}

fn mapping_state(variant: &Variant) -> Result<MappingState, StatusCode> {
    match variant {
        Variant::Int32(0) => Ok(MappingState::Pending),
        Variant::Int32(1) => Ok(MappingState::Mapped),
        Variant::Int32(2) => Ok(MappingState::Refused),
        Variant::Int32(_) => Err(StatusCode::BadOutOfRange),
        _ => Err(StatusCode::BadTypeMismatch),
    }
}

/// Checks type, rank and range of a field's value.
fn check_value(
    definition: &ReportField,
    planned: Option<f64>,
    value: &ModelVariant,
) -> Result<(), StatusCode> {
    let expected = definition.field_type.0;
    let fits_type = value
        .built_in_type()
        .is_some_and(|found| found == expected || expected == BuiltInType::Variant);
    let rank = match value {
        ModelVariant::Null => return Err(StatusCode::BadTypeMismatch),
        ModelVariant::Scalar(_) => VALUE_RANK_SCALAR,
        ModelVariant::Array(array) => {
            array.dimensions.as_ref().map_or(1, |d| i32::try_from(d.len()).unwrap_or(i32::MAX))
        }
    };
    // OPC 10000-3 §5.6.2: -3 scalar or one dimension, -2 any, -1 scalar, 0 one or more dimensions.
    let fits_rank = match definition.value_rank {
        -3 => rank == VALUE_RANK_SCALAR || rank == 1,
        -2 => true,
        0 => rank >= 1,
        exact => rank == exact,
    };
    if !fits_type || !fits_rank {
        return Err(StatusCode::BadTypeMismatch);
    }
    let Some(scalar) = value.as_scalar() else { return Ok(()) };
    if definition.semantic == Some(Semantic::OperationState) {
        let is_state = match scalar.as_str() {
            Some(name) => OperationState::from_name(name).is_some(),
            None => scalar.as_i128().is_some_and(|n| (0..6).contains(&n)),
        };
        return if is_state { Ok(()) } else { Err(StatusCode::BadOutOfRange) };
    }
    // Only a percentage has hard bounds: production may exceed the plan.
    let is_percent = definition.semantic == Some(Semantic::PercentComplete);
    match (scalar.as_f64(), engineering_range(definition, planned)) {
        (Some(number), Some(range))
            if is_percent && !(range.low..=range.high).contains(&number) =>
        {
            Err(StatusCode::BadOutOfRange)
        }
        (Some(number), _) if !is_percent && is_quantity(definition) && number < 0.0 => {
            Err(StatusCode::BadOutOfRange)
        }
        _ => Ok(()),
    }
}

fn is_quantity(definition: &ReportField) -> bool {
    matches!(
        definition.semantic,
        Some(Semantic::ProducedQuantity | Semantic::GoodQuantity | Semantic::ScrapQuantity)
    )
}
