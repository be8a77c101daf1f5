//! The tables.

use super::{
    Argument, DYNAMIC_DATA_REQUEST_TYPE, DataType, EQUIPMENT_REQUIREMENT_TYPE, Enumeration,
    HAS_OPERATION, INSPECTION_OPERATION_TYPE, INTERFACE_TYPE, Method, OPERATION_DEPENDENCY,
    OPERATION_NETWORK_TYPE, OPERATION_RELATION_TYPE, OPERATION_TYPE, ObjectType,
    PRODUCTION_OPERATION_TYPE, Part, PartKind, RELATION_CONDITION_TYPE, REPORT_DATA_FORMAT_TYPE,
    ReferenceSupertype, ReferenceType, TRANSPORTATION_OPERATION_TYPE, ValueType,
};

const STRING: DataType = DataType::Standard(12);
const UTC_TIME: DataType = DataType::Standard(294);
const DOUBLE: DataType = DataType::Standard(11);

const fn property(name: &'static str, is_mandatory: bool, data_type: DataType) -> Part {
    let value = ValueType { data_type, value_rank: -1 };
    Part { name, is_standard: false, is_mandatory, kind: PartKind::Property(value) }
}

const fn component(name: &'static str, data_type: DataType) -> Part {
    let value = ValueType { data_type, value_rank: -1 };
    Part { name, is_standard: false, is_mandatory: false, kind: PartKind::Component(value) }
}

const fn standard(name: &'static str, data_type: u32) -> Part {
    let value = ValueType { data_type: DataType::Standard(data_type), value_rank: -1 };
    Part { name, is_standard: true, is_mandatory: false, kind: PartKind::Property(value) }
}

const NODE_VERSION: Part = standard("NodeVersion", 12);

/// States of a field's decision.
pub static MAPPING_STATE: Enumeration =
    Enumeration { id: 3001, name: "MappingState", values: &["Pending", "Mapped", "Refused"] };
/// Sources of a mapped field's values.
pub static VALUE_SOURCE: Enumeration =
    Enumeration { id: 3002, name: "ValueSource", values: &["Mapping", "Manual", "External"] };
/// Dependencies between two operations.
pub static RELATION_TYPE: Enumeration = Enumeration {
    id: 3003,
    name: "RelationType",
    values: &["FinishToStart", "StartToStart", "FinishToFinish", "StartToFinish"],
};
/// Kinds of conditions.
pub static CONDITION_KIND: Enumeration = Enumeration {
    id: 3004,
    name: "ConditionKind",
    values: &[
        "StartNoEarlierThan",
        "StartNoLaterThan",
        "FinishNoEarlierThan",
        "FinishNoLaterThan",
        "MinimumGap",
        "MaximumGap",
    ],
};
/// The state of an operation.
pub static OPERATION_STATE: Enumeration = Enumeration {
    id: 3005,
    name: "OperationState",
    values: &["NotAllowedToStart", "AllowedToStart", "Running", "Interrupted", "Ended", "Aborted"],
};
/// The period of an update frequency.
pub static UPDATE_FREQUENCY_UNIT: Enumeration = Enumeration {
    id: 3006,
    name: "UpdateFrequencyUnit",
    values: &["Second", "Minute", "Hour", "Day", "Week"],
};

/// All enumerations.
pub static ENUMERATIONS: [&Enumeration; 6] = [
    &MAPPING_STATE,
    &VALUE_SOURCE,
    &RELATION_TYPE,
    &CONDITION_KIND,
    &OPERATION_STATE,
    &UPDATE_FREQUENCY_UNIT,
];

static EXPORT_NODE_SET: Method = Method {
    inputs: &[],
    outputs: &[Argument {
        name: "NodeSet",
        data_type: DataType::Standard(15),
        description: "The interface as a NodeSet2 document in UTF-8.",
    }],
};

