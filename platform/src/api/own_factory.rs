//! Access check for data of one factory: its own organisation and administrators.

use asi_model::FactoryId;
use daemon::web::Problem;

use crate::{principal::Principal, store::Work};

/// Checks that the viewer may see the inside of the factory; to others it does not exist.
pub async fn check(work: &mut Work, viewer: &Principal, id: &FactoryId) -> Result<(), Problem> {
    let factory = work.factories().lookup(&viewer.scope(), id).await?;
    factory
        .filter(|factory| {
            viewer.is_administrator() || viewer.organisation() == Some(&factory.organisation_id)
        })
        .map(drop)
        .ok_or_else(|| Problem::not_found(format_args!("factory {id}")))
}
