//! Downloads of a ledger that nobody reads, by several people at once. Each of them held one of the connections
//! through which pages, sign-ins and reports read the store, and after six of them nobody was served.

use std::time::Duration;

use serde_json::{Value, json};

use super::scene::{Scene, Target};
use crate::{
    frame_order::BUYER,
    harness::{Api, ApiError, eventually},
};

pub(super) const NAME: &str = "downloads that nobody reads";

const PASSWORD: &str = "an engineer of their own";
/// People who download at once, each as much as one person may.
const ENGINEERS: usize = 4;
/// Downloads that each of them tries to begin.
const TRIES: usize = 3;
/// Bytes of a ledger that no buffers between the two programs can take: it stops in the middle.
const LEDGER_MIN: usize = 8 << 20;
/// Time until the ledger is that long.
const PATIENCE: Duration = Duration::from_secs(300);
/// Time in which an engineer who comes again has to be served beside.
const SERVED_MAX: Duration = Duration::from_secs(5);

fn export() -> String {
    format!("/api/v1/ledger/export?recipient={BUYER}&format=jsonl")
}

/// Waits until a ledger under load has grown, and plays the attack.
pub(super) async fn run(scene: &mut Scene) -> anyhow::Result<()> {
    let connector = scene.cast.munich.clone();
    let bytes = eventually("the ledger is long", PATIENCE, || async {
        tokio::time::sleep(Duration::from_secs(5)).await;
        let bytes = connector.text(&export()).await.map_err(|e| format!("{e:#}"))?.len();
        if bytes >= LEDGER_MIN { Ok(bytes) } else { Err(format!("{bytes} bytes")) }
    })
    .await?;
    let mut engineers = Vec::new();
    for number in 0..=ENGINEERS {
        engineers.push(engineer(&connector, number).await?);
    }
    let before = scene.before(Target::Connector)?;
    let outcome = unread(&mut engineers, bytes).await;
    scene.judge(NAME, before, outcome).await
}

fn engineer_name(number: usize) -> String {
    format!("engineer-{number}")
}

/// Adds an engineer, and signs in.
async fn engineer(connector: &Api, number: usize) -> anyhow::Result<Api> {
    let name = engineer_name(number);
    let body = json!({ "password": PASSWORD, "role": "ENGINEER" });
    let _: Value = connector.put(&format!("/api/v1/users/{name}"), &body).await?;
    let mut api = Api::new(connector.base())?;
    api.sign_in(&name, PASSWORD).await?;
    Ok(api)
}

/// Begins downloads and does not read them. The last of the engineers is the honest one.
async fn unread(engineers: &mut [Api], bytes: usize) -> anyhow::Result<String> {
    let Some((honest, engineers)) = engineers.split_last_mut() else { anyhow::bail!("nobody") };
    let (mut held, mut refused) = (Vec::new(), 0);
    for engineer in engineers.iter() {
        for _ in 0..TRIES {
            match engineer.events(&export()).await {
                Ok(answer) => held.push(answer),
                Err(error) if is_over_the_share(&error) => refused += 1,
                Err(error) => return Err(error),
            }
        }
    }
    anyhow::ensure!(held.len() >= engineers.len(), "only {} downloads began", held.len());
    anyhow::ensure!(refused > 0, "nobody has a share");
    // What is on its way fills its buffers meanwhile.
    tokio::time::sleep(Duration::from_secs(2)).await;
    let served = async {
        honest.sign_in(&engineer_name(ENGINEERS), PASSWORD).await?;
        for path in ["/api/v1/status", "/api/v1/ledger?limit=10", "/api/v1/spool"] {
            let _: Value = honest.get(path).await?;
        }
        anyhow::ensure!(honest.text(&export()).await?.len() >= bytes, "a download is cut");
        anyhow::Ok(())
    };
    tokio::time::timeout(SERVED_MAX, served).await??;
    Ok(format!("{} of {} MiB held, {refused} refused, others served", held.len(), bytes >> 20))
}

fn is_over_the_share(error: &anyhow::Error) -> bool {
    let status = error.downcast_ref::<ApiError>().map(|error| error.status);
    let status = status.or_else(|| error.downcast_ref::<reqwest::Error>()?.status());
    status == Some(reqwest::StatusCode::TOO_MANY_REQUESTS)
}
