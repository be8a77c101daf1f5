//! Inquiry at a server that is no source yet: its endpoints, and a test of security and sign-in.
//!
//! The endpoints are asked for without keeping anything. A test goes the way of a source, so that a certificate that no
//! person has approved is listed for approval.

mod findings;

use std::time::Duration;

use opcua_stack::opcua::{
    client::{Session, UARequest as _, services::CreateSubscription},
    crypto::X509,
    types::{EndpointDescription, UserTokenType},
};
use x509_parser::{certificate::X509Certificate, extensions::GeneralName, prelude::FromDer};

use super::{
    connect::{
        self,
        endpoint_choice::{allows, mode_of, offer_name, policy_of, reachable_url, text},
    },
    connection::RESPONSE_TIMEOUT,
    server_info,
};
use crate::{
    EndpointOffer, MessageSecurity, OfferedCertificate, SecurityChoice, SecurityPolicy,
    ServerFinding, ServerOffer, ShopFloorError, SourceConfig, SourceProblem,
    SourceProblemKind as Kind, TestedServer,
    certificates::{fingerprint, validity},
    clock,
    context::SourceContext,
};

use findings::{Asked, clock_finding, host_of, of_certificates, of_hosts};

/// Longest time of a test, for all its requests together.
const TEST_TIMEOUT: Duration = Duration::from_secs(30);
/// Longest wait until the session of a test is closed on the server.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(2);
/// Longest wait for a name service.
const RESOLUTION_TIMEOUT: Duration = Duration::from_secs(2);
/// Most host names of a server that are looked up: an answer of a stranger must not ask for many.
const HOSTS_MAX: usize = 3;
/// Longest text of a stranger that is shown, in characters.
const TEXT_CHARS_MAX: usize = 500;
/// Signature by RSA over SHA-1 (RFC 8017, sha1WithRSAEncryption).
const SHA1_WITH_RSA: &str = "1.2.840.113549.1.1.5";

/// Asks a server for its endpoints.
pub(crate) async fn discover(
    context: &SourceContext,
    endpoint_url: &str,
) -> Result<ServerOffer, SourceProblem> {
    let offered = connect::offered(context, endpoint_url).await?;
    let mut certificates = certificates(context, &offered).await?;
    let now = clock::now();
    let asked = Asked { url: endpoint_url, host: host_of(endpoint_url) };
    let mut found = host_findings(&asked, &offered).await;
    if !offered.iter().any(is_encrypted) {
        found.push(ServerFinding::NothingEncrypted {
            offered: offered.iter().map(|one| shown(&offer_name(one))).collect(),
        });
    }
    let application_uri = offered.first().map(|one| text(&one.server.application_uri));
    found.extend(of_certificates(&mut certificates, &asked, application_uri.as_deref(), now));
    let mut endpoints: Vec<&EndpointDescription> = offered.iter().collect();
    endpoints.sort_by_key(|endpoint| {
        let policy = policy_of(endpoint);
        let strength = (mode_of(endpoint.security_mode), policy, endpoint.security_level);
        std::cmp::Reverse((policy.is_some(), strength))
    });
    let endpoints = endpoints.into_iter().map(|endpoint| offer(endpoint, endpoint_url)).collect();
    Ok(ServerOffer { endpoints, certificates, findings: found })
}

/// Opens a session as the source would, reads what the server says of itself, and closes the session.
pub(crate) async fn test_source(
    context: &SourceContext,
    source: &SourceConfig,
) -> Result<TestedServer, SourceProblem> {
    match tokio::time::timeout(TEST_TIMEOUT, try_out(context, source)).await {
        Ok(tested) => tested,
        Err(_) => Err(SourceProblem::new(
            Kind::Unreachable,
            "The server takes longer than half a minute for a session and some values.",
        )),
    }
}

