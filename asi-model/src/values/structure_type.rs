//! Descriptions of structures: what fields a structure has (StructureDefinition, OPC 10000-3
//! §8.48), and the ones of namespace 0 that plants use.

use std::sync::{Arc, LazyLock};

use super::{BuiltInType, LocalizedText, NodeId};

/// Fields of a structure, to decode its values by name.
#[derive(Debug, Clone, PartialEq)]
pub struct StructureType {
    pub type_id: NodeId,
    /// Its encoding nodes, which older senders name instead of the DataType.
    pub encoding_ids: Vec<NodeId>,
    pub name: Arc<str>,
    pub kind: StructureKind,
    /// Its fields, in order.
    pub fields: Vec<StructureField>,
}

/// Presence of the fields of a structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum StructureKind {
    /// All of them, always.
    #[default]
    Plain,
    /// Some may be absent; a mask has a bit for each that is present.
    WithOptionalFields,
    /// Exactly one, or none.
    Union,
}

/// One field of a structure.
#[derive(Debug, Clone, PartialEq)]
pub struct StructureField {
    /// Its name, case-sensitive.
    pub name: Arc<str>,
    /// Its built-in type: Int32 for enumerations, ExtensionObject for structures, Variant where any
    /// value may stand.
    pub built_in_type: BuiltInType,
    /// Its data type; for a structure its description's `type_id`, or `i=22` where any structure
    /// may stand.
    pub data_type: NodeId,
    /// Meaning of the field, for people.
    pub description: Option<LocalizedText>,
    /// -1 scalar, 1 array, n matrix.
    pub value_rank: i32,
    /// The most elements of each dimension, 0 where there is no bound; empty where none is stated.
    pub array_dimensions: Vec<u32>,
    /// The most bytes of a text or ByteString; 0 where there is no bound.
    pub max_string_length: u32,
    /// True where the field may be absent.
    pub is_optional: bool,
}

/// The abstract DataType Structure, which every structure is a subtype of.
pub const STRUCTURE: NodeId = NodeId::ua(22);

impl StructureField {
    /// A scalar field of a built-in type.
    #[must_use]
    pub fn scalar(name: &str, built_in_type: BuiltInType) -> Self {
        Self {
            name: name.into(),
            built_in_type,
            data_type: NodeId::ua(u32::from(built_in_type.id())),
            description: None,
            value_rank: -1,
            array_dimensions: Vec::new(),
            max_string_length: 0,
            is_optional: false,
        }
    }

    /// A scalar field of a structure type.
    #[must_use]
    pub fn structure(name: &str, data_type: NodeId) -> Self {
        Self { data_type, ..Self::scalar(name, BuiltInType::ExtensionObject) }
    }

    /// The same field as a one-dimensional array.
    #[must_use]
    pub fn array(self) -> Self {
        Self { value_rank: 1, ..self }
    }
}

impl StructureType {
    /// True where a NodeId names this structure, by its DataType or one of its encodings.
    #[must_use]
    pub fn is_named_by(&self, id: &NodeId) -> bool {
        self.type_id == *id || self.encoding_ids.contains(id)
    }

    /// The description of a structure: among the given ones, else among those of namespace 0.
    #[must_use]
    pub fn find<'a>(described: &'a [Self], id: &NodeId) -> Option<&'a Self> {
        described
            .iter()
            .find(|known| known.is_named_by(id))
            .or_else(|| KNOWN.iter().find(|known| known.is_named_by(id)))
    }

    /// The structures of namespace 0 that are known without description.
    #[must_use]
    pub fn known() -> &'static [Self] {
        &KNOWN
    }
}

static KNOWN: LazyLock<Vec<StructureType>> = LazyLock::new(|| {
    use BuiltInType as T;
    use StructureField as F;
    let known = |id: u32, encodings: &[u32], name: &str, fields: Vec<F>| StructureType {
        type_id: NodeId::ua(id),
        encoding_ids: encodings.iter().map(|id| NodeId::ua(*id)).collect(),
        name: name.into(),
        kind: StructureKind::Plain,
        fields,
    };
    let doubles = |names: [&str; 3]| names.map(|name| F::scalar(name, T::Double)).to_vec();
    vec![
        known(
            884,
            &[885, 886, 15375],
            "Range",
            vec![F::scalar("Low", T::Double), F::scalar("High", T::Double)],
        ),
        known(
            887,
            &[888, 889, 15376],
            "EUInformation",
            vec![
                F::scalar("NamespaceUri", T::String),
                F::scalar("UnitId", T::Int32),
                F::scalar("DisplayName", T::LocalizedText),
                F::scalar("Description", T::LocalizedText),
            ],
        ),
        known(
            12171,
            &[12173, 12181, 15377],
            "ComplexNumberType",
            vec![F::scalar("Real", T::Float), F::scalar("Imaginary", T::Float)],
        ),
        known(
            12172,
            &[12174, 12182, 15378],
            "DoubleComplexNumberType",
            vec![F::scalar("Real", T::Double), F::scalar("Imaginary", T::Double)],
        ),
        known(
            12079,
            &[12081, 12089, 15379],
            "AxisInformation",
            vec![
                F::structure("EngineeringUnits", NodeId::ua(887)),
                F::structure("EURange", NodeId::ua(884)),
                F::scalar("Title", T::LocalizedText),
                F { data_type: NodeId::ua(12077), ..F::scalar("AxisScaleType", T::Int32) },
                F::scalar("AxisSteps", T::Double).array(),
            ],
        ),
        known(
            12080,
            &[12082, 12090, 15380],
            "XVType",
            vec![F::scalar("X", T::Double), F::scalar("Value", T::Float)],
        ),
        known(
            14533,
            &[14802, 14846, 15041],
            "KeyValuePair",
            vec![F::scalar("Key", T::QualifiedName), F::scalar("Value", T::Variant)],
        ),
        known(
            7594,
            &[7616, 8251, 15082],
            "EnumValueType",
            vec![
                F::scalar("Value", T::Int64),
                F::scalar("DisplayName", T::LocalizedText),
                F::scalar("Description", T::LocalizedText),
            ],
        ),
        known(
            8912,
            &[8913, 8917, 15086],
            "TimeZoneDataType",
            vec![F::scalar("Offset", T::Int16), F::scalar("DaylightSavingInOffset", T::Boolean)],
        ),
        known(
            296,
            &[297, 298, 15081],
            "Argument",
            vec![
                F::scalar("Name", T::String),
                F::scalar("DataType", T::NodeId),
                F::scalar("ValueRank", T::Int32),
                F::scalar("ArrayDimensions", T::UInt32).array(),
                F::scalar("Description", T::LocalizedText),
            ],
        ),
        known(18808, &[18817, 18853, 19066], "3DVector", doubles(["X", "Y", "Z"])),
        known(18810, &[18819, 18855, 19068], "3DCartesianCoordinates", doubles(["X", "Y", "Z"])),
        known(18812, &[18821, 18857, 19070], "3DOrientation", doubles(["A", "B", "C"])),
        known(
            18814,
            &[18823, 18859, 19072],
            "3DFrame",
            vec![
                F::structure("CartesianCoordinates", NodeId::ua(18810)),
                F::structure("Orientation", NodeId::ua(18812)),
            ],
        ),
    ]
});
