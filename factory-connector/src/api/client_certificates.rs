//! Trust list of the OPC UA server: certificates of clients, and files for the whole list.

use std::net::IpAddr;

use asi_model::DateTime;
use axum::{Json, extract::State, http::StatusCode};
use base64::{Engine as _, engine::general_purpose::STANDARD};
use daemon::web::{ApiJson, ApiPath, Problem, problem::ProblemFault};
use serde::{Deserialize, Serialize};
use twin::{
    CertificateState, ClientCertificate, RejectionReason, TrustFault, TrustList, TwinError,
};
use utoipa::ToSchema;

use super::{
    context::Api,
    problems::Problems,
    roles::{Engineer, Viewer},
    view::Page,
};

/// A certificate that the OPC UA server has seen or was given.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ClientCertificateView {
    /// SHA-1 over the certificate in hexadecimal digits: its identity here.
    thumbprint: String,
    /// SHA-256 over the certificate in hexadecimal digits, for people to compare.
    fingerprint: String,
    /// The subject's distinguished name.
    subject: String,
    /// The application it was made for, as it says.
    application_uri: Option<String>,
    /// Beginning of its validity.
    not_before: DateTime,
    /// End of its validity.
    not_after: DateTime,
    state: ClientTrust,
    /// Person who approved it; none for one that is trusted without an approval on record, or not trusted.
    approved_by: Option<String>,
    /// Time of the last rejected connection; none if there was none since it was trusted.
    rejected_at: Option<DateTime>,
    /// Reason of that rejection.
    rejection_reason: Option<ClientRejection>,
    /// Address of the client then; none if the OPC UA server had opened the connection.
    #[schema(value_type = Option<String>)]
    rejected_address: Option<IpAddr>,
    /// Name that the application gave itself then, unproven.
    rejected_application_name: Option<String>,
}

/// Trust in a client's certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum ClientTrust {
    /// Its bearer may connect.
    Trusted,
    /// Its bearer came in since an authority that issued it is trusted. It may be denied by itself.
    Issued,
    /// Its bearer was rejected: it waits for an approval.
    Rejected,
    /// Its bearer was rejected, for an engineer denied the approval.
    Denied,
}

/// Reason of a rejection.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum ClientRejection {
    /// No engineer has approved it, or one withdrew the approval.
    NotTrusted,
    /// The certificate is not valid at this time.
    OutOfTime,
    /// The certificate may not be used for signing.
    Usage,
    /// Its key is too short or too long for the security policy.
    KeyLength,
    /// The certificate cannot be read.
    Unreadable,
    /// Its issuer revoked it.
    Revoked,
    /// The issuer has no current revocation list.
    RevocationUnknown,
    /// A file of the trust list on the connector's disk cannot be read, so that nobody is let in.
    TrustListUnreadable,
}

impl From<RejectionReason> for ClientRejection {
    fn from(reason: RejectionReason) -> Self {
        match reason {
            RejectionReason::NotTrusted => Self::NotTrusted,
            RejectionReason::OutOfTime => Self::OutOfTime,
            RejectionReason::Usage => Self::Usage,
            RejectionReason::KeyLength => Self::KeyLength,
            RejectionReason::Unreadable => Self::Unreadable,
            RejectionReason::Revoked => Self::Revoked,
            RejectionReason::RevocationUnknown => Self::RevocationUnknown,
            RejectionReason::TrustListUnreadable => Self::TrustListUnreadable,
        }
    }
}

impl From<ClientCertificate> for ClientCertificateView {
    fn from(certificate: ClientCertificate) -> Self {
        let ClientCertificate {
            thumbprint,
            fingerprint,
            subject,
            application_uri,
            not_before,
            not_after,
            state,
            approval,
            rejection,
        } = certificate;
        let state = match state {
            CertificateState::Trusted => ClientTrust::Trusted,
            CertificateState::Issued => ClientTrust::Issued,
            CertificateState::Rejected => ClientTrust::Rejected,
            CertificateState::Denied => ClientTrust::Denied,
        };
        Self {
            thumbprint,
            fingerprint,
            subject,
            application_uri,
            not_before,
            not_after,
            state,
            approved_by: approval.map(|approval| approval.by),
            rejected_at: rejection.as_ref().map(|rejection| rejection.rejected_at),
            rejection_reason: rejection.as_ref().map(|rejection| rejection.reason.into()),
            rejected_address: rejection.as_ref().and_then(|rejection| rejection.address),
            rejected_application_name: rejection.and_then(|rejection| rejection.application_name),
        }
    }
}

