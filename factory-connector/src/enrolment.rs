//! Enrolment: a single-use token becomes this connector's own credential for the broker.

mod token;

use std::{str::FromStr as _, time::Duration};

use anyhow::Context as _;
use asi_model::FactoryId;
use axum::http::Uri;
use daemon::{
    Confidential, data_directory,
    plaintext::{HttpWay, http_way},
};
use message_signature::PublicKey;
use messaging::{BrokerProfile, BrokerUrl};
use reqwest::redirect;
use serde::Deserialize;
use token::TokenParts;

use crate::{
    clock::now,
    config::ConnectorConfig,
    ledger_key::{self, LEDGER_KEY_FILE},
    passwords,
    store::{Enrolment, SecretHolder, Store},
};

/// Time limit of the exchange: a person waits for it at a terminal.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(30);

/// Longest answer of a platform, certificate included.
const ANSWER_BYTES_MAX: usize = 64 * 1024;

/// The platform's answer: address of the broker, and the credential there.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct EnrolmentAnswer {
    factory_id: FactoryId,
    broker_url: String,
    profile: BrokerProfile,
    user_name: String,
    password: Confidential<String>,
    root_certificate_pem: Option<String>,
}

/// Spends a token at the platform and stores the credential in the data directory. Where the token carries
/// the pin of the platform's certificate, it goes to nobody else.
///
/// # Errors
/// A sentence that says what to do: the platform is not reachable, is not the one that made the token, or
/// refuses it; an address would have password or token travel without TLS.
pub async fn enrol(
    config: &ConnectorConfig,
    platform: Option<&str>,
    token: &Confidential<String>,
) -> anyhow::Result<FactoryId> {
    let parts = TokenParts::of(token.expose())?;
    let platform = platform.map_or_else(|| parts.address(), |address| Ok(address.to_owned()))?;
    config.check_platform(&platform).map_err(anyhow::Error::msg)?;
    // Without TLS there is no certificate to compare with the pin.
    anyhow::ensure!(
        parts.pin.is_none() || has_tls(&platform),
        "the token is for the platform with one certificate, and {platform} shows none; write https://, or ask for a token \
         that was made at that address"
    );
    // Before the token is spent: a folder that is refused afterwards would have cost it.
    data_directory::create(&config.data_directory, config.allow_shared_data_directory)?;
    // Over the connection that the token pins, so that no broker can name another key.
    let key = ledger_key::open(&config.data_directory.join(LEDGER_KEY_FILE))?;
    let signing_key = PublicKey::from_bytes(&key.public())?;
    let answer = ask(&platform, &parts, token, &signing_key).await?;
    let named = BrokerUrl::from_str(&answer.broker_url)
        .context("reading the broker's address that the platform named")?;
    config.check_named_broker(&named).map_err(anyhow::Error::msg)?;
    let sealed =
        passwords::seal(&config.sealer(), &SecretHolder::Broker, answer.password.expose())?;
    let enrolment = Enrolment {
        factory_id: answer.factory_id.to_string(),
        broker_url: answer.broker_url,
        profile: serde_json::to_string(&answer.profile)?,
        user_name: answer.user_name,
        sealed_password: Some(sealed),
        root_certificate_pem: answer.root_certificate_pem,
    };
    let mut session = Store::connect(&config.data_directory).await?;
    session.enrolments().put(&enrolment, now()).await?;
    Ok(answer.factory_id)
}

/// Returns what to say of a token that does not name the certificate of its platform; none where it does, and where a
/// platform on this machine needs none.
///
/// # Errors
/// A text that is no token.
pub fn unpinned_note(
    platform: Option<&str>,
    token: &Confidential<String>,
) -> anyhow::Result<Option<&'static str>> {
    let parts = TokenParts::of(token.expose())?;
    let platform = platform.map_or_else(|| parts.address(), |address| Ok(address.to_owned()))?;
    let is_near = !has_tls(&platform) && http_way(&platform) == HttpWay::Safe;
    Ok((parts.pin.is_none() && !is_near).then_some(
        "the token names no certificate of its platform, so it goes to any machine at that address that this one believes; \
         have web.public_certificate set at the platform, and ask for a new token",
    ))
}

fn has_tls(platform: &str) -> bool {
    platform.parse::<Uri>().is_ok_and(|uri| uri.scheme_str() == Some("https"))
}

async fn ask(
    platform: &str,
    parts: &TokenParts,
    token: &Confidential<String>,
    signing_key: &PublicKey,
) -> anyhow::Result<EnrolmentAnswer> {
    let url = format!("{}/api/v1/enrolments", platform.trim_end_matches('/'));
    // A redirect could lead the token to another machine, or out of TLS.
    let mut http =
        reqwest::Client::builder().timeout(ANSWER_TIMEOUT).redirect(redirect::Policy::none());
    if !has_tls(platform) {
        // A proxy that the environment names would get the token in clear, be it on its way to this very machine.
        http = http.no_proxy();
    }
    if let Some(pin) = parts.pin {
        http = http.tls_backend_preconfigured(pin.client_config()?);
    }
    let body =
        serde_json::json!({ "token": token.expose(), "signingKey": signing_key.to_string() });
    let answer = http.build()?.post(&url).json(&body).send().await.with_context(|| {
        let remedy = if parts.pin.is_some() {
            "is the address right and the way open, and has the platform still the certificate that the token was made with? \
             If that was changed, ask for a new token"
        } else {
            "is the address right and the way open?"
        };
        format!("reaching the platform at {url}; {remedy}")
    })?;
    let status = answer.status();
    if let Some(elsewhere) =
        answer.headers().get(reqwest::header::LOCATION).filter(|_| status.is_redirection())
    {
        anyhow::bail!(
            "{url} sends to {}: the token was not sent there; give the platform's own address with --platform",
            String::from_utf8_lossy(elsewhere.as_bytes())
        );
    }
    if !status.is_success() {
        let problem = read(answer).await.unwrap_or_default();
        let problem: serde_json::Value = serde_json::from_slice(&problem).unwrap_or_default();
        let detail = problem["detail"].as_str().unwrap_or("it gave no reason");
        anyhow::bail!("the platform refused to enrol this connector ({status}): {detail}");
    }
    let body = read(answer).await?;
    serde_json::from_slice(&body).context("reading the platform's answer")
}

/// Reads an answer, whatever length it claims or has.
async fn read(mut answer: reqwest::Response) -> anyhow::Result<Vec<u8>> {
    let mut body = Vec::new();
    while let Some(part) = answer.chunk().await.context("reading the platform's answer")? {
        anyhow::ensure!(
            body.len() + part.len() <= ANSWER_BYTES_MAX,
            "the platform's answer is longer than {ANSWER_BYTES_MAX} bytes; is it a platform?"
        );
        body.extend_from_slice(&part);
    }
    Ok(body)
}

#[cfg(test)]
mod tests;
