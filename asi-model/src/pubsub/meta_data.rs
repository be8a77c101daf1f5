//! Metadata: what the fields of a data set are (DataSetMetaDataType, OPC 10000-14 §6.2.3.2).

use std::sync::Arc;

use uuid::Uuid;

use crate::{
    asi_types::ASI_NAMESPACE_URI,
    messages::DisclosureStatement,
    network::{ReportField, Semantic},
    units::{self, EngineeringUnit},
    values::{
        BuiltInType, EnumType, LocalizedText, Namespace, NodeId, QualifiedName, Scalar, SimpleType,
        StructureType, Variant,
    },
};

/// Property of a field: its unit as EUInformation (BrowseName of namespace 0).
pub const PROPERTY_ENGINEERING_UNITS: &str = "EngineeringUnits";
/// Property of a field: its semantic as text (BrowseName of the ASI namespace).
pub const PROPERTY_SEMANTIC: &str = "Semantic";
/// Property of a field: how its value is coarsened, in words (BrowseName of the ASI namespace).
pub const PROPERTY_DISCLOSURE: &str = "Disclosure";

/// The version of a data set's metadata (ConfigurationVersionDataType).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct MetaDataVersion {
    /// VersionTime; changes when fields are removed, inserted or retyped. In Verbund the writer's
    /// *epoch*.
    pub major: u32,
    /// VersionTime; changes also when fields are appended.
    pub minor: u32,
}

/// Description of a data set and its fields.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DataSetMetaData {
    /// The data set's name: the report's name.
    pub name: Arc<str>,
    pub description: Option<LocalizedText>,
    /// The namespaces that indexes in this message and its data refer to; the first is index 1.
    pub namespaces: Vec<Arc<str>>,
    /// Descriptions of the structures that fields contain, beside those of namespace 0.
    pub structure_types: Vec<StructureType>,
    /// Descriptions of the enumerations that fields have.
    pub enum_types: Vec<EnumType>,
    /// Descriptions of the other names for simple types that fields have.
    pub simple_types: Vec<SimpleType>,
    /// The fields, in payload order.
    pub fields: Vec<FieldMetaData>,
    /// The class of data sets this one belongs to.
    pub data_set_class_id: Option<Uuid>,
    /// The version that data refers to.
    pub configuration_version: MetaDataVersion,
}

impl DataSetMetaData {
    /// The field with this name.
    #[must_use]
    pub fn field(&self, name: &str) -> Option<&FieldMetaData> {
        self.fields.iter().find(|field| &*field.name == name)
    }
}

/// Change of metadata since its predecessor (OPC 10000-14 §6.2.3.2.6).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MetaDataChange {
    /// The fields are the same, so the version stays.
    None,
    /// Fields were appended: MinorVersion grows, older readers go on.
    Minor,
    /// Fields were removed, inserted, moved or changed: a new epoch begins.
    Major,
}

impl DataSetMetaData {
    /// Change of the version that this metadata needs after `old`; names, descriptions and versions
    /// do not count.
    #[must_use]
    pub fn change_since(&self, old: &Self) -> MetaDataChange {
        let is_kept = self.fields.len() >= old.fields.len()
            && self.fields.iter().zip(&old.fields).all(|(new, old)| new.is_compatible(old))
            && self.structure_types.starts_with(&old.structure_types)
            && self.enum_types.starts_with(&old.enum_types)
            && self.simple_types.starts_with(&old.simple_types);
        match (is_kept, self.fields.len() > old.fields.len()) {
            (false, _) => MetaDataChange::Major,
            (true, true) => MetaDataChange::Minor,
            (true, false) => MetaDataChange::None,
        }
    }
}

/// Description of one field.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldMetaData {
    /// Its name in the payload.
    pub name: Arc<str>,
    pub description: Option<LocalizedText>,
    /// True where it also travels in the transport's header (field flag 0).
    pub is_promoted: bool,
    /// Its built-in type: Int32 for enumerations, ExtensionObject for structures, Variant for
    /// abstract types.
    pub built_in_type: BuiltInType,
    pub data_type: NodeId,
    /// -1 scalar, 1 array, n matrix.
    pub value_rank: i32,
    /// The lengths of its dimensions, where fixed.
    pub array_dimensions: Vec<u32>,
    /// Longest String or ByteString in bytes; 0: no bound.
    pub max_string_length: u32,
    /// Identifies the field over renames.
    pub data_set_field_id: Uuid,
    /// Further properties, as [`PROPERTY_ENGINEERING_UNITS`].
    pub properties: Vec<(QualifiedName, Variant)>,
}

impl FieldMetaData {
    /// A field of a built-in type.
    #[must_use]
    pub fn new(
        name: impl Into<Arc<str>>,
        built_in_type: BuiltInType,
        data_set_field_id: Uuid,
    ) -> Self {
        Self {
            name: name.into(),
            description: None,
            is_promoted: false,
            built_in_type,
            data_type: NodeId::ua(u32::from(built_in_type.id())),
            value_rank: crate::network::VALUE_RANK_SCALAR,
            array_dimensions: Vec::new(),
            max_string_length: 0,
            data_set_field_id,
            properties: Vec::new(),
        }
    }