static DECIDE: Method = Method {
    inputs: &[
        Argument {
            name: "FieldName",
            data_type: DataType::Standard(12),
            description: "The report field to decide.",
        },
        Argument {
            name: "MappingState",
            data_type: DataType::Enumeration(&MAPPING_STATE),
            description: "The new state. Mapped means that OPC UA clients write the values.",
        },
        Argument {
            name: "Reason",
            data_type: DataType::Standard(12),
            description: "Why; the requester reads it. Needed to refuse.",
        },
    ],
    outputs: &[],
};

const fn method(name: &'static str, model: &'static Method) -> Part {
    Part { name, is_standard: false, is_mandatory: false, kind: PartKind::Method(model) }
}

const fn object(name: &'static str, type_id: u32) -> Part {
    Part { name, is_standard: false, is_mandatory: true, kind: PartKind::Object(type_id) }
}

/// All object types.
pub static OBJECT_TYPES: [ObjectType; 11] = [
    ObjectType {
        id: INTERFACE_TYPE,
        name: "ActivityStatusInterfaceType",
        supertype: None,
        is_abstract: false,
        description: "What partners want to know about the operations of one network in this \
                      factory.",
        parts: &[
            property("CollaborationId", true, STRING),
            property("Revision", true, DataType::Standard(9)),
            property("ReceivedTime", true, UTC_TIME),
            NODE_VERSION,
            object("OperationNetwork", OPERATION_NETWORK_TYPE),
            method("ExportNodeSet", &EXPORT_NODE_SET),
        ],
    },
    ObjectType {
        id: OPERATION_NETWORK_TYPE,
        name: "OperationNetworkType",
        supertype: None,
        is_abstract: false,
        description: "Operations and the relations between them.",
        parts: &[
            property("OperationNetworkId", true, STRING),
            property("Name", false, STRING),
            property("Description", false, STRING),
            NODE_VERSION,
        ],
    },
    ObjectType {
        id: OPERATION_TYPE,
        name: "OperationType",
        supertype: None,
        is_abstract: true,
        description: "One step of making something together.",
        parts: &[
            property("OperationId", true, STRING),
            property("Name", false, STRING),
            property("Description", false, STRING),
            property("OwningFactoryId", false, STRING),
            property("PlannedStart", false, UTC_TIME),
            property("PlannedEnd", false, UTC_TIME),
            component("PlannedQuantity", DOUBLE),
            component("State", DataType::Enumeration(&OPERATION_STATE)),
            NODE_VERSION,
        ],
    },
    ObjectType {
        id: PRODUCTION_OPERATION_TYPE,
        name: "ProductionOperationType",
        supertype: Some(OPERATION_TYPE),
        is_abstract: false,
        description: "A value-adding step.",
        parts: &[property("ProductId", false, STRING)],
    },
    ObjectType {
        id: INSPECTION_OPERATION_TYPE,
        name: "InspectionOperationType",
        supertype: Some(OPERATION_TYPE),
        is_abstract: false,
        description: "Any quality inspection or test.",
        parts: &[
            property("InspectedOperationId", false, STRING),
            property("Characteristic", false, STRING),
        ],
    },
    ObjectType {
        id: TRANSPORTATION_OPERATION_TYPE,
        name: "TransportationOperationType",
        supertype: Some(OPERATION_TYPE),
        is_abstract: false,
        description: "Moving things.",
        parts: &[property("Origin", false, STRING), property("Destination", false, STRING)],
    },
    ObjectType {
        id: EQUIPMENT_REQUIREMENT_TYPE,
        name: "EquipmentRequirementType",
        supertype: None,
        is_abstract: false,
        description: "Equipment that an operation needs.",
        parts: &[
            property("EquipmentRequirementId", true, STRING),
            property("EquipmentType", true, STRING),
            property("Capability", false, STRING),
            property("Quantity", false, DOUBLE),
            property("AssetId", false, STRING),
        ],
    },
    ObjectType {
        id: OPERATION_RELATION_TYPE,
        name: "OperationRelationType",
        supertype: None,
        is_abstract: false,
        description: "How the start or finish of one operation depends on another's.",
        parts: &[
            property("OperationRelationId", true, STRING),
            property("RelationType", true, DataType::Enumeration(&RELATION_TYPE)),
            property("PredecessorOperationId", true, STRING),
            property("SuccessorOperationId", true, STRING),
        ],
    },
    ObjectType {
        id: RELATION_CONDITION_TYPE,
        name: "RelationConditionType",
        supertype: None,
        is_abstract: false,
        description: "A bound on a relation: a time, or a gap in milliseconds.",
        parts: &[
            property("ConditionId", true, STRING),
            property("ConditionKind", true, DataType::Enumeration(&CONDITION_KIND)),
            property("Time", false, UTC_TIME),
            property("Duration", false, DataType::Standard(290)),
        ],
    },
    ObjectType {
        id: DYNAMIC_DATA_REQUEST_TYPE,
        name: "DynamicDataRequestType",
        supertype: None,
        is_abstract: false,
        description: "A partner's wish to hear about an operation.",
        parts: &[
            property("DynamicDataRequestId", true, STRING),
            property("DynamicDataRequestPublisherId", false, STRING),
            property("RequesterId", true, STRING),
            Part {
                name: "Recipients",
                is_standard: false,
                is_mandatory: true,
                kind: PartKind::Property(ValueType { data_type: STRING, value_rank: 1 }),
            },
            property("Purpose", true, STRING),
            property("ValidFrom", false, UTC_TIME),
            property("ValidUntil", false, UTC_TIME),
            property("Description", false, STRING),
            property("BufferId", false, STRING),
            property("UpdateFrequency", false, DataType::Standard(7)),
            property("UpdateFrequencyUnit", false, DataType::Enumeration(&UPDATE_FREQUENCY_UNIT)),
            property("DataSetWriterId", false, DataType::Standard(5)),
            NODE_VERSION,
            object("ReportDataFormat", REPORT_DATA_FORMAT_TYPE),
            method("Decide", &DECIDE),
        ],
    },
    ObjectType {
        id: REPORT_DATA_FORMAT_TYPE,
        name: "ReportDataFormatType",
        supertype: None,
        is_abstract: false,
        description: "The composition of a report: one variable per field.",
        parts: &[property("ReportName", true, STRING), NODE_VERSION],
    },
];

