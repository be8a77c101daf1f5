//! What only a factory's own organisation and administrators see.

use asi_model::FactoryId;
use daemon::web::Problem;

use crate::{principal::Principal, store::Work};

/// Whether the viewer may look into the factory. To others it does not exist.
pub async fn check(work: &mut Work, viewer: &Principal, id: &FactoryId) -> Result<(), Problem> {
    let factory = work.factories().lookup(&viewer.scope(), id).await?;
    factory
        .filter(|factory| {
            viewer.is_administrator() || viewer.organisation() == Some(&factory.organisation_id)
        })
        .map(drop)
        .ok_or_else(|| Problem::not_found(format_args!("factory {id}")))
}
