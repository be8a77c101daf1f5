//! What the connector runs with.

use axum::{Json, extract::State};
use daemon::{
    configuration::Setting,
    web::{Problem, session::SignedIn},
};

use super::{Api, Principal, accounts::engineer_only, problems::Problems, view::Page};

/// Lists every setting with its meaning, default and value, and who set it. Secrets are not shown.
#[utoipa::path(get, path = "/configuration", tag = "status", security(("session" = [])),
    responses((status = 200, body = Page<Setting>), Problems))]
pub async fn show_configuration(
    State(api): State<Api>,
    who: SignedIn<Principal>,
) -> Result<Json<Page<Setting>>, Problem> {
    engineer_only(&who)?;
    Ok(Json(Page::whole(api.settings.clone())))
}
