//! Status of the platform.

use asi_model::DateTime;
use axum::{Json, extract::State};
use broker::{ConnectionStatus, DiskState, QueueStatus};
use daemon::{plaintext::PlaintextWay, web::session::SignedIn};
use messaging::LinkState;
use serde::Serialize;
use utoipa::ToSchema;

use super::problems::ReadProblems;
use crate::{application::Application, principal::Principal};

/// Status of the platform, with evidence.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Status {
    /// The version of the program.
    version: &'static str,
    /// Start of this process.
    started_at: DateTime,
    /// Its own clock, to tell ages by.
    now: DateTime,
    /// Ways to other machines without TLS that the configuration allows; for administrators.
    #[serde(skip_serializing_if = "Option::is_none")]
    plaintext_ways: Option<Vec<PlaintextWay>>,
    /// True where the key that seals passwords lies beside the store, so that a copy of the folder has both; for
    /// administrators.
    #[serde(skip_serializing_if = "Option::is_none")]
    is_sealing_key_beside_store: Option<bool>,
    /// State of the link to the broker; for administrators, since its times are those of the messages
    /// of all factories.
    #[serde(skip_serializing_if = "Option::is_none")]
    link: Option<LinkState>,
    /// The queues of the embedded broker; for administrators.
    #[serde(skip_serializing_if = "Option::is_none")]
    queues: Option<Vec<QueueStatus>>,
    /// Connections of the embedded broker; for administrators.
    #[serde(skip_serializing_if = "Option::is_none")]
    connections: Option<Vec<ConnectionStatus>>,
    /// Room on the disk of the embedded broker; for administrators.
    #[serde(skip_serializing_if = "Option::is_none")]
    broker_disk: Option<DiskState>,
}

/// Shows the status of the platform.
#[utoipa::path(get, operation_id = "showStatus", path = "/status", tag = "status", security(("session" = [])),
    responses((status = 200, body = Status), ReadProblems))]
pub async fn show(State(app): State<Application>, who: SignedIn<Principal>) -> Json<Status> {
    let is_administrator = who.principal.is_administrator();
    let broker = app.broker_access.broker().filter(|_| is_administrator);
    let (queues, connections, broker_disk) = match &broker {
        Some(broker) => tokio::join!(broker.queues(), broker.connections(), broker.disk()),
        None => (None, None, None),
    };
    let link = app.broker_access.link().filter(|_| is_administrator);
    Json(Status {
        version: env!("CARGO_PKG_VERSION"),
        started_at: app.started_at,
        now: app.clock.now(),
        plaintext_ways: is_administrator.then(|| app.plaintext_ways.clone()),
        is_sealing_key_beside_store: is_administrator
            .then(|| app.config.sealer().is_beside_store()),
        link: link.map(|link| link.state().borrow().clone()),
        queues,
        connections,
        broker_disk,
    })
}
