//! Enrolment: a single-use token becomes this connector's own credential for the broker.

use std::{path::Path, time::Duration};

use anyhow::Context as _;
use asi_model::FactoryId;
use messaging::BrokerProfile;
use serde::Deserialize;

use crate::{
    clock::now,
    store::{Enrolment, Store},
};

/// The platform's answer: address of the broker, and the credential there.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct EnrolmentAnswer {
    factory_id: FactoryId,
    broker_url: String,
    profile: BrokerProfile,
    user_name: String,
    password: String,
    root_certificate_pem: Option<String>,
}

/// Spends a token at the platform and stores the credential in the data directory.
///
/// # Errors
/// A sentence that says what to do: the platform is not reachable, or refuses the token.
pub async fn enrol(
    data_directory: &Path,
    platform: Option<&str>,
    token: &str,
) -> anyhow::Result<FactoryId> {
    let platform = platform.map_or_else(|| address_in(token), |address| Ok(address.to_owned()))?;
    let url = format!("{}/api/v1/enrolments", platform.trim_end_matches('/'));
    // A person waits for the answer at a terminal.
    let http = reqwest::Client::builder().timeout(Duration::from_secs(30)).build()?;
    let answer =
        http.post(&url).json(&serde_json::json!({ "token": token })).send().await.with_context(
            || format!("reaching the platform at {url}; is the address right and the way open?"),
        )?;
    if !answer.status().is_success() {
        let status = answer.status();
        let problem: serde_json::Value = answer.json().await.unwrap_or_default();
        let detail = problem["detail"].as_str().unwrap_or("it gave no reason");
        anyhow::bail!("the platform refused to enrol this connector ({status}): {detail}");
    }
    let answer: EnrolmentAnswer = answer.json().await.context("reading the platform's answer")?;
    std::fs::create_dir_all(data_directory)
        .with_context(|| format!("making the data directory {}", data_directory.display()))?;
    let mut session = Store::connect(data_directory).await?;
    let enrolment = Enrolment {
        factory_id: answer.factory_id.to_string(),
        broker_url: answer.broker_url,
        profile: serde_json::to_string(&answer.profile)?,
        user_name: answer.user_name,
        password: answer.password,
        root_certificate_pem: answer.root_certificate_pem,
    };
    session.enrolments().put(&enrolment, now()).await?;
    Ok(answer.factory_id)
}

/// Returns the address of the platform, which a token carries before its dot.
fn address_in(token: &str) -> anyhow::Result<String> {
    use base64::{Engine as _, engine::general_purpose::URL_SAFE_NO_PAD};
    let address = token
        .split_once('.')
        .and_then(|(address, _)| URL_SAFE_NO_PAD.decode(address).ok())
        .and_then(|bytes| String::from_utf8(bytes).ok());
    address.context(
        "the token carries no address of a platform; copy it again, or give --platform URL",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_carries_the_address_of_its_platform() {
        assert_eq!(
            address_in("aHR0cHM6Ly92ZXJidW5kLmV4YW1wbGU.secret").ok().as_deref(),
            Some("https://verbund.example")
        );
        assert!(address_in("secret").is_err());
    }
}