async fn try_out(
    context: &SourceContext,
    source: &SourceConfig,
) -> Result<TestedServer, SourceProblem> {
    let opened = connect::open_session(context, source).await?;
    let properties = server_info::read(&opened.session).await;
    let publishing_interval_ms = granted_interval_ms(&opened.session, source).await;
    // Small servers have few places, and keep one that is not given back for half a minute.
    opened.close(CLOSE_TIMEOUT).await;
    let properties = properties?;
    Ok(TestedServer {
        family: properties.product.family(&opened.endpoint),
        endpoint: opened.endpoint.clone(),
        product: properties.product,
        limits: properties.limits,
        publishing_interval_ms,
        clock_ahead_ms: properties.clock_ahead_ms,
        findings: properties.clock_ahead_ms.and_then(clock_finding).into_iter().collect(),
    })
}

/// Returns the publishing interval that the server grants, by a subscription that ends with the session.
async fn granted_interval_ms(session: &Session, source: &SourceConfig) -> Option<u64> {
    let request =
        CreateSubscription::new(session).publishing_interval(source.publishing_interval());
    let granted = tokio::time::timeout(RESPONSE_TIMEOUT, request.send(session.channel())).await;
    let interval = granted.ok()?.ok()?.revised_publishing_interval;
    Some(interval.round().max(0.0) as u64)
}

/// Returns the findings on the hosts by which a server calls itself.
async fn host_findings(asked: &Asked<'_>, offered: &[EndpointDescription]) -> Vec<ServerFinding> {
    let mut urls: Vec<(String, String)> = Vec::new();
    for endpoint in offered {
        let url = text(&endpoint.endpoint_url);
        let host = shown(host_of(&url));
        if !host.is_empty() && !urls.iter().any(|(known, _)| *known == host) {
            urls.push((host, shown(&reachable_url(asked.url, &url))));
        }
    }
    urls.truncate(HOSTS_MAX);
    let mut found = Vec::new();
    for (host, used_url) in urls {
        let is_known = is_host_known(&host).await;
        found.extend(of_hosts(asked, host, used_url, is_known));
    }
    found
}

/// Returns whether an address belongs to a host name here.
async fn is_host_known(host: &str) -> bool {
    let lookup = tokio::net::lookup_host((host.trim_matches(['[', ']']), 0));
    match tokio::time::timeout(RESOLUTION_TIMEOUT, lookup).await {
        Ok(Ok(mut addresses)) => addresses.next().is_some(),
        _ => false,
    }
}

/// Returns the certificates of these endpoints, each once.
async fn certificates(
    context: &SourceContext,
    offered: &[EndpointDescription],
) -> Result<Vec<OfferedCertificate>, SourceProblem> {
    let mut met: Vec<X509> = Vec::new();
    for endpoint in offered {
        let Ok(certificate) = X509::from_byte_string(&endpoint.server_certificate) else {
            continue;
        };
        if !met.iter().any(|known| fingerprint(known) == fingerprint(&certificate)) {
            met.push(certificate);
        }
    }
    let described = context.with_certificates(move |pki| {
        let mut described = Vec::with_capacity(met.len());
        for certificate in &met {
            let is_trusted = pki.known_as_trusted(certificate)?.unwrap_or(false);
            described.push(describe(certificate, is_trusted));
        }
        Ok::<_, ShopFloorError>(described)
    });
    let unread = |reason: String| SourceProblem::new(Kind::Configuration, reason);
    described
        .await
        .map_err(|error| unread(error.to_string()))?
        .map_err(|error| unread(error.to_string()))
}

