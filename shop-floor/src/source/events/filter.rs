//! Filter of an event item: what the server selects, and of which events.

use opcua_stack::{
    NamespaceTable,
    opcua::types::{
        AttributeId, ContentFilter, ContentFilterElement, EventFilter, FilterOperator, NodeId,
        NumericRange, ObjectTypeId, Operand, QualifiedName, SimpleAttributeOperand,
    },
    values::{ConversionError, node_id_to_stack, qualified_name_to_stack},
};

use super::{COMMON_FIELDS, conditions::FIELDS};
use crate::{EventSelection, EventValue};

/// Returns the filter for a selection of events.
///
/// # Errors
/// [`ConversionError`] where the server has no namespace of a type, a source or a field.
pub(in crate::source) fn event_filter(
    selection: &EventSelection,
    namespaces: &NamespaceTable,
) -> Result<EventFilter, ConversionError> {
    let mut select: Vec<_> = COMMON_FIELDS.iter().map(|name| base_field(name)).collect();
    match &selection.value {
        EventValue::Field { path } => {
            let path = path.0.iter().map(|name| qualified_name_to_stack(name, namespaces));
            // With the base type the path is followed whatever the type of the event (OPC 10000-4 §7.4.4.5).
            select.push(value_at(ObjectTypeId::BaseEventType, path.collect::<Result<_, _>>()?));
        }
        EventValue::ActiveConditions | EventValue::ActiveSeverity | EventValue::ActiveMessage => {
            select.extend(fields_of_conditions());
        }
    }
    let wanted = wanted(selection, namespaces)?;
    let elements = wanted.map(Clause::into_elements);
    Ok(EventFilter { select_clauses: Some(select), where_clause: ContentFilter { elements } })
}

/// Returns what the events must be; `None` for all events.
fn wanted(
    selection: &EventSelection,
    namespaces: &NamespaceTable,
) -> Result<Option<Clause>, ConversionError> {
    let is_of_conditions = selection.value.is_of_conditions();
    let event_type = match &selection.event_type {
        Some(id) => Some(node_id_to_stack(id, namespaces)?),
        None => is_of_conditions.then(|| ObjectTypeId::ConditionType.into()),
    };
    let source = selection.source_node.as_ref();
    let source = source.map(|id| node_id_to_stack(id, namespaces)).transpose()?;
    let all = [
        event_type.map(Clause::of_type),
        source.map(|id| {
            Clause::Leaf(
                FilterOperator::Equals,
                vec![base_field("SourceNode").into(), Operand::literal(id)],
            )
        }),
        selection.severity_min.filter(|_| !is_of_conditions).map(|least| {
            Clause::Leaf(
                FilterOperator::GreaterThanOrEqual,
                vec![base_field("Severity").into(), Operand::literal(least)],
            )
        }),
    ];
    let all = all.into_iter().flatten().reduce(|left, right| left.with(FilterOperator::And, right));
    // The marks of a refresh are system events.
    let marks = || Clause::of_type(ObjectTypeId::SystemEventType.into());
    Ok(all.map(|all| if is_of_conditions { all.with(FilterOperator::Or, marks()) } else { all }))
}

/// Part of a where clause.
enum Clause {
    Leaf(FilterOperator, Vec<Operand>),
    Both(FilterOperator, Box<Self>, Box<Self>),
}

impl Clause {
    fn of_type(id: NodeId) -> Self {
        Self::Leaf(FilterOperator::OfType, vec![Operand::literal(id)])
    }

    fn with(self, operator: FilterOperator, other: Self) -> Self {
        Self::Both(operator, Box::new(self), Box::new(other))
    }

    /// Returns the elements with the whole first; an element names only later ones (OPC 10000-4 §7.7.1).
    fn into_elements(self) -> Vec<ContentFilterElement> {
        let mut elements = Vec::new();
        self.append_to(&mut elements);
        elements
    }

    fn append_to(self, elements: &mut Vec<ContentFilterElement>) {
        match self {
            Self::Leaf(operator, operands) => elements.push((operator, operands).into()),
            Self::Both(operator, left, right) => {
                let own = elements.len();
                elements.push((operator, Vec::new()).into());
                let left_at = next_index(elements);
                left.append_to(elements);
                let right_at = next_index(elements);
                right.append_to(elements);
                let operands = vec![Operand::element(left_at), Operand::element(right_at)];
                elements[own] = (operator, operands).into();
            }
        }
    }
}

fn next_index(elements: &[ContentFilterElement]) -> u32 {
    u32::try_from(elements.len()).expect("a selection has a handful of clauses")
}

fn base_field(name: &str) -> SimpleAttributeOperand {
    value_at(ObjectTypeId::BaseEventType, vec![name.into()])
}

