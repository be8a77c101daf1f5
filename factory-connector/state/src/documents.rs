//! Documents of engineers (policies, rules, alliances, caps): versioned, never deleted.

use std::collections::BTreeMap;

use asi_model::DateTime;
use disclosure::{CapExcess, DOCUMENTS_MAX, DocumentId, DocumentVersion, RuleFault, Versioned};
use serde::Serialize;

use crate::writes::DocumentRow;

/// Reason for which a document is not stored.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DocumentError {
    /// No document has this id.
    #[error("there is no document {0}")]
    Unknown(DocumentId),
    /// Another user changed it meanwhile; this is the version now.
    #[error("another person has changed it meanwhile; read version {0} and decide again")]
    Changed(u32),
    /// The number of documents is at its limit.
    #[error("there are {DOCUMENTS_MAX} documents already; retire some")]
    TooMany,
    /// The document has faults.
    #[error("the document is wrong")]
    Faults(Vec<RuleFault>),
    /// Partners would get more information than caps allow.
    #[error("partners would get more information than a cap allows")]
    OverCap(Vec<CapExcess>),
}

/// Returns documents by their ids.
pub(crate) fn by_id<T>(documents: Vec<Versioned<T>>) -> BTreeMap<DocumentId, Versioned<T>> {
    documents.into_iter().map(|document| (document.key.id.clone(), document)).collect()
}

/// Stores the next version of a document, and returns its row.
pub(crate) fn put<T: Serialize>(
    documents: &mut BTreeMap<DocumentId, Versioned<T>>,
    id: &DocumentId,
    document: T,
    expected: Option<u32>,
    (by, now): (&str, DateTime),
) -> Result<DocumentRow, DocumentError> {
    let known = documents.get(id).map(|known| known.key.version);
    let version = next_version(known, expected, documents.len())?;
    let key = DocumentVersion { id: id.clone(), version };
    let row = DocumentRow::new(&key, &document, by, now);
    let stored = Versioned { key, document, changed_by: by.to_owned(), changed_at: now };
    documents.insert(id.clone(), stored);
    Ok(row)
}

/// Returns the next version, where nobody else was faster and the limit is not reached.
pub(crate) fn next_version(
    known: Option<u32>,
    expected: Option<u32>,
    count: usize,
) -> Result<u32, DocumentError> {
    let version = known.unwrap_or(0);
    if expected.is_some_and(|expected| expected != version) {
        return Err(DocumentError::Changed(version));
    }
    if known.is_none() && count >= DOCUMENTS_MAX {
        return Err(DocumentError::TooMany);
    }
    Ok(version + 1)
}
