//! Verification of the ledger.

use std::sync::Arc;

use axum::{Json, extract::State};
use daemon::web::Problem;
use ledger::Verification;
use serde::Serialize;
use utoipa::ToSchema;

use crate::{
    api::{context::Api, problems::Problems, roles::Engineer},
    store::Store,
};

/// The outcome of a verification.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct VerificationView {
    /// True where nothing is wrong.
    valid: bool,
    /// Number of chains.
    chains: usize,
    /// The first thing that is wrong, in words.
    fault: Option<String>,
    /// Numbers of verified entries, and all faults.
    #[serde(flatten)]
    verification: Verification,
}

/// Reads every chain from its beginning and finds any change, deletion or reordering; one verification at
/// a time.
#[utoipa::path(
    post,
    path = "/ledger/verification",
    tag = "ledger",
    responses((status = 200, body = VerificationView), Problems)
)]
pub async fn verify_ledger(
    _: Engineer,
    State(api): State<Api>,
) -> Result<Json<VerificationView>, Problem> {
    let Ok(running) = Arc::clone(&api.verification).try_acquire_owned() else {
        return Err(Problem::conflict(
            "VERIFICATION_RUNS",
            "The ledger is being verified already; ask again when that is done.",
        ));
    };
    // Hashing a whole ledger takes its time: it has a thread of its own.
    let directory = api.instance.data_directory.clone();
    let trusted =
        crate::ledger_key::public_half(&directory.join(crate::ledger_key::LEDGER_KEY_FILE))
            .map_err(|error| Problem::internal(&error))?;
    let runtime = tokio::runtime::Handle::current();
    let verified = tokio::task::spawn_blocking(move || {
        // Here, not with the caller: who gives up waiting does not end the work.
        let _running = running;
        runtime.block_on(async {
            let mut session = Store::connect(&directory).await?;
            session.ledger().verify(trusted).await
        })
    });
    let verification = verified.await.map_err(|error| Problem::internal(&error))??;
    let chains = api.store().await?.ledger().recipients().await?.len();
    let fault = verification
        .fault_list
        .first()
        .map(|fault| format!("{}, entry {}: {}", fault.recipient, fault.number, fault.message));
    Ok(Json(VerificationView { valid: verification.is_intact(), chains, fault, verification }))
}