fn describe(certificate: &X509, is_trusted: bool) -> OfferedCertificate {
    let (valid_from, valid_to) = validity(certificate);
    let der = certificate.as_byte_string();
    let parsed = X509Certificate::from_der(der.as_ref()).ok().map(|(_, parsed)| parsed);
    let (mut application_uri, mut host_names) = (None, Vec::new());
    let names = parsed.as_ref().and_then(|parsed| parsed.subject_alternative_name().ok().flatten());
    for name in names.iter().flat_map(|names| &names.value.general_names) {
        match name {
            GeneralName::URI(uri) => application_uri = Some((*uri).to_owned()),
            GeneralName::DNSName(host) => host_names.push((*host).to_owned()),
            GeneralName::IPAddress(bytes) => host_names.extend(findings::address_text(bytes)),
            _ => {}
        }
    }
    OfferedCertificate {
        thumbprint: certificate.thumbprint().as_hex_string(),
        fingerprint: fingerprint(certificate),
        subject: certificate.subject_name(),
        application_uri,
        host_names,
        valid_from,
        valid_to,
        key_bits: certificate.key_length().ok(),
        is_signed_with_sha1: parsed.is_some_and(|parsed| {
            parsed.signature_algorithm.algorithm.to_id_string() == SHA1_WITH_RSA
        }),
        is_trusted,
    }
}

/// Returns the choice of security that takes exactly this endpoint, if the client uses it.
fn choice(endpoint: &EndpointDescription) -> Option<SecurityChoice> {
    match (policy_of(endpoint)?, mode_of(endpoint.security_mode)) {
        (SecurityPolicy::None, _) => Some(SecurityChoice::None),
        (_, MessageSecurity::None) => None,
        (policy, mode) => Some(SecurityChoice::Exactly { policy, mode }),
    }
}

fn is_encrypted(endpoint: &EndpointDescription) -> bool {
    let mode = mode_of(endpoint.security_mode);
    choice(endpoint).is_some() && mode == MessageSecurity::SignAndEncrypt
}

fn offer(endpoint: &EndpointDescription, asked_url: &str) -> EndpointOffer {
    let uri = endpoint.security_policy_uri.as_ref();
    let certificate = X509::from_byte_string(&endpoint.server_certificate).ok();
    EndpointOffer {
        endpoint_url: shown(&text(&endpoint.endpoint_url)),
        used_url: shown(&reachable_url(asked_url, endpoint.endpoint_url.as_ref())),
        security_policy: shown(uri.rsplit_once('#').map_or(uri, |(_, name)| name)),
        message_security: mode_of(endpoint.security_mode),
        choice: choice(endpoint),
        allows_anonymous: allows(endpoint, UserTokenType::Anonymous),
        allows_user_name: allows(endpoint, UserTokenType::UserName),
        allows_certificate: allows(endpoint, UserTokenType::Certificate),
        server_name: shown(&text(&endpoint.server.application_name.text)),
        application_uri: shown(&text(&endpoint.server.application_uri)),
        certificate_fingerprint: certificate.as_ref().map(fingerprint),
    }
}

fn shown(text: &str) -> String {
    text.chars().take(TEXT_CHARS_MAX).collect()
}

#[cfg(test)]
mod tests {
    use opcua_stack::opcua::crypto::X509Data;

    use super::*;

    #[test]
    fn a_certificate_of_many_names_is_of_each_of_them_and_shown_with_some() {
        let names = (0..25).map(|number| format!("plc-{number}")).chain(["fe80::7".to_owned()]);
        let names = Some(names.collect());
        let description = X509Data {
            alt_host_names: X509Data::alt_host_names("urn:plc", names, false, false, false),
            ..X509Data::sample_cert()
        };
        let (certificate, _) = X509::cert_and_pkey(&description).expect("a certificate");
        let names_of_another_host = |host| {
            let mut described = [describe(&certificate, false)];
            let asked = Asked { url: "opc.tcp://plc", host };
            let found = of_certificates(&mut described, &asked, None, clock::now());
            assert_eq!(described[0].host_names.len(), 20);
            found.into_iter().find_map(|finding| match finding {
                ServerFinding::CertificateOfOtherHost { host_names, .. } => Some(host_names.len()),
                _ => None,
            })
        };
        assert_eq!(names_of_another_host("PLC-24"), None);
        assert_eq!(names_of_another_host("[FE80:0:0::7]"), None);
        assert_eq!(names_of_another_host("plc-25"), Some(20));
    }
}
