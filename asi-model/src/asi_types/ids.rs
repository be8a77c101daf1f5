//! Numeric ids of the types, which never change.

use crate::network::RelationType;

/// Type of the object that shows one operation network to local OPC UA clients.
pub const INTERFACE_TYPE: u32 = 1001;
/// Type of a network: its operations and the relations between them.
pub const OPERATION_NETWORK_TYPE: u32 = 1002;
/// Supertype of the three kinds of operations; abstract, so no instance has it itself.
pub const OPERATION_TYPE: u32 = 1003;
/// Type of operations that add value (ISA-95: production).
pub const PRODUCTION_OPERATION_TYPE: u32 = 1004;
/// Type of inspections and tests (ISA-95: quality).
pub const INSPECTION_OPERATION_TYPE: u32 = 1005;
/// Type of operations that move material between places.
pub const TRANSPORTATION_OPERATION_TYPE: u32 = 1006;
/// Type of the equipment that an operation needs (ISA-95: equipment requirement).
pub const EQUIPMENT_REQUIREMENT_TYPE: u32 = 1007;
/// Type of a relation: the start or finish of one operation depends on another's.
pub const OPERATION_RELATION_TYPE: u32 = 1008;
/// Type of one bound of a relation: a time, or a gap in milliseconds.
pub const RELATION_CONDITION_TYPE: u32 = 1009;
/// Type of a partner's request, below the operation that it asks about.
pub const DYNAMIC_DATA_REQUEST_TYPE: u32 = 1010;
/// Type of the object that holds one variable for each requested field.
pub const REPORT_DATA_FORMAT_TYPE: u32 = 1011;
/// HasOperation, a subtype of HasComponent.
pub const HAS_OPERATION: u32 = 2001;
/// OperationDependency (abstract, not hierarchical).
pub const OPERATION_DEPENDENCY: u32 = 2002;

/// The reference type between two related operations, from predecessor to successor.
#[must_use]
pub const fn dependency(relation_type: RelationType) -> u32 {
    2003 + relation_type as u32
}
