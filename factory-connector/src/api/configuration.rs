//! Configuration in effect.

use axum::{Json, extract::State};
use daemon::{configuration::Setting, web::Problem};

use super::{context::Api, problems::Problems, roles::Engineer, view::Page};

/// Lists every setting with its meaning, default and value, and who set it. Secrets are not shown.
#[utoipa::path(
    get,
    path = "/configuration",
    tag = "status",
    responses((status = 200, body = Page<Setting>), Problems)
)]
pub async fn show_configuration(
    _: Engineer,
    State(api): State<Api>,
) -> Result<Json<Page<Setting>>, Problem> {
    Ok(Json(Page::whole(api.instance.settings.clone())))
}
