//! Descriptions of data types that are no structures: enumerations (EnumDescription, OPC 10000-5
//! §12.34) and other names for simple types (SimpleTypeDescription, §12.35).

use std::sync::{Arc, LazyLock};

use super::{BuiltInType, LocalizedText, NodeId};

/// Names of an enumeration's values, to show numbers as texts.
#[derive(Debug, Clone, PartialEq)]
pub struct EnumType {
    pub type_id: NodeId,
    pub name: Arc<str>,
    /// Built-in type of its values: Int32, or an unsigned integer for option sets.
    pub built_in_type: BuiltInType,
    /// Its values, in order.
    pub values: Vec<EnumValue>,
}

impl EnumType {
    /// The description of an enumeration: among the given ones, else among those that structures of
    /// namespace 0 use.
    #[must_use]
    pub fn find<'a>(described: &'a [Self], id: &NodeId) -> Option<&'a Self> {
        described.iter().chain(KNOWN.iter()).find(|known| known.type_id == *id)
    }

    /// The name of a value, where it has one.
    #[must_use]
    pub fn name_of(&self, value: i64) -> Option<&str> {
        self.values
            .iter()
            .find(|known| known.value == value)
            .map(|known| &*known.name)
            .filter(|name| !name.is_empty())
    }
}

static KNOWN: LazyLock<[EnumType; 1]> = LazyLock::new(|| {
    let values = ["Linear", "Log", "Ln"].into_iter().zip(0_i64..);
    [EnumType {
        type_id: NodeId::ua(12077),
        name: "AxisScaleEnumeration".into(),
        built_in_type: BuiltInType::Int32,
        values: values
            .map(|(name, value)| EnumValue { value, name: name.into(), ..EnumValue::default() })
            .collect(),
    }]
});

/// One value of an enumeration.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EnumValue {
    /// The number; for option sets the number of the bit.
    pub value: i64,
    pub name: Arc<str>,
    /// Its name for people.
    pub display_name: LocalizedText,
    pub description: LocalizedText,
}

/// Another name for a simple type, as Duration is one for Double.
#[derive(Debug, Clone, PartialEq)]
pub struct SimpleType {
    pub type_id: NodeId,
    pub name: Arc<str>,
    /// The DataType it specialises.
    pub base_type: NodeId,
    /// Built-in type of its values.
    pub built_in_type: BuiltInType,
}