/// Returns the fields of a condition.
fn fields_of_conditions() -> [SimpleAttributeOperand; FIELDS] {
    let of_condition = |name: &str| value_at(ObjectTypeId::ConditionType, vec![name.into()]);
    [
        base_field("Severity"),
        base_field("Message"),
        // The condition itself: the NodeId of the instance (OPC 10000-9 §5.5.2.13).
        SimpleAttributeOperand {
            type_definition_id: ObjectTypeId::ConditionType.into(),
            browse_path: Some(Vec::new()),
            attribute_id: AttributeId::NodeId as u32,
            index_range: NumericRange::None,
        },
        of_condition("BranchId"),
        of_condition("Retain"),
        value_at(ObjectTypeId::AlarmConditionType, vec!["ActiveState".into(), "Id".into()]),
    ]
}

/// Returns the operand for the value of a field.
fn value_at(of: ObjectTypeId, path: Vec<QualifiedName>) -> SimpleAttributeOperand {
    SimpleAttributeOperand {
        type_definition_id: of.into(),
        browse_path: Some(path),
        attribute_id: AttributeId::Value as u32,
        index_range: NumericRange::None,
    }
}

#[cfg(test)]
mod tests {
    use asi_model::values::NodeId as ModelId;
    use opcua_stack::opcua::types::Variant;

    use super::*;
    use crate::BrowsePath;

    fn selection(value: EventValue) -> EventSelection {
        EventSelection { value, event_type: None, source_node: None, severity_min: None }
    }

    fn operators(filter: &EventFilter) -> Vec<FilterOperator> {
        let elements = filter.where_clause.elements.iter().flatten();
        elements.map(|element| element.filter_operator).collect()
    }

    /// Indexes of elements that each element names.
    fn named(filter: &EventFilter) -> Vec<Vec<u32>> {
        let elements = filter.where_clause.elements.iter().flatten();
        let named = elements.map(|element| {
            let operands = element.filter_operands.iter().flatten();
            let operands = operands.filter_map(|operand| Operand::try_from(operand.clone()).ok());
            let indexes = operands.filter_map(|operand| match operand {
                Operand::ElementOperand(element) => Some(element.index),
                _ => None,
            });
            indexes.collect()
        });
        named.collect()
    }

    #[test]
    fn the_whole_comes_first_and_names_what_comes_later() {
        use FilterOperator::{And, Equals, GreaterThanOrEqual, OfType, Or};
        let namespaces = NamespaceTable::new(["http://opcfoundation.org/UA/", "urn:press"]);
        let path = BrowsePath(Vec::new());
        let all = event_filter(&selection(EventValue::Field { path }), &namespaces);
        assert!(operators(&all.expect("no where clause")).is_empty());

        let mut last = selection(EventValue::Field { path: BrowsePath(Vec::new()) });
        last.severity_min = Some(500);
        let filter = event_filter(&last, &namespaces).expect("valid");
        assert_eq!(operators(&filter), [GreaterThanOrEqual]);
        last.event_type = Some(ModelId::ua(2915));
        last.source_node = Some(ModelId::string("urn:press", "Ram"));
        let filter = event_filter(&last, &namespaces).expect("valid");
        assert_eq!(operators(&filter), [And, And, OfType, Equals, GreaterThanOrEqual]);
        assert_eq!(named(&filter), [vec![1_u32, 4], vec![2, 3], vec![], vec![], vec![]]);

        let mut active = selection(EventValue::ActiveSeverity);
        active.severity_min = Some(500);
        let filter = event_filter(&active, &namespaces).expect("valid");
        // Severity is not asked of the server: a condition that is less severe must be heard of.
        assert_eq!(operators(&filter), [Or, OfType, OfType]);

        last.source_node = Some(ModelId::string("urn:another", "Ram"));
        assert!(event_filter(&last, &namespaces).is_err(), "the server has no such namespace");
    }

    #[test]
    fn severity_is_compared_as_the_type_that_it_has() {
        let mut last = selection(EventValue::Field { path: BrowsePath(Vec::new()) });
        last.severity_min = Some(1000);
        let namespaces = NamespaceTable::new(["http://opcfoundation.org/UA/"]);
        let filter = event_filter(&last, &namespaces).expect("valid");
        let elements = filter.where_clause.elements.expect("a where clause");
        let operands = elements[0].filter_operands.clone().expect("operands");
        match Operand::try_from(operands[1].clone()) {
            Ok(Operand::LiteralOperand(literal)) => {
                assert_eq!(literal.value, Variant::UInt16(1000));
            }
            other => panic!("a literal: {:?}", other.map(|_| ())),
        }
    }
}
