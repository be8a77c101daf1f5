//! Numeric ids of the types, which never change.

use crate::network::RelationType;

/// ActivityStatusInterfaceType.
pub const INTERFACE_TYPE: u32 = 1001;
/// OperationNetworkType.
pub const OPERATION_NETWORK_TYPE: u32 = 1002;
/// OperationType (abstract).
pub const OPERATION_TYPE: u32 = 1003;
/// ProductionOperationType.
pub const PRODUCTION_OPERATION_TYPE: u32 = 1004;
/// InspectionOperationType.
pub const INSPECTION_OPERATION_TYPE: u32 = 1005;
/// TransportationOperationType.
pub const TRANSPORTATION_OPERATION_TYPE: u32 = 1006;
/// EquipmentRequirementType.
pub const EQUIPMENT_REQUIREMENT_TYPE: u32 = 1007;
/// OperationRelationType.
pub const OPERATION_RELATION_TYPE: u32 = 1008;
/// RelationConditionType.
pub const RELATION_CONDITION_TYPE: u32 = 1009;
/// DynamicDataRequestType.
pub const DYNAMIC_DATA_REQUEST_TYPE: u32 = 1010;
/// ReportDataFormatType.
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
