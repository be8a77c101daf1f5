//! Metadata that reports are decoded with, of all writers. A factory that describes much costs no more
//! memory than what its reports need: texts, enumerations and properties are in the database alone.

use std::{collections::HashMap, sync::Arc};

use asi_model::{
    FactoryId,
    pubsub::{DataSetMetaData, FieldMetaData, MetaDataLookup},
};

/// The metadata of all writers; replaced as a whole, so that decoding holds no lock. A copy of the table
/// copies pointers.
#[derive(Debug, Clone, Default)]
pub(super) struct MetaDataTable(HashMap<(FactoryId, u16), Arc<DataSetMetaData>>);

impl MetaDataTable {
    /// Stores what decoding needs of a writer's metadata.
    pub(super) fn put(&mut self, factory: FactoryId, writer: u16, meta_data: DataSetMetaData) {
        self.0.insert((factory, writer), Arc::new(for_decoding(meta_data)));
    }

    /// Forgets the metadata of one factory's writers.
    pub(super) fn forget(&mut self, factory: &FactoryId) {
        self.0.retain(|(of, _), _| of != factory);
    }

    /// Returns the metadata of one factory's writers.
    pub(super) const fn of<'t>(&'t self, factory: Option<&'t FactoryId>) -> KnownMetaData<'t> {
        KnownMetaData { factory, table: self }
    }
}

/// The metadata of one factory's writers.
pub(super) struct KnownMetaData<'t> {
    factory: Option<&'t FactoryId>,
    table: &'t MetaDataTable,
}

impl MetaDataLookup for KnownMetaData<'_> {
    fn meta_data(&self, _publisher: Option<&str>, writer: Option<u16>) -> Option<&DataSetMetaData> {
        self.table.0.get(&(self.factory?.clone(), writer?)).map(|known| &**known)
    }
}

/// Returns metadata without what is for people.
pub(super) fn for_decoding(meta_data: DataSetMetaData) -> DataSetMetaData {
    let fields = meta_data.fields.into_iter();
    let mut structure_types = meta_data.structure_types;
    for field in structure_types.iter_mut().flat_map(|known| &mut known.fields) {
        field.description = None;
    }
    DataSetMetaData {
        name: meta_data.name,
        namespaces: meta_data.namespaces,
        structure_types,
        fields: fields
            .map(|field| FieldMetaData { description: None, properties: Vec::new(), ..field })
            .collect(),
        configuration_version: meta_data.configuration_version,
        ..DataSetMetaData::default()
    }
}

#[cfg(test)]
mod tests {
    use asi_model::{
        BuiltInType,
        pubsub::{PubSubMessage, json::decode},
        values::{LocalizedText, QualifiedName, Variant},
    };
    use uuid::Uuid;

    use super::*;

    /// The most that a message may describe in enumerations whose values have neither name nor number.
    fn enumerations() -> DataSetMetaData {
        let values = format!("[{}]", vec!["{}"; 500].join(","));
        let types: Vec<String> = (0..100)
            .map(|id| {
                format!(
                    r#"{{"DataTypeId":"ns=1;i={id}","Name":"E{id}","EnumDefinition":{{"Fields":{values}}}}}"#
                )
            })
            .collect();
        let text = format!(
            r#"{{"MessageId":"m","MessageType":"ua-metadata","PublisherId":"F","DataSetWriterId":1,
                "MetaData":{{"Name":"n","Namespaces":["urn:n"],"EnumDataTypes":[{}],"Fields":[]}}}}"#,
            types.join(",")
        );
        match decode(text.as_bytes()).expect("metadata").message {
            PubSubMessage::MetaData(message) => message.meta_data,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn what_is_for_people_is_not_in_memory() {
        let mut described = enumerations();
        assert_eq!(described.enum_types.len(), 100, "they are read, and checked");
        let mut field = FieldMetaData::new("f", BuiltInType::Double, Uuid::nil());
        field.description = Some(LocalizedText::default());
        field.properties.push((QualifiedName::default(), Variant::default()));
        described.fields.push(field.clone());
        let factory: FactoryId = "F".parse().expect("an id");
        let mut table = MetaDataTable::default();
        table.put(factory.clone(), 1, described);
        let of = table.of(Some(&factory));
        let known = of.meta_data(None, Some(1)).expect("known");
        assert!(known.enum_types.is_empty());
        let (kept, asked) = (&known.fields[0], field);
        assert_eq!((&kept.name, kept.built_in_type), (&asked.name, asked.built_in_type));
        assert!(kept.description.is_none() && kept.properties.is_empty());
    }

    #[test]
    fn a_copy_of_the_table_copies_no_metadata() {
        let factory: FactoryId = "F".parse().expect("an id");
        let mut table = MetaDataTable::default();
        table.put(factory.clone(), 1, DataSetMetaData::default());
        let copy = table.clone();
        let key = (factory, 1);
        assert!(Arc::ptr_eq(&table.0[&key], &copy.0[&key]));
    }
}
