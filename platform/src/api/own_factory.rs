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

/// Checks that the viewer is a member of the factory's organisation; to others it does not exist,
/// not even to those who run the platform.
pub async fn check_member(
    work: &mut Work,
    viewer: &Principal,
    id: &FactoryId,
) -> Result<(), Problem> {
    let factory = work.factories().lookup(&viewer.scope(), id).await?;
    factory
        .filter(|factory| viewer.organisation() == Some(&factory.organisation_id))
        .map(drop)
        .ok_or_else(|| Problem::not_found(format_args!("factory {id}")))
}