/// The properties of a report field. A field has no type of its own, so no type declares them.
pub static FIELD_PARTS: [Part; 10] = [
    standard("EngineeringUnits", 887),
    standard("EURange", 884),
    property("IsMapped", true, DataType::Standard(1)),
    property("MappingState", true, DataType::Enumeration(&MAPPING_STATE)),
    property("ValueSource", true, DataType::Enumeration(&VALUE_SOURCE)),
    property("Semantic", false, STRING),
    property("Disclosure", true, STRING),
    property("DecisionReason", true, STRING),
    property("DecidedBy", true, STRING),
    property("DecisionTime", true, UTC_TIME),
];

/// The reference types; that of a relation is [`dependency`](super::dependency).
pub static REFERENCE_TYPES: [ReferenceType; 6] = [
    ReferenceType {
        id: HAS_OPERATION,
        name: "HasOperation",
        inverse_name: Some("OperationOf"),
        is_abstract: false,
        supertype: ReferenceSupertype::Standard(47),
    },
    ReferenceType {
        id: OPERATION_DEPENDENCY,
        name: "OperationDependency",
        inverse_name: None,
        is_abstract: true,
        supertype: ReferenceSupertype::Standard(32),
    },
    dependency_model(2003, "FinishToStart", "StartsAfterFinishOf"),
    dependency_model(2004, "StartToStart", "StartsAfterStartOf"),
    dependency_model(2005, "FinishToFinish", "FinishesAfterFinishOf"),
    dependency_model(2006, "StartToFinish", "FinishesAfterStartOf"),
];

const fn dependency_model(
    id: u32,
    name: &'static str,
    inverse_name: &'static str,
) -> ReferenceType {
    ReferenceType {
        id,
        name,
        inverse_name: Some(inverse_name),
        is_abstract: false,
        supertype: ReferenceSupertype::Asi(OPERATION_DEPENDENCY),
    }
}
