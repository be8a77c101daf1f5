//! Events of a machine as its server shows them.

use asi_model::DateTime;
use opcua_stack::{
    opcua::{
        crypto::random,
        nodes::Event,
        server::EventField,
        types::{
            AttributeId, DateTime as StackTime, LocalizedText, NodeId, NumericRange, ObjectTypeId,
            QualifiedName, Variant,
        },
    },
    values::time_to_stack,
};

use crate::{MachineCondition, MachineEvent};

/// Bytes of an event's id.
const EVENT_ID_BYTES: usize = 16;

/// An event with its fields by their paths, as `ActiveState/Id`.
#[derive(Debug)]
pub(super) struct ShownEvent {
    event_type: NodeId,
    time: StackTime,
    /// The condition whose state it is.
    condition: Option<NodeId>,
    fields: Vec<(&'static str, Variant)>,
}

impl ShownEvent {
    /// Returns an event about a node.
    pub(super) fn new(
        event_type: ObjectTypeId,
        event: &MachineEvent,
        source: (&NodeId, &str),
        at: DateTime,
    ) -> Self {
        let (event_type, time) = (NodeId::from(event_type), time_to_stack(at));
        let fields = vec![
            ("EventId", random::byte_string(EVENT_ID_BYTES).into()),
            ("EventType", event_type.clone().into()),
            ("SourceNode", source.0.clone().into()),
            ("SourceName", source.1.into()),
            ("Time", time.into()),
            ("ReceiveTime", time.into()),
            ("Message", LocalizedText::new("en", &event.message).into()),
            ("Severity", event.severity.into()),
        ];
        Self { event_type, time, condition: None, fields }
    }

    /// Returns the state of an alarm.
    pub(super) fn alarm(
        name: &str,
        condition: &MachineCondition,
        source: (&NodeId, &str),
        at: DateTime,
    ) -> Self {
        let MachineCondition { message, severity, is_active, is_acknowledged } = condition;
        let event = MachineEvent { message: message.clone(), severity: *severity };
        let mut alarm = Self::new(ObjectTypeId::AlarmConditionType, &event, source, at);
        let state = |is_set: &bool, set: &str, unset: &str| {
            Variant::from(LocalizedText::new("en", if *is_set { set } else { unset }))
        };
        alarm.condition = Some(NodeId::new(source.0.namespace, format!("Conditions.{name}")));
        alarm.fields.extend([
            ("ConditionName", name.into()),
            ("BranchId", NodeId::null().into()),
            ("Retain", condition.is_retained().into()),
            ("EnabledState", state(&true, "Enabled", "Disabled")),
            ("EnabledState/Id", true.into()),
            ("AckedState", state(is_acknowledged, "Acknowledged", "Unacknowledged")),
            ("AckedState/Id", (*is_acknowledged).into()),
            ("ActiveState", state(is_active, "Active", "Inactive")),
            ("ActiveState/Id", (*is_active).into()),
        ]);
        alarm
    }
}

impl EventField for ShownEvent {
    fn get_value(
        &self,
        attribute_id: AttributeId,
        index_range: &NumericRange,
        path: &[QualifiedName],
    ) -> Variant {
        match (attribute_id, &self.condition) {
            (AttributeId::NodeId, Some(condition)) if path.is_empty() => condition.clone().into(),
            (AttributeId::Value, _) => {
                let names: Vec<&str> = path.iter().map(|name| name.name.as_ref()).collect();
                let path = names.join("/");
                let field = self.fields.iter().find(|(known, _)| *known == path);
                field.and_then(|(_, value)| value.range_of(index_range).ok()).unwrap_or_default()
            }
            _ => Variant::Empty,
        }
    }
}

impl Event for ShownEvent {
    fn get_field(
        &self,
        _type_definition_id: &NodeId,
        attribute_id: AttributeId,
        index_range: &NumericRange,
        browse_path: &[QualifiedName],
    ) -> Variant {
        self.get_value(attribute_id, index_range, browse_path)
    }

    fn time(&self) -> &StackTime {
        &self.time
    }

    fn event_type_id(&self) -> &NodeId {
        &self.event_type
    }
}
