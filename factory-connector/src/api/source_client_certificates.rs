//! Certificate that the connector shows the OPC UA servers of machines, and the next one.

use axum::{Json, extract::State};
use base64::{Engine as _, engine::general_purpose::STANDARD};
use daemon::web::Problem;
use serde::Serialize;
use shop_floor::{OwnCertificate, OwnCertificates};
use utoipa::ToSchema;

use super::{
    context::Api,
    problems::{Problems, shop_floor},
    roles::{Engineer, Viewer},
};

/// Characters per line of a PEM file (RFC 7468, 2).
const PEM_LINE: usize = 64;

/// A certificate that the connector shows machines.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SourceClientCertificate {
    #[serde(flatten)]
    certificate: OwnCertificate,
    /// The certificate as PEM, to be handed to the servers' administrators. DER is what it contains in base64.
    content: String,
}

/// Certificate that the connector shows machines, and the next one.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SourceClientCertificates {
    /// Used for each new session.
    current: SourceClientCertificate,
    /// Made, but not used yet, so that machines can be made to trust it.
    next: Option<SourceClientCertificate>,
}

impl From<OwnCertificate> for SourceClientCertificate {
    fn from(certificate: OwnCertificate) -> Self {
        let base64 = STANDARD.encode(&certificate.der);
        let mut content = String::from("-----BEGIN CERTIFICATE-----\n");
        let mut rest = base64.as_str();
        while !rest.is_empty() {
            let (line, others) = rest.split_at(rest.len().min(PEM_LINE));
            content.push_str(line);
            content.push('\n');
            rest = others;
        }
        content.push_str("-----END CERTIFICATE-----\n");
        Self { certificate, content }
    }
}

impl From<OwnCertificates> for SourceClientCertificates {
    fn from(certificates: OwnCertificates) -> Self {
        let OwnCertificates { current, next } = certificates;
        Self { current: current.into(), next: next.map(Into::into) }
    }
}

/// Shows the certificate that machines see, and the next one.
#[utoipa::path(
    get,
    path = "/source-client-certificate",
    tag = "sources",
    responses((status = 200, body = SourceClientCertificates), Problems)
)]
pub async fn show_source_client_certificate(
    _: Viewer,
    State(api): State<Api>,
) -> Result<Json<SourceClientCertificates>, Problem> {
    Ok(Json(api.shop_floor.own_certificates().await.map_err(shop_floor)?.into()))
}

/// Makes the next certificate with a key of its own, unless there is one. It is not used yet.
#[utoipa::path(
    post,
    path = "/source-client-certificate/next",
    tag = "sources",
    responses((status = 200, body = SourceClientCertificates), Problems)
)]
pub async fn prepare_source_client_certificate(
    _: Engineer,
    State(api): State<Api>,
) -> Result<Json<SourceClientCertificates>, Problem> {
    Ok(Json(api.shop_floor.prepare_next_certificate().await.map_err(shop_floor)?.into()))
}

/// Deletes the next certificate and its key.
#[utoipa::path(
    delete,
    path = "/source-client-certificate/next",
    tag = "sources",
    responses((status = 200, body = SourceClientCertificates), Problems)
)]
pub async fn discard_source_client_certificate(
    _: Engineer,
    State(api): State<Api>,
) -> Result<Json<SourceClientCertificates>, Problem> {
    Ok(Json(api.shop_floor.discard_next_certificate().await.map_err(shop_floor)?.into()))
}

/// Uses the next certificate for each new session; open ones go on. A server that does not trust it refuses them.
#[utoipa::path(
    post,
    path = "/source-client-certificate/next/use",
    tag = "sources",
    responses((status = 200, body = SourceClientCertificates), Problems)
)]
pub async fn use_source_client_certificate(
    _: Engineer,
    State(api): State<Api>,
) -> Result<Json<SourceClientCertificates>, Problem> {
    Ok(Json(api.shop_floor.use_next_certificate().await.map_err(shop_floor)?.into()))
}