/// Lists the certificates of OPC UA clients, those that wait for an approval first. A local
/// discovery server's is among them.
#[utoipa::path(
    get,
    path = "/client-certificates",
    tag = "twin",
    responses((status = 200, body = Page<ClientCertificateView>), Problems)
)]
pub async fn list_client_certificates(
    _: Viewer,
    State(api): State<Api>,
) -> Result<Json<Page<ClientCertificateView>>, Problem> {
    let list = api.twin.trust_list().clone();
    let known = blocking(move || list.list()).await?;
    Ok(Json(Page::whole(known.into_iter().map(Into::into).collect())))
}

/// Approval of a client's certificate.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct ClientTrustBody {
    /// True: its bearer may connect from now on, with this person's approval. False: it is rejected, and its open sessions end.
    is_trusted: bool,
}

/// Trusts or rejects a client's certificate.
#[utoipa::path(
    put,
    path = "/client-certificates/{thumbprint}",
    tag = "twin",
    params(("thumbprint" = String, Path)),
    request_body = ClientTrustBody,
    responses((status = 200, body = ClientCertificateView), Problems)
)]
pub async fn trust_client_certificate(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(thumbprint): ApiPath<String>,
    ApiJson(body): ApiJson<ClientTrustBody>,
) -> Result<Json<ClientCertificateView>, Problem> {
    let (list, by) = (api.twin.trust_list().clone(), user.principal.user_name.clone());
    let found = blocking(move || {
        let is_meant =
            |known: &ClientCertificate| known.thumbprint.eq_ignore_ascii_case(&thumbprint);
        let Some(before) = list.list()?.into_iter().find(is_meant) else { return Ok(None) };
        // A certificate that is in the wanted folder already is no failure.
        if body.is_trusted {
            list.trust(&thumbprint, &by)?
        } else {
            list.reject(&thumbprint, &by)?
        };
        // An authority's certificate, once trusted, is listed among the authorities.
        let after = list.list()?.into_iter().find(is_meant);
        Ok(Some(after.unwrap_or(ClientCertificate {
            state: CertificateState::Trusted,
            rejection: None,
            ..before
        })))
    })
    .await?;
    found
        .map(|certificate| Json(certificate.into()))
        .ok_or_else(|| Problem::not_found("such certificate"))
}

/// Kind of a file for the trust list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum TrustFileKind {
    /// The certificate of a client, or of an authority whose certificates are to be trusted.
    Certificate,
    /// The certificate of an authority that only takes part in chains.
    Issuer,
    /// An authority's revocation list; it replaces the one before.
    RevocationList,
    /// The certificate of a client that is denied, also where an authority vouches for it; its open sessions end.
    DeniedCertificate,
}

/// A file for the trust list.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct TrustFileBody {
    kind: TrustFileKind,
    /// Its content: PEM, or DER in base64. One certificate or list.
    content: String,
}

impl TrustFileBody {
    /// Adds the file to a trust list in a person's name.
    pub(super) async fn add_to(self, list: TrustList, by: String) -> Result<(), Problem> {
        let der = der(&self.content).map_err(|fault| refused(&[fault]))?;
        blocking(move || match self.kind {
            TrustFileKind::Certificate => list.trust_new(&der, &by),
            TrustFileKind::Issuer => list.add_issuer(&der, &by),
            TrustFileKind::RevocationList => list.put_revocation_list(&der, &by),
            TrustFileKind::DeniedCertificate => list.deny_new(&der, &by),
        })
        .await
    }
}

