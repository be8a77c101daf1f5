//! Application certificate of the OPC UA server, its request and its installation.

use asi_model::DateTime;
use axum::{Json, extract::State};
use base64::{Engine as _, engine::general_purpose::STANDARD};
use daemon::web::{ApiJson, Problem};
use serde::{Deserialize, Serialize};
use twin::{InstalledCertificate, RequestedSubject, TrustFault};
use utoipa::ToSchema;

use super::{
    client_certificates::{blocking, refused},
    context::Api,
    problems::Problems,
    roles::{Engineer, Viewer},
};

/// Longest name that can be asked for, in characters (RFC 5280, ub-common-name).
const NAME_CHARS_MAX: usize = 64;

/// The certificate that the OPC UA server shows its clients.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ApplicationCertificateView {
    /// SHA-1 over the certificate in hexadecimal digits.
    thumbprint: String,
    /// SHA-256 over the certificate in hexadecimal digits, for people to compare.
    fingerprint: String,
    /// The subject's distinguished name.
    subject: String,
    /// The distinguished name of who issued it.
    issuer: String,
    /// The server made it and renews it. Otherwise an engineer has to ask the authority in time.
    is_self_signed: bool,
    /// The application it is for.
    application_uri: Option<String>,
    /// The names and addresses of the machine it is for.
    host_names: Vec<String>,
    /// Beginning of its validity.
    not_before: DateTime,
    /// End of its validity.
    not_after: DateTime,
    /// Length of its RSA key in bits.
    key_bits: usize,
}

impl From<InstalledCertificate> for ApplicationCertificateView {
    fn from(certificate: InstalledCertificate) -> Self {
        let InstalledCertificate {
            thumbprint,
            fingerprint,
            subject,
            issuer,
            is_self_signed,
            application_uri,
            host_names,
            not_before,
            not_after,
            key_bits,
        } = certificate;
        Self {
            thumbprint,
            fingerprint,
            subject,
            issuer,
            is_self_signed,
            application_uri,
            host_names,
            not_before,
            not_after,
            key_bits,
        }
    }
}

/// Shows the OPC UA server's own certificate.
#[utoipa::path(
    get,
    path = "/application-certificate",
    tag = "twin",
    responses((status = 200, body = ApplicationCertificateView), Problems)
)]
pub async fn show_application_certificate(
    _: Viewer,
    State(api): State<Api>,
) -> Result<Json<ApplicationCertificateView>, Problem> {
    let own = api.twin.application_certificate().clone();
    Ok(Json(blocking(move || own.show()).await?.into()))
}

/// Request to an authority, besides application and host names.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct CertificateRequestBody {
    /// Common name of the subject; without it that of the present certificate.
    common_name: Option<String>,
    /// Organisation (`O`) of the subject.
    organization: Option<String>,
    /// True to make a new key, which is used from the installation on.
    #[serde(default)]
    with_new_key: bool,
}

impl CertificateRequestBody {
    /// Returns the problem of a name that no certificate can have.
    pub(super) fn check_names(&self) -> Result<(), Problem> {
        let is_name = |name: &String| {
            (1..=NAME_CHARS_MAX).contains(&name.chars().count()) && !name.contains(char::is_control)
        };
        if self.common_name.iter().chain(&self.organization).all(is_name) {
            return Ok(());
        }
        Err(Problem::unprocessable(
            "INVALID_NAME",
            "A name in a certificate has 1 to 64 characters, none of them invisible.",
            Vec::new(),
        ))
    }
}

/// A request to be given to an authority.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct CertificateRequestView {
    /// PKCS #10, as PEM.
    content: String,
}

/// Makes a request for a certificate with the server's application URI and host names. The key
/// stays here.
#[utoipa::path(
    post,
    path = "/application-certificate/request",
    tag = "twin",
    request_body = CertificateRequestBody,
    responses((status = 200, body = CertificateRequestView), Problems)
)]
pub async fn request_application_certificate(
    _: Engineer,
    State(api): State<Api>,
    ApiJson(body): ApiJson<CertificateRequestBody>,
) -> Result<Json<CertificateRequestView>, Problem> {
    body.check_names()?;
    let CertificateRequestBody { common_name, organization, with_new_key } = body;
    let own = api.twin.application_certificate().clone();
    let wanted = RequestedSubject { common_name, organization, with_new_key };
    let content = blocking(move || own.request(&wanted)).await?;
    Ok(Json(CertificateRequestView { content }))
}

/// The certificate that an authority made of the request.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct IssuedCertificateBody {
    /// PEM: the certificate, and those of its authorities up to the root unless the trust list has
    /// them, in any order. Or the certificate alone as DER in base64.
    content: String,
}

impl IssuedCertificateBody {
    /// Returns PEM or DER.
    pub(super) fn content(self) -> Result<Vec<u8>, Problem> {
        if self.content.contains("-----BEGIN") {
            return Ok(self.content.into_bytes());
        }
        let text: String = self.content.split_whitespace().collect();
        STANDARD.decode(text).map_err(|_| {
            let message = "The content is neither PEM nor DER in base64.".to_owned();
            refused(&[TrustFault { code: "NOT_A_FILE", message }])
        })
    }
}

/// Installs an issued certificate; the server shows it from the next connection on.
#[utoipa::path(
    put,
    path = "/application-certificate",
    tag = "twin",
    request_body = IssuedCertificateBody,
    responses((status = 200, body = ApplicationCertificateView), Problems)
)]
pub async fn install_application_certificate(
    user: Engineer,
    State(api): State<Api>,
    ApiJson(body): ApiJson<IssuedCertificateBody>,
) -> Result<Json<ApplicationCertificateView>, Problem> {
    let content = body.content()?;
    let (own, by) = (api.twin.application_certificate().clone(), user.principal.user_name.clone());
    Ok(Json(blocking(move || own.install(&content, &by)).await?.into()))
}
