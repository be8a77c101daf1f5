//! Namespace array of a peer, which turns indexes into URIs, and its data types once known.

use std::{collections::HashMap, sync::Arc};

use asi_model::values::Namespace;
use opcua::types::{
    ContextOwned, DecodingOptions, NamespaceMap, TypeLoaderCollection, UAString, Variant,
    custom::{DataTypeTree, DynamicTypeLoader},
};

/// The URI of namespace 0.
const UA_NAMESPACE_URI: &str = "http://opcfoundation.org/UA/";

/// The namespace array of one server at one time, and the data types that were read from it under
/// the same indexes.
///
/// A clone is cheap. A server may hand out other indexes after each restart, so a table is valid
/// for one session only.
#[derive(Debug, Clone)]
pub struct NamespaceTable {
    inner: Arc<Inner>,
}

struct Inner {
    namespaces: Vec<Namespace>,
    indexes: HashMap<Arc<str>, u16>,
    types: Option<Arc<DataTypeTree>>,
    context: ContextOwned,
}

impl std::fmt::Debug for Inner {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("NamespaceTable")
            .field("namespaces", &self.namespaces)
            .field("has_data_types", &self.types.is_some())
            .finish_non_exhaustive()
    }
}

impl NamespaceTable {
    /// Makes a table of the URIs in the order of their indexes. The first is taken as namespace 0
    /// whatever it says; where a URI stands twice, the lower index is used.
    pub fn new<I>(uris: I) -> Self
    where
        I: IntoIterator,
        I::Item: AsRef<str>,
    {
        Self::build(uris.into_iter().map(|uri| Arc::from(uri.as_ref())).collect(), None)
    }

    /// Makes a table of the value of a server's NamespaceArray (`i=2255`); `None` if it is not an
    /// array of strings.
    #[must_use]
    pub fn from_namespace_array(value: &Variant) -> Option<Self> {
        let Variant::Array(array) = value else { return None };
        let uris: Option<Vec<_>> = array
            .values
            .iter()
            .map(|uri| match uri {
                Variant::String(uri) => Some(uri_or_empty(uri)),
                _ => None,
            })
            .collect();
        Some(Self::build(uris?, None))
    }

    /// The same table with the data types of that server, so that its structures become named
    /// fields and back.
    #[must_use]
    pub fn with_data_types(self, types: Arc<DataTypeTree>) -> Self {
        Self::build(self.uris(), Some(types))
    }

    /// The index of a namespace, by its URI.
    #[must_use]
    pub fn index(&self, uri: &str) -> Option<u16> {
        self.inner.indexes.get(uri).copied()
    }

    /// The namespace behind an index; [`Namespace::Index`] where the table does not know it.
    #[must_use]
    pub fn namespace(&self, index: u16) -> Namespace {
        self.inner.namespaces.get(usize::from(index)).cloned().unwrap_or(Namespace::Index(index))
    }

    /// The URIs in the order of their indexes.
    #[must_use]
    pub fn uris(&self) -> Vec<Arc<str>> {
        self.inner
            .namespaces
            .iter()
            .map(|namespace| match namespace {
                Namespace::Uri(uri) => Arc::clone(uri),
                Namespace::Ua | Namespace::Index(_) => Arc::from(UA_NAMESPACE_URI),
            })
            .collect()
    }

    /// The data types, where they were read.
    #[must_use]
    pub fn data_types(&self) -> Option<&Arc<DataTypeTree>> {
        self.inner.types.as_ref()
    }

    /// The same as the stack's own map, for its encoding contexts.
    #[must_use]
    pub fn to_namespace_map(&self) -> NamespaceMap {
        self.inner.context.namespaces().clone()
    }

    /// The stack's encoding context under these namespaces and types.
    pub(crate) fn context(&self) -> &ContextOwned {
        &self.inner.context
    }

    fn build(uris: Vec<Arc<str>>, types: Option<Arc<DataTypeTree>>) -> Self {
        let mut indexes = HashMap::with_capacity(uris.len().max(1));
        let mut map = NamespaceMap::new().known_namespaces().clone();
        indexes.insert(Arc::from(UA_NAMESPACE_URI), 0);
        let mut namespaces = vec![Namespace::Ua];
        for (index, uri) in (1_u16..).zip(uris.into_iter().skip(1)) {
            indexes.entry(Arc::clone(&uri)).or_insert(index);
            map.entry(uri.to_string()).or_insert(index);
            namespaces.push(Namespace::Uri(uri));
        }
        let mut loaders = TypeLoaderCollection::new();
        if let Some(types) = &types {
            loaders.add_type_loader(DynamicTypeLoader::new(Arc::clone(types)));
        }
        let context =
            ContextOwned::new(NamespaceMap::new_full(map), loaders, DecodingOptions::default());
        Self { inner: Arc::new(Inner { namespaces, indexes, types, context }) }
    }
}

fn uri_or_empty(uri: &UAString) -> Arc<str> {
    Arc::from(uri.value().as_deref().unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indexes_and_uris_answer_each_other() {
        let table = NamespaceTable::new([UA_NAMESPACE_URI, "urn:server", "urn:press", "urn:press"]);
        assert_eq!(table.index("urn:press"), Some(2));
        assert_eq!(table.index(UA_NAMESPACE_URI), Some(0));
        assert_eq!(table.index("urn:unknown"), None);
        assert_eq!(table.namespace(0), Namespace::Ua);
        assert_eq!(table.namespace(3), Namespace::Uri("urn:press".into()));
        assert_eq!(table.namespace(9), Namespace::Index(9));
    }
}