    /// The metadata of a requested report field, with unit, semantic and disclosure as properties.
    #[must_use]
    pub fn of_report_field(
        field: &ReportField,
        disclosure: Option<&DisclosureStatement>,
        data_set_field_id: Uuid,
    ) -> Self {
        let mut meta = Self::new(field.name.as_str(), field.field_type.0, data_set_field_id);
        meta.value_rank = field.value_rank;
        meta.description = field
            .description
            .as_deref()
            .map(|text| LocalizedText { locale: None, text: Some(Arc::from(text)) });
        if let Some(unit) = field.unit.as_deref().and_then(units::lookup) {
            meta.set_engineering_unit(unit);
        }
        if let Some(semantic) = &field.semantic {
            meta.set_text_property(PROPERTY_SEMANTIC, semantic.as_str());
        }
        if let Some(disclosure) = disclosure {
            meta.set_text_property(PROPERTY_DISCLOSURE, &disclosure.description);
        }
        meta
    }

    /// Alike for a subscriber that has the older metadata.
    fn is_compatible(&self, old: &Self) -> bool {
        self.name == old.name
            && self.built_in_type == old.built_in_type
            && self.data_type == old.data_type
            && self.value_rank == old.value_rank
            && self.data_set_field_id == old.data_set_field_id
            && self.properties == old.properties
    }

    /// Sets the field's unit.
    pub fn set_engineering_unit(&mut self, unit: EngineeringUnit) {
        let name = QualifiedName {
            namespace: Namespace::Ua,
            name: Some(Arc::from(PROPERTY_ENGINEERING_UNITS)),
        };
        self.set_property(
            name,
            Variant::Scalar(Scalar::ExtensionObject(Box::new(unit.to_extension_object()))),
        );
    }

    /// The field's unit, where it is stated and known.
    #[must_use]
    pub fn engineering_unit(&self) -> Option<EngineeringUnit> {
        match self.property(PROPERTY_ENGINEERING_UNITS)? {
            Variant::Scalar(Scalar::ExtensionObject(object)) => {
                EngineeringUnit::from_extension_object(object)
            }
            _ => None,
        }
    }

    /// Meaning of the field, where it is stated.
    #[must_use]
    pub fn semantic(&self) -> Option<Semantic> {
        self.property(PROPERTY_SEMANTIC)?.as_str()?.parse().ok()
    }

    /// Statement in words on how the value is coarsened.
    #[must_use]
    pub fn disclosure(&self) -> Option<&str> {
        self.property(PROPERTY_DISCLOSURE)?.as_str()
    }

    /// Adds or replaces a text property of the ASI namespace.
    pub fn set_text_property(&mut self, name: &str, text: &str) {
        let name = QualifiedName {
            namespace: Namespace::uri(ASI_NAMESPACE_URI),
            name: Some(Arc::from(name)),
        };
        self.set_property(name, text.into());
    }

    fn property(&self, name: &str) -> Option<&Variant> {
        self.properties
            .iter()
            .find(|(key, _)| key.name.as_deref() == Some(name))
            .map(|(_, value)| value)
    }

    fn set_property(&mut self, name: QualifiedName, value: Variant) {
        match self.properties.iter_mut().find(|(key, _)| *key == name) {
            Some((_, old)) => *old = value,
            None => self.properties.push((name, value)),
        }
    }
}

/// Finds the metadata that a message's bare values need (raw data, 1.05 Verbose).
pub trait MetaDataLookup {
    /// The newest metadata of a writer.
    fn meta_data(
        &self,
        publisher_id: Option<&str>,
        data_set_writer_id: Option<u16>,
    ) -> Option<&DataSetMetaData>;
}

impl MetaDataLookup for () {
    fn meta_data(&self, _: Option<&str>, _: Option<u16>) -> Option<&DataSetMetaData> {
        None
    }
}

impl MetaDataLookup for DataSetMetaData {
    fn meta_data(&self, _: Option<&str>, _: Option<u16>) -> Option<&DataSetMetaData> {
        Some(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_change_as_the_standard_says() {
        let id = uuid::Uuid::from_u128;
        let field = |name: &str, n| FieldMetaData::new(name, BuiltInType::Double, id(n));
        let of =
            |fields: Vec<FieldMetaData>| DataSetMetaData { fields, ..DataSetMetaData::default() };
        let old = of(vec![field("a", 1), field("b", 2)]);
        let mut with_unit = field("b", 2);
        with_unit.set_engineering_unit(units::lookup("MMT").expect("known"));
        for (new, expected) in [
            (of(vec![field("a", 1), field("b", 2)]), MetaDataChange::None),
            (of(vec![field("a", 1), field("b", 2), field("c", 3)]), MetaDataChange::Minor),
            (of(vec![field("a", 1)]), MetaDataChange::Major),
            (of(vec![field("b", 2), field("a", 1)]), MetaDataChange::Major),
            (of(vec![field("c", 3), field("a", 1), field("b", 2)]), MetaDataChange::Major),
            (of(vec![field("a", 1), with_unit]), MetaDataChange::Major),
        ] {
            assert_eq!(new.change_since(&old), expected);
        }
    }
}
