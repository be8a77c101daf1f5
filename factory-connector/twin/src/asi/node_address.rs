//! Address of a node within an Activity Status Interface.

/// Address of an object or of a report field's variable. Numbers are indexes within the interface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum NodeAddress {
    Interface,
    OperationNetwork,
    Operation(u32),
    /// Operation, equipment requirement within it.
    Requirement(u32, u32),
    Relation(u32),
    /// Relation, condition within it.
    Condition(u32, u32),
    Request(u32),
    ReportDataFormat(u32),
    Field(u32),
}
