//! Conversion of nodes back to the message they came from.

use std::collections::{HashMap, HashSet};

use serde_json::{Map, Value, json};

use crate::{
    asi_types::{self, INSTANCE_NAMESPACE_PREFIX, asi, browse_name},
    network::IsoDuration,
    node_set::{Node, NodeClass, NodeSet, ns0},
    units::EngineeringUnit,
    values::{Namespace, NodeId, Scalar, Variant},
};

/// Returns the first interface of a node set as the JSON of an `operation-network` message; `None`
/// where there is no interface. Nothing is judged: what is missing among the nodes is missing in
/// the message, for the validation to find. The factory follows from the namespace, the message id
/// from the caller.
#[must_use]
pub fn to_json(node_set: &NodeSet, message_id: &str) -> Option<Value> {
    let graph = NodeGraph::of(node_set);
    let interface = graph.of_type(asi_types::INTERFACE_TYPE)?;
    let factory_id = match &interface.node_id.namespace {
        Namespace::Uri(uri) => uri.strip_prefix(INSTANCE_NAMESPACE_PREFIX).unwrap_or(uri),
        _ => "",
    };
    let mut message = Map::new();
    message.insert("messageType".into(), "operation-network".into());
    message.insert("messageId".into(), message_id.into());
    message.insert("factoryId".into(), factory_id.into());
    copy(
        &mut message,
        &graph,
        interface,
        &[("collaborationId", "CollaborationId"), ("revision", "Revision")],
    );
    let network =
        graph.children(interface).find(|node| graph.is_of(node, asi_types::OPERATION_NETWORK_TYPE));
    if let Some(network) = network {
        message.insert("operationNetwork".into(), graph.network(network, factory_id));
    }
    Some(Value::Object(message))
}

/// Nodes with their children, whichever side lists a reference.
struct NodeGraph<'n> {
    nodes: Vec<&'n Node>,
    children: HashMap<&'n NodeId, Vec<&'n Node>>,
}

/// The names of an enumeration's values on the wire.
const RELATION_TYPES: [&str; 4] =
    ["FINISH_TO_START", "START_TO_START", "FINISH_TO_FINISH", "START_TO_FINISH"];
const CONDITION_KINDS: [&str; 6] = [
    "START_NO_EARLIER_THAN",
    "START_NO_LATER_THAN",
    "FINISH_NO_EARLIER_THAN",
    "FINISH_NO_LATER_THAN",
    "MINIMUM_GAP",
    "MAXIMUM_GAP",
];
const FREQUENCY_UNITS: [&str; 5] = ["SECOND", "MINUTE", "HOUR", "DAY", "WEEK"];

impl<'n> NodeGraph<'n> {
    fn of(node_set: &'n NodeSet) -> Self {
        let by_id: HashMap<&NodeId, &Node> =
            node_set.nodes.iter().map(|node| (&node.node_id, node)).collect();
        let aggregating = [ns0::HAS_PROPERTY, ns0::HAS_COMPONENT, asi(asi_types::HAS_OPERATION)];
        let mut children: HashMap<&NodeId, Vec<&Node>> = HashMap::new();
        let mut seen = HashSet::new();
        for node in &node_set.nodes {
            for reference in
                node.references.iter().filter(|r| aggregating.contains(&r.reference_type))
            {
                let (parent, child) = if reference.is_forward {
                    (&node.node_id, by_id.get(&reference.target).copied())
                } else {
                    (&reference.target, Some(node))
                };
                // The first parent keeps the child: what many parents shared would be told once for
                // each of them.
                if let Some(child) = child.filter(|child| seen.insert(&child.node_id)) {
                    children.entry(parent).or_default().push(child);
                }
            }
        }
        Self { nodes: node_set.nodes.iter().collect(), children }
    }

    fn is_of(&self, node: &Node, type_id: u32) -> bool {
        node.target(&ns0::HAS_TYPE_DEFINITION) == Some(&asi(type_id))
    }

