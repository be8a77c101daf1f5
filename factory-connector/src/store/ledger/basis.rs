//! Documents that a decision is based on, which its entry commits to without a name.

use ::ledger::{Event, LedgerEntry};
use disclosure::DecisionBasis;
use sqlx::SqliteConnection;

use crate::store::{consents, error::StoreError};

/// Reads the basis of the consent that an entry records; `None` for other entries, and for those of
/// former versions, which name the documents themselves.
pub(super) async fn of_entry(
    connection: &mut SqliteConnection,
    content: &str,
) -> Result<Option<DecisionBasis>, StoreError> {
    let Ok(LedgerEntry { event, .. }) = serde_json::from_str(content) else { return Ok(None) };
    let Event::Consent { field, version, basis: Some(basis), .. } = event else { return Ok(None) };
    if basis.commitment.is_none() {
        return Ok(None);
    }
    let text = consents::basis(connection, &field.to_string(), version).await?;
    let stored = text.and_then(|text| serde_json::from_str::<DecisionBasis>(&text).ok());
    Ok(stored.map(|stored| DecisionBasis { salt: None, ..stored }))
}
