//! Enrolment: the one operation of a connector that has nothing but its token.

use asi_model::FactoryId;
use axum::{Json, extract::State, http::StatusCode};
use daemon::{
    Confidential,
    web::{ApiJson, Problem, problem::ProblemFault},
};
use message_signature::PublicKey;
use messaging::BrokerProfile;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::problems::ChangeProblems;
use crate::{
    application::Application,
    enrolment::{EnrolmentError, enrol as use_token, is_usable},
    store::{
        AuditAgent, AuditAgentKind, AuditFact, AuditFactKind, AuditOutcome, AuditSubject, Scope,
    },
};

/// A token from `POST /factories/{factoryId}/enrolment-tokens`.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Enrol {
    #[schema(value_type = String)]
    token: Confidential<String>,
    /// Ed25519 key that signs the connector's messages, as `x` of its JWK; absent where none does.
    signing_key: Option<String>,
}

impl Enrol {
    /// Reads the key, before the token is spent.
    pub(super) fn signing_key(&self) -> Result<Option<PublicKey>, Problem> {
        let key = self.signing_key.as_deref().map(str::parse).transpose();
        key.map_err(|_| {
            let message = "It is no Ed25519 public key in base64url.".to_owned();
            let fault = ProblemFault {
                pointer: "/signingKey".to_owned(),
                code: "INVALID_KEY".to_owned(),
                message: message.clone(),
            };
            Problem::unprocessable("INVALID_KEY", message, vec![fault])
        })
    }
}

/// Endpoint and credential of a connector, shown this once.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Enrolment {
    factory_id: FactoryId,
    /// The broker's address.
    broker_url: String,
    /// Names of logical addresses at this broker.
    profile: BrokerProfile,
    /// The name to sign in with.
    user_name: String,
    /// The connector's own secret.
    password: String,
    /// The authority that vouches for the broker; absent where the system's roots do.
    root_certificate_pem: Option<String>,
}

/// Uses a token up. Of a factory's credentials the newest two are alive.
#[utoipa::path(post, operation_id = "enrol", path = "/enrolments", tag = "factories", request_body = Enrol,
    responses((status = 201, body = Enrolment), ChangeProblems))]
pub async fn enrol(
    State(app): State<Application>,
    ApiJson(body): ApiJson<Enrol>,
) -> Result<(StatusCode, Json<Enrolment>), Problem> {
    let signing_key = body.signing_key()?;
    let refused =
        || metrics::counter!("verbund_enrolments_total", "result" => "refused").increment(1);
    let mut reading = app.store.reserved_reader().read().await?;
    if !is_usable(&mut reading, &body.token, app.clock.now()).await? {
        refused();
        return Err(EnrolmentError::TokenRefused.into());
    }
    drop(reading);
    // The token says which factory it is.
    let unknown = AuditAgent {
        kind: AuditAgentKind::Factory,
        name: String::new(),
        organisation_id: None,
        is_administrator: false,
    };
    let mut work = app.store.begin(unknown, "enrol").await?;
    let enrolled =
        use_token(&mut work, &app.config, &body.token, signing_key.as_ref(), app.clock.now()).await;
    let (factory_id, credential) = enrolled.inspect_err(|_| refused())?;
    let factory = work.factories().lookup(&Scope::Platform, &factory_id).await?;
    let organisation_id = factory.map(|factory| factory.organisation_id);
    work.set_agent(AuditAgent {
        kind: AuditAgentKind::Factory,
        name: factory_id.to_string(),
        organisation_id: organisation_id.clone(),
        is_administrator: false,
    });
    work.describe(signing_key.map(|_| AuditFact::new(AuditFactKind::SigningKey, "SET")));
    let path = format!("factories/{factory_id}");
    let subject = AuditSubject { path, concerned: organisation_id };
    work.commit(subject, AuditOutcome::Done).await?;
    metrics::counter!("verbund_enrolments_total", "result" => "accepted").increment(1);
    tracing::info!(factory.id = %factory_id, "A connector has enrolled.");
    app.broker_access.reconcile(&app.store.reserved_reader()).await?;
    let access = &app.broker_endpoint;
    Ok((
        StatusCode::CREATED,
        Json(Enrolment {
            factory_id,
            broker_url: access.url.clone(),
            profile: access.profile.clone(),
            user_name: credential.holder.user_name(),
            password: credential.secret.expose().clone(),
            root_certificate_pem: access.root_certificate_pem.clone(),
        }),
    ))
}