    fn of_type(&self, type_id: u32) -> Option<&'n Node> {
        self.nodes.iter().copied().find(|node| self.is_of(node, type_id))
    }

    fn children(&self, node: &Node) -> impl Iterator<Item = &'n Node> + use<'_, 'n> {
        self.children.get(&node.node_id).into_iter().flatten().copied()
    }

    fn children_of_type(
        &self,
        node: &Node,
        type_id: u32,
    ) -> impl Iterator<Item = &'n Node> + use<'_, 'n> {
        self.children(node).filter(move |child| self.is_of(child, type_id))
    }

    /// A part that the model or the standard names; a report field may be called alike in its own
    /// namespace.
    fn part(&self, node: &Node, name: &str) -> Option<&'n Node> {
        let names = [browse_name(name, false), browse_name(name, true)];
        self.children(node).find(|child| {
            names.contains(&child.browse_name) && matches!(child.class, NodeClass::Variable { .. })
        })
    }

    fn value(&self, node: &Node, name: &str) -> Option<&'n Variant> {
        match &self.part(node, name)?.class {
            NodeClass::Variable { value, .. } => Some(value),
            _ => None,
        }
    }

    fn unit(&self, node: &Node) -> Option<Value> {
        match self.value(node, "EngineeringUnits")? {
            Variant::Scalar(Scalar::ExtensionObject(object)) => {
                EngineeringUnit::from_extension_object(object).map(|unit| unit.alias().into())
            }
            _ => None,
        }
    }

    fn network(&self, node: &Node, factory_id: &str) -> Value {
        let mut network = Map::new();
        copy(
            &mut network,
            self,
            node,
            &[
                ("operationNetworkId", "OperationNetworkId"),
                ("name", "Name"),
                ("description", "Description"),
            ],
        );
        let operations: Vec<Value> =
            self.children(node).filter_map(|child| self.operation(child, factory_id)).collect();
        let relations: Vec<Value> = self
            .children_of_type(node, asi_types::OPERATION_RELATION_TYPE)
            .map(|relation| self.relation(relation))
            .collect();
        network.insert("operationList".into(), operations.into());
        network.insert("operationRelationList".into(), relations.into());
        Value::Object(network)
    }

    fn operation(&self, node: &Node, factory_id: &str) -> Option<Value> {
        let kinds = [
            (asi_types::PRODUCTION_OPERATION_TYPE, "PRODUCTION"),
            (asi_types::INSPECTION_OPERATION_TYPE, "INSPECTION"),
            (asi_types::TRANSPORTATION_OPERATION_TYPE, "TRANSPORTATION"),
        ];
        let (_, kind) = kinds.into_iter().find(|(type_id, _)| self.is_of(node, *type_id))?;
        let mut operation = Map::new();
        operation.insert("operationType".into(), kind.into());
        copy(
            &mut operation,
            self,
            node,
            &[
                ("operationId", "OperationId"),
                ("name", "Name"),
                ("description", "Description"),
                ("owningFactoryId", "OwningFactoryId"),
                ("plannedStart", "PlannedStart"),
                ("plannedEnd", "PlannedEnd"),
                ("plannedQuantity", "PlannedQuantity"),
                ("productId", "ProductId"),
                ("inspectedOperationId", "InspectedOperationId"),
                ("characteristic", "Characteristic"),
                ("origin", "Origin"),
                ("destination", "Destination"),
            ],
        );
        if let Some(unit) =
            self.part(node, "PlannedQuantity").and_then(|quantity| self.unit(quantity))
        {
            operation.insert("quantityUnit".into(), unit);
        }
        if operation.get("owningFactoryId").is_some_and(|owner| owner != factory_id) {
            operation.insert("stub".into(), true.into());
        }
        let requirements: Vec<Value> = self
            .children_of_type(node, asi_types::EQUIPMENT_REQUIREMENT_TYPE)
            .map(|requirement| {
                let mut object = Map::new();
                let members = [
                    ("equipmentRequirementId", "EquipmentRequirementId"),
                    ("equipmentType", "EquipmentType"),
                    ("capability", "Capability"),
                    ("quantity", "Quantity"),
                    ("assetId", "AssetId"),
                ];
                copy(&mut object, self, requirement, &members);
                Value::Object(object)
            })
            .collect();
        let requests: Vec<Value> = self
            .children_of_type(node, asi_types::DYNAMIC_DATA_REQUEST_TYPE)
            .map(|request| self.request(request))
            .collect();
        operation.insert("equipmentRequirementList".into(), requirements.into());
        operation.insert("dynamicDataRequestList".into(), requests.into());
        Some(Value::Object(operation))
    }

    fn request(&self, node: &Node) -> Value {
        let mut request = Map::new();
        copy(
            &mut request,
            self,
            node,
            &[
                ("dynamicDataRequestId", "DynamicDataRequestId"),
                ("dynamicDataRequestPublisherId", "DynamicDataRequestPublisherId"),
                ("requesterId", "RequesterId"),
                ("recipientList", "Recipients"),
                ("purpose", "Purpose"),
                ("validFrom", "ValidFrom"),
                ("validUntil", "ValidUntil"),
                ("description", "Description"),
                ("bufferId", "BufferId"),
                ("updateFrequency", "UpdateFrequency"),
            ],
        );
        self.named(
            &mut request,
            node,
            "updateFrequencyUnit",
            "UpdateFrequencyUnit",
            &FREQUENCY_UNITS,
        );
        if let Some(format) = self.children_of_type(node, asi_types::REPORT_DATA_FORMAT_TYPE).next()
        {
            let mut object = Map::new();
            copy(&mut object, self, format, &[("reportName", "ReportName")]);
            let fields: Vec<Value> =
                self.children(format).filter_map(|child| self.field(child)).collect();
            object.insert("reportFieldList".into(), fields.into());
            request.insert("reportDataFormat".into(), object.into());
        }
        Value::Object(request)
    }

    /// A component variable of a report data format; its properties are no fields.
    fn field(&self, node: &Node) -> Option<Value> {
        let NodeClass::Variable { data_type, value_rank, .. } = &node.class else { return None };
        if node.target(&ns0::HAS_TYPE_DEFINITION) == Some(&ns0::PROPERTY_TYPE) {
            return None;
        }
        let mut field = Map::new();
        field.insert("name".into(), node.browse_name.name.as_deref().unwrap_or_default().into());
        let type_id = match (&data_type.namespace, &data_type.identifier) {
            (Namespace::Ua, crate::values::Identifier::Numeric(id)) => *id,
            _ => 0,
        };
        field.insert("type".into(), type_id.into());
        if *value_rank != -1 {
            field.insert("valueRank".into(), (*value_rank).into());
        }
        if let Some(description) = &node.description {
            field.insert("description".into(), description.as_str().into());
        }
        if let Some(unit) = self.unit(node) {
            field.insert("unit".into(), unit);
        }
        copy(&mut field, self, node, &[("semantic", "Semantic")]);
        Some(Value::Object(field))
    }

    fn relation(&self, node: &Node) -> Value {
        let mut relation = Map::new();
        copy(
            &mut relation,
            self,
            node,
            &[
                ("operationRelationId", "OperationRelationId"),
                ("predecessorOperationId", "PredecessorOperationId"),
                ("successorOperationId", "SuccessorOperationId"),
            ],
        );
        self.named(&mut relation, node, "relationType", "RelationType", &RELATION_TYPES);
        let conditions: Vec<Value> = self
            .children_of_type(node, asi_types::RELATION_CONDITION_TYPE)
            .map(|condition| {
                let mut object = Map::new();
                copy(
                    &mut object,
                    self,
                    condition,
                    &[("conditionId", "ConditionId"), ("time", "Time")],
                );
                self.named(
                    &mut object,
                    condition,
                    "conditionKind",
                    "ConditionKind",
                    &CONDITION_KINDS,
                );
                let millis = self.value(condition, "Duration").and_then(Variant::as_f64);
                if let Some(duration) = millis.and_then(IsoDuration::from_milliseconds) {
                    object.insert("duration".into(), duration.to_string().into());
                }
                Value::Object(object)
            })
            .collect();
        relation.insert("conditionList".into(), conditions.into());
        Value::Object(relation)
    }

    /// An enumeration's value by its name on the wire.
    fn named(
        &self,
        object: &mut Map<String, Value>,
        node: &Node,
        member: &str,
        part: &str,
        names: &[&str],
    ) {
        let value = self.value(node, part).and_then(Variant::as_scalar).and_then(Scalar::as_i128);
        if let Some(name) =
            value.and_then(|value| usize::try_from(value).ok()).and_then(|value| names.get(value))
        {
            object.insert(member.to_owned(), (*name).into());
        }
    }
}

