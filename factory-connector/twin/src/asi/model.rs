//! The ASI type model as data: object types with their parts, reference types and enumerations.
//!
//! The tables say what the nodes in the type namespace look like and which parts an instance has, so that both cannot
//! drift apart. Numeric ids never change; new entries get new ids.

use opcua_stack::opcua::types::{DataTypeId, ObjectTypeId, ReferenceTypeId, VariableTypeId};

/// The namespace of the types.
pub(crate) const TYPE_NAMESPACE_URI: &str = "urn:verbund:UA:ASI";
/// The version of the type model.
pub(crate) const TYPE_MODEL_VERSION: &str = "1.0.0";

/// The namespace of a factory's instances.
pub(crate) fn instance_namespace_uri(factory_id: &asi_model::FactoryId) -> String {
    format!("urn:verbund:cpt:{factory_id}")
}

/// An object type.
#[derive(Debug)]
pub(crate) struct ObjectTypeModel {
    pub id: u32,
    pub name: &'static str,
    pub supertype: Supertype,
    pub is_abstract: bool,
    pub description: &'static str,
    /// Properties, component variables, fixed component objects and methods. A declaration's node id is the type's id
    /// times 100 plus its number here, which begins at 1.
    pub parts: &'static [PartModel],
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Supertype {
    Base,
    Asi(u32),
}

/// A part that has a fixed BrowseName.
#[derive(Debug, PartialEq)]
pub(crate) struct PartModel {
    pub name: &'static str,
    /// Whether the BrowseName is the standard's (namespace 0).
    pub is_standard: bool,
    pub is_mandatory: bool,
    pub kind: PartKind,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum PartKind {
    Property(ValueModel),
    /// A component variable: BaseDataVariableType or, where it has a unit, AnalogUnitType.
    Component(ValueModel),
    /// A component object of an ASI type.
    Object(u32),
    Method(&'static MethodModel),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ValueModel {
    pub data_type: DataTypeRef,
    pub value_rank: i32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DataTypeRef {
    Standard(DataTypeId),
    Enumeration(&'static EnumerationModel),
}

#[derive(Debug, PartialEq, Eq)]
pub(crate) struct MethodModel {
    /// Its number among the ids of method declarations.
    pub inputs: &'static [ArgumentModel],
    pub outputs: &'static [ArgumentModel],
    pub callable_by: crate::access::Role,
}

#[derive(Debug, PartialEq, Eq)]
pub(crate) struct ArgumentModel {
    pub name: &'static str,
    pub data_type: DataTypeRef,
    pub description: &'static str,
}

/// An enumeration whose values count from 0.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct EnumerationModel {
    pub id: u32,
    pub name: &'static str,
    pub values: &'static [&'static str],
}

/// A reference type.
#[derive(Debug)]
pub(crate) struct ReferenceTypeModel {
    pub id: u32,
    pub name: &'static str,
    pub inverse_name: Option<&'static str>,
    pub is_abstract: bool,
    pub supertype: ReferenceSupertype,
}

#[derive(Debug, Clone, Copy)]
pub(crate) enum ReferenceSupertype {
    Standard(ReferenceTypeId),
    Asi(u32),
}

const STRING: DataTypeRef = DataTypeRef::Standard(DataTypeId::String);
const UTC_TIME: DataTypeRef = DataTypeRef::Standard(DataTypeId::UtcTime);
const DOUBLE: DataTypeRef = DataTypeRef::Standard(DataTypeId::Double);

const fn property(name: &'static str, is_mandatory: bool, data_type: DataTypeRef) -> PartModel {
    let value = ValueModel { data_type, value_rank: -1 };
    PartModel { name, is_standard: false, is_mandatory, kind: PartKind::Property(value) }
}

const fn component(name: &'static str, data_type: DataTypeRef) -> PartModel {
    let value = ValueModel { data_type, value_rank: -1 };
    PartModel { name, is_standard: false, is_mandatory: false, kind: PartKind::Component(value) }
}

const fn standard(name: &'static str, data_type: DataTypeId) -> PartModel {
    let value = ValueModel { data_type: DataTypeRef::Standard(data_type), value_rank: -1 };
    PartModel { name, is_standard: true, is_mandatory: false, kind: PartKind::Property(value) }
}

const NODE_VERSION: PartModel = standard("NodeVersion", DataTypeId::String);

pub(crate) static MAPPING_STATE: EnumerationModel =
    EnumerationModel { id: 3001, name: "MappingState", values: &["Pending", "Mapped", "Refused"] };
pub(crate) static VALUE_SOURCE: EnumerationModel =
    EnumerationModel { id: 3002, name: "ValueSource", values: &["Mapping", "Manual", "External"] };
pub(crate) static RELATION_TYPE: EnumerationModel = EnumerationModel {
    id: 3003,
    name: "RelationType",
    values: &["FinishToStart", "StartToStart", "FinishToFinish", "StartToFinish"],
};
pub(crate) static CONDITION_KIND: EnumerationModel = EnumerationModel {
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
pub(crate) static OPERATION_STATE: EnumerationModel = EnumerationModel {
    id: 3005,
    name: "OperationState",
    values: &["NotAllowedToStart", "AllowedToStart", "Running", "Interrupted", "Ended", "Aborted"],
};
pub(crate) static UPDATE_FREQUENCY_UNIT: EnumerationModel =
    EnumerationModel { id: 3006, name: "UpdateFrequencyUnit", values: &["Second", "Minute", "Hour", "Day", "Week"] };

pub(crate) static ENUMERATIONS: [&EnumerationModel; 6] =
    [&MAPPING_STATE, &VALUE_SOURCE, &RELATION_TYPE, &CONDITION_KIND, &OPERATION_STATE, &UPDATE_FREQUENCY_UNIT];

static EXPORT_NODE_SET: MethodModel = MethodModel {
    inputs: &[],
    outputs: &[ArgumentModel {
        name: "NodeSet",
        data_type: DataTypeRef::Standard(DataTypeId::ByteString),
        description: "The interface as a NodeSet2 document in UTF-8.",
    }],
    callable_by: crate::access::Role::Viewer,
};

static DECIDE: MethodModel = MethodModel {
    inputs: &[
        ArgumentModel {
            name: "FieldName",
            data_type: DataTypeRef::Standard(DataTypeId::String),
            description: "The report field to decide.",
        },
        ArgumentModel {
            name: "MappingState",
            data_type: DataTypeRef::Enumeration(&MAPPING_STATE),
            description: "The new state. Mapped means that OPC UA clients write the values.",
        },
        ArgumentModel {
            name: "Reason",
            data_type: DataTypeRef::Standard(DataTypeId::String),
            description: "Why; the requester reads it. Needed to refuse.",
        },
    ],
    outputs: &[],
    callable_by: crate::access::Role::Engineer,
};

pub(crate) const INTERFACE_TYPE: u32 = 1001;
pub(crate) const OPERATION_NETWORK_TYPE: u32 = 1002;
pub(crate) const OPERATION_TYPE: u32 = 1003;
pub(crate) const PRODUCTION_OPERATION_TYPE: u32 = 1004;
pub(crate) const INSPECTION_OPERATION_TYPE: u32 = 1005;
pub(crate) const TRANSPORTATION_OPERATION_TYPE: u32 = 1006;
pub(crate) const EQUIPMENT_REQUIREMENT_TYPE: u32 = 1007;
pub(crate) const OPERATION_RELATION_TYPE: u32 = 1008;
pub(crate) const RELATION_CONDITION_TYPE: u32 = 1009;
pub(crate) const DYNAMIC_DATA_REQUEST_TYPE: u32 = 1010;
pub(crate) const REPORT_DATA_FORMAT_TYPE: u32 = 1011;

const fn method(name: &'static str, model: &'static MethodModel) -> PartModel {
    PartModel { name, is_standard: false, is_mandatory: false, kind: PartKind::Method(model) }
}

const fn object(name: &'static str, type_id: u32) -> PartModel {
    PartModel { name, is_standard: false, is_mandatory: true, kind: PartKind::Object(type_id) }
}

pub(crate) static OBJECT_TYPES: [ObjectTypeModel; 11] = [
    ObjectTypeModel {
        id: INTERFACE_TYPE,
        name: "ActivityStatusInterfaceType",
        supertype: Supertype::Base,
        is_abstract: false,
        description: "What partners want to know about the operations of one network in this factory.",
        parts: &[
            property("CollaborationId", true, STRING),
            property("Revision", true, DataTypeRef::Standard(DataTypeId::UInt64)),
            property("ReceivedTime", true, UTC_TIME),
            NODE_VERSION,
            object("OperationNetwork", OPERATION_NETWORK_TYPE),
            method("ExportNodeSet", &EXPORT_NODE_SET),
        ],
    },
    ObjectTypeModel {
        id: OPERATION_NETWORK_TYPE,
        name: "OperationNetworkType",
        supertype: Supertype::Base,
        is_abstract: false,
        description: "Operations and the relations between them.",
        parts: &[
            property("OperationNetworkId", true, STRING),
            property("Name", false, STRING),
            property("Description", false, STRING),
            NODE_VERSION,
        ],
    },
    ObjectTypeModel {
        id: OPERATION_TYPE,
        name: "OperationType",
        supertype: Supertype::Base,
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
            component("State", DataTypeRef::Enumeration(&OPERATION_STATE)),
            NODE_VERSION,
        ],
    },
    ObjectTypeModel {
        id: PRODUCTION_OPERATION_TYPE,
        name: "ProductionOperationType",
        supertype: Supertype::Asi(OPERATION_TYPE),
        is_abstract: false,
        description: "A value-adding step.",
        parts: &[property("ProductId", false, STRING)],
    },
    ObjectTypeModel {
        id: INSPECTION_OPERATION_TYPE,
        name: "InspectionOperationType",
        supertype: Supertype::Asi(OPERATION_TYPE),
        is_abstract: false,
        description: "Any quality inspection or test.",
        parts: &[property("InspectedOperationId", false, STRING), property("Characteristic", false, STRING)],
    },
    ObjectTypeModel {
        id: TRANSPORTATION_OPERATION_TYPE,
        name: "TransportationOperationType",
        supertype: Supertype::Asi(OPERATION_TYPE),
        is_abstract: false,
        description: "Moving things.",
        parts: &[property("Origin", false, STRING), property("Destination", false, STRING)],
    },
    ObjectTypeModel {
        id: EQUIPMENT_REQUIREMENT_TYPE,
        name: "EquipmentRequirementType",
        supertype: Supertype::Base,
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
    ObjectTypeModel {
        id: OPERATION_RELATION_TYPE,
        name: "OperationRelationType",
        supertype: Supertype::Base,
        is_abstract: false,
        description: "How the start or finish of one operation depends on another's.",
        parts: &[
            property("OperationRelationId", true, STRING),
            property("RelationType", true, DataTypeRef::Enumeration(&RELATION_TYPE)),
            property("PredecessorOperationId", true, STRING),
            property("SuccessorOperationId", true, STRING),
        ],
    },
    ObjectTypeModel {
        id: RELATION_CONDITION_TYPE,
        name: "RelationConditionType",
        supertype: Supertype::Base,
        is_abstract: false,
        description: "A bound on a relation: a time, or a gap in milliseconds.",
        parts: &[
            property("ConditionId", true, STRING),
            property("ConditionKind", true, DataTypeRef::Enumeration(&CONDITION_KIND)),
            property("Time", false, UTC_TIME),
            property("Duration", false, DataTypeRef::Standard(DataTypeId::Duration)),
        ],
    },
    ObjectTypeModel {
        id: DYNAMIC_DATA_REQUEST_TYPE,
        name: "DynamicDataRequestType",
        supertype: Supertype::Base,
        is_abstract: false,
        description: "A partner's wish to hear about an operation.",
        parts: &[
            property("DynamicDataRequestId", true, STRING),
            property("DynamicDataRequestPublisherId", false, STRING),
            property("RequesterId", true, STRING),
            PartModel {
                name: "Recipients",
                is_standard: false,
                is_mandatory: true,
                kind: PartKind::Property(ValueModel { data_type: STRING, value_rank: 1 }),
            },
            property("Purpose", true, STRING),
            property("ValidFrom", false, UTC_TIME),
            property("ValidUntil", false, UTC_TIME),
            property("Description", false, STRING),
            property("BufferId", false, STRING),
            property("UpdateFrequency", false, DataTypeRef::Standard(DataTypeId::UInt32)),
            property("UpdateFrequencyUnit", false, DataTypeRef::Enumeration(&UPDATE_FREQUENCY_UNIT)),
            property("DataSetWriterId", false, DataTypeRef::Standard(DataTypeId::UInt16)),
            NODE_VERSION,
            object("ReportDataFormat", REPORT_DATA_FORMAT_TYPE),
            method("Decide", &DECIDE),
        ],
    },
    ObjectTypeModel {
        id: REPORT_DATA_FORMAT_TYPE,
        name: "ReportDataFormatType",
        supertype: Supertype::Base,
        is_abstract: false,
        description: "The composition of a report: one variable per field.",
        parts: &[property("ReportName", true, STRING), NODE_VERSION],
    },
];

/// The properties of a report field. A field has no type of its own, so no type declares them.
pub(crate) static FIELD_PARTS: [PartModel; 10] = [
    standard("EngineeringUnits", DataTypeId::EUInformation),
    standard("EURange", DataTypeId::Range),
    property("IsMapped", true, DataTypeRef::Standard(DataTypeId::Boolean)),
    property("MappingState", true, DataTypeRef::Enumeration(&MAPPING_STATE)),
    property("ValueSource", true, DataTypeRef::Enumeration(&VALUE_SOURCE)),
    property("Semantic", false, STRING),
    property("Disclosure", true, STRING),
    property("DecisionReason", true, STRING),
    property("DecidedBy", true, STRING),
    property("DecisionTime", true, UTC_TIME),
];

/// The property of a component variable that has a unit.
pub(crate) static UNIT_PART: PartModel = standard("EngineeringUnits", DataTypeId::EUInformation);
/// The properties of a method.
pub(crate) static INPUT_ARGUMENTS: PartModel = arguments("InputArguments");
/// The properties of a method.
pub(crate) static OUTPUT_ARGUMENTS: PartModel = arguments("OutputArguments");
/// The property of the folder that holds all interfaces.
pub(crate) static FOLDER_PARTS: [PartModel; 1] = [NODE_VERSION];

const fn arguments(name: &'static str) -> PartModel {
    let value = ValueModel { data_type: DataTypeRef::Standard(DataTypeId::Argument), value_rank: 1 };
    PartModel { name, is_standard: true, is_mandatory: false, kind: PartKind::Property(value) }
}

pub(crate) const HAS_OPERATION: u32 = 2001;
pub(crate) const OPERATION_DEPENDENCY: u32 = 2002;

/// The reference types; that of a relation is [`dependency`].
pub(crate) static REFERENCE_TYPES: [ReferenceTypeModel; 6] = [
    ReferenceTypeModel {
        id: HAS_OPERATION,
        name: "HasOperation",
        inverse_name: Some("OperationOf"),
        is_abstract: false,
        supertype: ReferenceSupertype::Standard(ReferenceTypeId::HasComponent),
    },
    ReferenceTypeModel {
        id: OPERATION_DEPENDENCY,
        name: "OperationDependency",
        inverse_name: None,
        is_abstract: true,
        supertype: ReferenceSupertype::Standard(ReferenceTypeId::NonHierarchicalReferences),
    },
    dependency_model(2003, "FinishToStart", "StartsAfterFinishOf"),
    dependency_model(2004, "StartToStart", "StartsAfterStartOf"),
    dependency_model(2005, "FinishToFinish", "FinishesAfterFinishOf"),
    dependency_model(2006, "StartToFinish", "FinishesAfterStartOf"),
];

const fn dependency_model(id: u32, name: &'static str, inverse_name: &'static str) -> ReferenceTypeModel {
    ReferenceTypeModel {
        id,
        name,
        inverse_name: Some(inverse_name),
        is_abstract: false,
        supertype: ReferenceSupertype::Asi(OPERATION_DEPENDENCY),
    }
}

/// The reference type between two related operations, from predecessor to successor.
pub(crate) const fn dependency(relation_type: asi_model::network::RelationType) -> u32 {
    2003 + relation_type as u32
}

/// The object type with this id.
pub(crate) fn object_type(id: u32) -> &'static ObjectTypeModel {
    OBJECT_TYPES.iter().find(|t| t.id == id).expect("ids of object types come from the table")
}

/// The parts of a type, those of its supertypes first.
pub(crate) fn parts_of_type(id: u32) -> impl Iterator<Item = &'static PartModel> {
    let model = object_type(id);
    let inherited: &'static [PartModel] = match model.supertype {
        Supertype::Asi(supertype) => object_type(supertype).parts,
        Supertype::Base => &[],
    };
    inherited.iter().chain(model.parts)
}

/// The standard supertype of all object types.
pub(crate) const BASE_OBJECT_TYPE: ObjectTypeId = ObjectTypeId::BaseObjectType;
/// The type definition of properties.
pub(crate) const PROPERTY_TYPE: VariableTypeId = VariableTypeId::PropertyType;
