//! The trust list of the OPC UA server: certificates of clients, authorities and their revocation lists.

use asi_model::DateTime;
use axum::{Json, extract::State, http::StatusCode};
use base64::{Engine as _, engine::general_purpose::STANDARD};
use daemon::web::{ApiJson, ApiPath, Problem, session::SignedIn};
use serde::{Deserialize, Serialize};
use twin::{CertificateState, ClientCertificate, TwinError};
use utoipa::ToSchema;

use super::{Api, Principal, accounts::engineer_only, problems::Problems, view::Page};

/// A certificate that the OPC UA server has seen or was given.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ClientCertificateView {
    /// SHA-1 over the certificate in hexadecimal digits: its identity here.
    thumbprint: String,
    /// The subject's distinguished name.
    subject: String,
    /// Beginning of its validity.
    #[schema(value_type = Option<String>, format = "date-time")]
    not_before: Option<DateTime>,
    /// End of its validity.
    #[schema(value_type = Option<String>, format = "date-time")]
    not_after: Option<DateTime>,
    /// `TRUSTED`, or `REJECTED`: its bearer was turned away and waits for an approval.
    state: &'static str,
}

impl From<ClientCertificate> for ClientCertificateView {
    fn from(certificate: ClientCertificate) -> Self {
        let ClientCertificate { thumbprint, subject, not_before, not_after, state } = certificate;
        let state = match state {
            CertificateState::Trusted => "TRUSTED",
            CertificateState::Rejected => "REJECTED",
        };
        Self { thumbprint, subject, not_before, not_after, state }
    }
}

/// Lists the certificates of OPC UA clients, those that wait for an approval first. A local discovery server's is among
/// them.
#[utoipa::path(get, path = "/client-certificates", tag = "twin", security(("session" = [])),
    responses((status = 200, body = Page<ClientCertificateView>), Problems))]
pub async fn list(State(api): State<Api>) -> Result<Json<Page<ClientCertificateView>>, Problem> {
    let list = api.twin.trust_list().clone();
    let known = blocking(move || list.list()).await?;
    Ok(Json(Page::whole(known.into_iter().map(Into::into).collect())))
}

/// Whether a client's certificate is trusted.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct ClientTrustBody {
    /// True: its bearer may connect from now on. False: it is turned away from the next connection on.
    is_trusted: bool,
}

/// Trusts or rejects a client's certificate.
#[utoipa::path(put, path = "/client-certificates/{thumbprint}", tag = "twin", security(("session" = [])),
    params(("thumbprint" = String, Path)), request_body = ClientTrustBody,
    responses((status = 200, body = ClientCertificateView), Problems))]
pub async fn trust(
    State(api): State<Api>,
    who: SignedIn<Principal>,
    ApiPath(thumbprint): ApiPath<String>,
    ApiJson(body): ApiJson<ClientTrustBody>,
) -> Result<Json<ClientCertificateView>, Problem> {
    engineer_only(&who)?;
    let list = api.twin.trust_list().clone();
    let found = blocking(move || {
        // Where it stands already as wanted, nothing moves, which is no failure.
        if body.is_trusted {
            list.trust(&thumbprint)?
        } else {
            list.reject(&thumbprint)?
        };
        let known = list.list()?;
        Ok(known.into_iter().find(|certificate| certificate.thumbprint.eq_ignore_ascii_case(&thumbprint)))
    })
    .await?;
    found.map(|certificate| Json(certificate.into())).ok_or_else(|| Problem::not_found("such certificate"))
}

/// What a file for the trust list is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum TrustFileKind {
    /// The certificate of a client, or of an authority whose certificates are to be trusted.
    Certificate,
    /// The certificate of an authority that only takes part in chains.
    Issuer,
    /// An authority's revocation list; it replaces the one before.
    RevocationList,
}

/// A file for the trust list.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct TrustFileBody {
    /// What it is.
    kind: TrustFileKind,
    /// Its content: PEM, or DER in base64.
    content: String,
}

/// Adds a certificate or a revocation list to the trust list.
#[utoipa::path(post, path = "/client-certificates", tag = "twin", security(("session" = [])),
    request_body = TrustFileBody, responses((status = 201, description = "Added"), Problems))]
pub async fn add(
    State(api): State<Api>,
    who: SignedIn<Principal>,
    ApiJson(body): ApiJson<TrustFileBody>,
) -> Result<StatusCode, Problem> {
    engineer_only(&who)?;
    let der = der(&body.content).ok_or_else(|| {
        Problem::unprocessable("NOT_A_FILE", "The content is neither PEM nor DER in base64.", Vec::new())
    })?;
    let list = api.twin.trust_list().clone();
    blocking(move || match body.kind {
        TrustFileKind::Certificate => list.trust_new(&der).map(drop),
        TrustFileKind::Issuer => list.add_issuer(&der),
        TrustFileKind::RevocationList => list.put_revocation_list(&der),
    })
    .await?;
    Ok(StatusCode::CREATED)
}

/// Files are read and written beside the threads that serve.
async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, TwinError> + Send + 'static,
) -> Result<T, Problem> {
    let done = tokio::task::spawn_blocking(work).await.map_err(|error| Problem::internal(&error))?;
    done.map_err(|error| match error {
        TwinError::Certificate { reason } => {
            Problem::unprocessable("NOT_A_CERTIFICATE", format!("It cannot be used: {reason}."), Vec::new())
        }
        other => Problem::internal(&other),
    })
}

/// The bytes of a file given as PEM or base64; of several in one PEM file the first.
fn der(content: &str) -> Option<Vec<u8>> {
    let text = match content.split_once("-----BEGIN") {
        Some((_, rest)) => rest.split_once("-----")?.1.split_once("-----END")?.0,
        None => content,
    };
    let text: String = text.split_whitespace().collect();
    STANDARD.decode(text).ok().filter(|der| !der.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_pem_or_base64() {
        let check = |content: &str, expected: Option<&[u8]>| assert_eq!(der(content).as_deref(), expected, "{content}");
        check("MAMC\nAQE=", Some(&[0x30, 3, 2, 1, 1]));
        check("-----BEGIN X509 CRL-----\nMAMC\r\nAQE=\n-----END X509 CRL-----\n", Some(&[0x30, 3, 2, 1, 1]));
        check("-----BEGIN CERTIFICATE-----\nMAMCAQE=", None);
        check("not base64!", None);
        check("", None);
    }
}