/// Copies the values of parts that are there.
fn copy(
    object: &mut Map<String, Value>,
    graph: &NodeGraph<'_>,
    node: &Node,
    members: &[(&str, &str)],
) {
    for (member, part) in members {
        if let Some(value) = graph.value(node, part).and_then(plain) {
            object.insert((*member).to_owned(), value);
        }
    }
}

/// A value as the network's own JSON has it.
fn plain(value: &Variant) -> Option<Value> {
    match value {
        Variant::Null => None,
        Variant::Array(array) => {
            array.elements.iter().map(plain_scalar).collect::<Option<Vec<_>>>().map(Value::from)
        }
        Variant::Scalar(scalar) => plain_scalar(scalar),
    }
}

fn plain_scalar(scalar: &Scalar) -> Option<Value> {
    match scalar {
        Scalar::String(text) => text.as_deref().map(Value::from),
        Scalar::LocalizedText(text) => text.text.as_deref().map(Value::from),
        Scalar::DateTime(time) => Some(time.to_string().into()),
        Scalar::Boolean(value) => Some((*value).into()),
        Scalar::Double(value) => Some(json!(value)),
        Scalar::Float(value) => Some(json!(value)),
        other => other.as_i128().and_then(|value| u64::try_from(value).ok()).map(Value::from),
    }
}