/// Adds a certificate or a revocation list to the trust list.
#[utoipa::path(
    post,
    path = "/client-certificates",
    tag = "twin",
    request_body = TrustFileBody,
    responses((status = 201, description = "Added"), Problems)
)]
pub async fn add_client_certificate(
    user: Engineer,
    State(api): State<Api>,
    ApiJson(body): ApiJson<TrustFileBody>,
) -> Result<StatusCode, Problem> {
    body.add_to(api.twin.trust_list().clone(), user.principal.user_name.clone()).await?;
    Ok(StatusCode::CREATED)
}

/// Reads or writes files on a thread that serves no requests.
pub(super) async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, TwinError> + Send + 'static,
) -> Result<T, Problem> {
    let done =
        tokio::task::spawn_blocking(work).await.map_err(|error| Problem::internal(&error))?;
    done.map_err(|error| match error {
        TwinError::Refused { faults } => refused(&faults),
        other => Problem::internal(&other),
    })
}

/// Returns the problem that lists all faults of a file.
pub(super) fn refused(faults: &[TrustFault]) -> Problem {
    let list = faults
        .iter()
        .map(|fault| ProblemFault {
            pointer: "/content".to_owned(),
            code: fault.code.to_owned(),
            message: fault.message.clone(),
        })
        .collect();
    Problem::unprocessable("NOT_USABLE", "It cannot be used.", list)
}

/// Decodes the DER content of a file given as PEM or base64.
fn der(content: &str) -> Result<Vec<u8>, TrustFault> {
    let fault = |code, message: &str| TrustFault { code, message: message.to_owned() };
    let unreadable = || fault("NOT_A_FILE", "The content is neither PEM nor DER in base64.");
    let text = match content.split_once("-----BEGIN") {
        Some((_, rest)) => {
            let (label, rest) = rest.split_once("-----").ok_or_else(unreadable)?;
            let (text, rest) = rest.split_once("-----END").ok_or_else(unreadable)?;
            if label.contains("PRIVATE KEY") {
                return Err(fault(
                    "PRIVATE_KEY",
                    "This is a private key. It must not leave the machine it belongs to, and nothing here needs it.",
                ));
            }
            if label.contains("CERTIFICATE REQUEST") {
                return Err(fault(
                    "NOT_ISSUED",
                    "This is a request for a certificate. Add the certificate that the authority makes of it.",
                ));
            }
            if rest.contains("-----BEGIN") {
                return Err(fault(
                    "SEVERAL",
                    "The file holds more than one certificate or list. Add them one by one.",
                ));
            }
            text
        }
        None => content,
    };
    let text: String = text.split_whitespace().collect();
    STANDARD.decode(text).ok().filter(|der| !der.is_empty()).ok_or_else(unreadable)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_pem_or_base64() {
        let check = |content: &str, expected: Result<&[u8], &str>| {
            let found = der(content);
            assert_eq!(found.as_deref().map_err(|fault| fault.code), expected, "{content}");
        };
        check("MAMC\nAQE=", Ok(&[0x30, 3, 2, 1, 1]));
        let list = "-----BEGIN X509 CRL-----\nMAMC\r\nAQE=\n-----END X509 CRL-----\n";
        check(list, Ok(&[0x30, 3, 2, 1, 1]));
        check(&format!("{list}{list}"), Err("SEVERAL"));
        check("-----BEGIN CERTIFICATE-----\nMAMCAQE=", Err("NOT_A_FILE"));
        check(
            "-----BEGIN RSA PRIVATE KEY-----\nMAMCAQE=\n-----END RSA PRIVATE KEY-----",
            Err("PRIVATE_KEY"),
        );
        check(
            "-----BEGIN CERTIFICATE REQUEST-----\nMAMC\n-----END CERTIFICATE REQUEST-----",
            Err("NOT_ISSUED"),
        );
        check("not base64!", Err("NOT_A_FILE"));
        check("", Err("NOT_A_FILE"));
    }
}
