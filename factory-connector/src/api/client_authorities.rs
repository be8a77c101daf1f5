//! Trust list of the OPC UA server: authorities that issue certificates, and their revocation lists.

use asi_model::DateTime;
use axum::{Json, extract::State, http::StatusCode};
use daemon::web::{ApiPath, Problem};
use serde::Serialize;
use twin::{Authority, RevocationKnowledge, RevocationList};
use utoipa::ToSchema;

use super::{
    client_certificates::blocking,
    context::Api,
    problems::Problems,
    roles::{Engineer, Viewer},
    view::Page,
};

/// The certificate of an authority.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ClientAuthorityView {
    /// SHA-1 over the certificate in hexadecimal digits: its identity here.
    thumbprint: String,
    /// SHA-256 over the certificate in hexadecimal digits, for people to compare.
    fingerprint: String,
    /// The subject's distinguished name.
    subject: String,
    /// The distinguished name of who issued it; the subject's where it did so itself.
    issuer: String,
    /// Beginning of its validity.
    not_before: DateTime,
    /// End of its validity.
    not_after: DateTime,
    /// Clients with a certificate of it may connect; otherwise it only leads to one that is
    /// trusted.
    is_trusted: bool,
    /// State of its revocation list. Without a current one its clients are rejected.
    revocation_list: RevocationListState,
    /// Time by which that list has to be replaced.
    next_update: Option<DateTime>,
}

/// State of an authority's revocation list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum RevocationListState {
    /// Valid at present.
    Current,
    /// Past the time at which it was to be replaced.
    Outdated,
    /// Absent from the trust list.
    Missing,
}

impl From<Authority> for ClientAuthorityView {
    fn from(authority: Authority) -> Self {
        let Authority {
            thumbprint,
            fingerprint,
            subject,
            issuer,
            not_before,
            not_after,
            is_trusted,
            revocation,
        } = authority;
        let (revocation_list, next_update) = match revocation {
            RevocationKnowledge::Current { next_update } => {
                (RevocationListState::Current, next_update)
            }
            RevocationKnowledge::Outdated { next_update } => {
                (RevocationListState::Outdated, Some(next_update))
            }
            RevocationKnowledge::Missing => (RevocationListState::Missing, None),
        };
        Self {
            thumbprint,
            fingerprint,
            subject,
            issuer,
            not_before,
            not_after,
            is_trusted,
            revocation_list,
            next_update,
        }
    }
}

/// Lists the authorities whose clients may connect, and those in between. They are added with the
/// clients' certificates.
#[utoipa::path(
    get,
    path = "/client-authorities",
    tag = "twin",
    responses((status = 200, body = Page<ClientAuthorityView>), Problems)
)]
pub async fn list_client_authorities(
    _: Viewer,
    State(api): State<Api>,
) -> Result<Json<Page<ClientAuthorityView>>, Problem> {
    let list = api.twin.trust_list().clone();
    let known = blocking(move || list.authorities()).await?;
    Ok(Json(Page::whole(known.into_iter().map(Into::into).collect())))
}

/// Removes an authority: its clients are rejected, and their open sessions end.
#[utoipa::path(
    delete,
    path = "/client-authorities/{thumbprint}",
    tag = "twin",
    params(("thumbprint" = String, Path)),
    responses((status = 204, description = "Removed"), Problems)
)]
pub async fn remove_client_authority(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(thumbprint): ApiPath<String>,
) -> Result<StatusCode, Problem> {
    let (list, by) = (api.twin.trust_list().clone(), user.principal.user_name.clone());
    match blocking(move || list.remove_authority(&thumbprint, &by)).await? {
        true => Ok(StatusCode::NO_CONTENT),
        false => Err(Problem::not_found("such authority")),
    }
}

/// An authority's list of revoked certificates.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ClientRevocationListView {
    /// Identity of the list in paths of this API.
    revocation_list_id: String,
    /// The distinguished name of the authority.
    issuer: String,
    /// Time of issue.
    this_update: DateTime,
    /// Time by which it has to be replaced, if it names one.
    next_update: Option<DateTime>,
    /// Number of certificates that it revokes.
    revoked_count: usize,
    /// An authority that is known here signed it; otherwise it is of no use.
    is_signed_by_known_authority: bool,
}

impl From<RevocationList> for ClientRevocationListView {
    fn from(list: RevocationList) -> Self {
        let RevocationList {
            id,
            issuer,
            this_update,
            next_update,
            revoked,
            is_signed_by_known_authority,
        } = list;
        Self {
            revocation_list_id: id,
            issuer,
            this_update,
            next_update,
            revoked_count: revoked,
            is_signed_by_known_authority,
        }
    }
}

/// Lists the authorities' lists of revoked certificates.
#[utoipa::path(
    get,
    path = "/client-revocation-lists",
    tag = "twin",
    responses((status = 200, body = Page<ClientRevocationListView>), Problems)
)]
pub async fn list_client_revocation_lists(
    _: Viewer,
    State(api): State<Api>,
) -> Result<Json<Page<ClientRevocationListView>>, Problem> {
    let list = api.twin.trust_list().clone();
    let known = blocking(move || list.revocation_lists()).await?;
    Ok(Json(Page::whole(known.into_iter().map(Into::into).collect())))
}

/// Removes a list of revoked certificates: clients of its authority stay outside until there is a
/// new one.
#[utoipa::path(
    delete,
    path = "/client-revocation-lists/{revocationListId}",
    tag = "twin",
    params(("revocationListId" = String, Path)),
    responses((status = 204, description = "Removed"), Problems)
)]
pub async fn remove_client_revocation_list(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<String>,
) -> Result<StatusCode, Problem> {
    let (list, by) = (api.twin.trust_list().clone(), user.principal.user_name.clone());
    match blocking(move || list.remove_revocation_list(&id, &by)).await? {
        true => Ok(StatusCode::NO_CONTENT),
        false => Err(Problem::not_found("such revocation list")),
    }
}
