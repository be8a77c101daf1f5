//! Status of the connector.

use asi_model::{DateTime, OrganisationId};
use axum::{Json, extract::State};
use connector_state::ConnectorState;
use daemon::{plaintext::PlaintextWay, web::Problem};
use ledger::LogConflict;
use mapping_engine::ScriptWorkerStatus;
use messaging::{Backlog, LinkPhase, LinkState};
use serde::Serialize;
use shop_floor::SourceStatus;
use time::OffsetDateTime;
use utoipa::ToSchema;

use super::{context::Api, problems::Problems, roles::Viewer};
use crate::{clock::now, lease::LeaseStatus};

/// Status of the connector, with evidence.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Status {
    factory_id: String,
    version: &'static str,
    started_at: DateTime,
    /// Clock of the connector; pages compute ages from it.
    now: DateTime,
    /// Link to the platform; none where the connector runs without one.
    link: Option<LinkStatus>,
    /// Lease to speak for the factory.
    lease: LeaseStatus,
    /// OPC UA server.
    twin: TwinStatus,
    /// Rows that wait to be sent, or for a receipt.
    spool: Backlog,
    /// Status of each local server.
    sources: Vec<SourceStatus>,
    /// Worker processes of scripts, with the walls around each.
    script_workers: Vec<ScriptWorkerStatus>,
    /// Ways to other machines without TLS that the configuration allows.
    plaintext_ways: Vec<PlaintextWay>,
    /// True where the key that seals passwords lies beside the store, so that a copy of the folder has both.
    is_sealing_key_beside_store: bool,
    /// Conflicts with the platform as the witness of the ledger. While there is one, values wait in
    /// the spool.
    ledger_conflicts: Vec<LedgerConflictStatus>,
}

/// A log of the ledger of which the platform holds another history.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LedgerConflictStatus {
    /// Organisation of the chain.
    recipient_id: OrganisationId,
    #[serde(flatten)]
    conflict: LogConflict,
}

/// Link to the platform, with evidence.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LinkStatus {
    #[serde(flatten)]
    phase: LinkPhase,
    /// Time at which the state was entered.
    #[serde(with = "time::serde::rfc3339")]
    #[schema(value_type = String, format = DateTime)]
    since: OffsetDateTime,
    /// Address of the broker.
    broker: String,
    /// Time at which the broker last accepted a message.
    #[serde(with = "time::serde::rfc3339::option")]
    #[schema(value_type = Option<String>, format = DateTime)]
    last_accepted_at: Option<OffsetDateTime>,
    /// Time at which the last receipt of the platform arrived.
    #[serde(with = "time::serde::rfc3339::option")]
    #[schema(value_type = Option<String>, format = DateTime)]
    last_receipted_at: Option<OffsetDateTime>,
    /// Time at which the last message was received.
    #[serde(with = "time::serde::rfc3339::option")]
    #[schema(value_type = Option<String>, format = DateTime)]
    last_received_at: Option<OffsetDateTime>,
    /// Number of messages that wait to be sent; the spool's status has the rest.
    backlog: u64,
    /// Cause for which the link is not up, or an obstacle though it is; a sentence for people.
    reason: Option<String>,
    /// Number of connections established since the start.
    connects: u64,
}

impl From<LinkState> for LinkStatus {
    fn from(state: LinkState) -> Self {
        Self {
            phase: state.phase,
            since: state.since,
            broker: state.broker,
            last_accepted_at: state.last_accepted_at,
            last_receipted_at: state.last_receipted_at,
            last_received_at: state.last_received_at,
            backlog: state.backlog.waiting,
            reason: state.reason,
            connects: state.connects,
        }
    }
}

/// OPC UA server of the connector.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct TwinStatus {
    /// Address for clients; none while it does not listen.
    endpoint_url: Option<String>,
}

/// Shows the status of the connector.
#[utoipa::path(
    get,
    path = "/status",
    tag = "status",
    responses((status = 200, body = Status), Problems)
)]
pub async fn show_status(_: Viewer, State(api): State<Api>) -> Result<Json<Status>, Problem> {
    let spool = api.reserved_store().await?.spool().backlog().await?;
    let ledger_conflicts = api.coordinator.read(ledger_conflicts).await?;
    Ok(Json(Status {
        factory_id: api.instance.factory_id.to_string(),
        version: env!("CARGO_PKG_VERSION"),
        started_at: api.instance.started_at,
        now: now(),
        link: api.link.as_ref().map(|link| link.state().borrow().clone().into()),
        lease: api.lease.borrow().clone(),
        twin: TwinStatus {
            endpoint_url: api.twin.endpoint().borrow().as_deref().map(str::to_owned),
        },
        spool,
        sources: api.shop_floor.states(),
        script_workers: api.engine.script_workers(),
        plaintext_ways: api.instance.plaintext_ways.clone(),
        is_sealing_key_beside_store: api.instance.sealer.is_beside_store(),
        ledger_conflicts,
    }))
}

fn ledger_conflicts(state: &ConnectorState) -> Vec<LedgerConflictStatus> {
    let of = |log: &ledger::Log| {
        let conflict = log.witnessing().conflict()?.clone();
        Some(LedgerConflictStatus { recipient_id: log.start().recipient.clone(), conflict })
    };
    state.ledger().logs().filter_map(of).collect()
}
