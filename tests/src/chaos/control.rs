//! Decisions, revocations and revisions of the network while things go wrong: each has to arrive at the other side,
//! as it was last taken.

use std::{collections::BTreeSet, path::Path, time::Duration};

use serde_json::{Value, json};
use tokio_util::sync::CancellationToken;

use super::stores::{
    self,
    control::{Controls, FieldId},
};
use crate::{
    frame_order::{COLLABORATION, HAMBURG, MUNICH, NETWORK},
    harness::{Api, Deadline},
    scenario::load,
    world::{ADMIN, ENGINEER, PASSWORD, Places},
};

/// Time between two decisions of one engineer.
const DECISION_PAUSE: Duration = Duration::from_millis(250);
/// Time between two revisions of the buyer. A revision that follows one that never came brings all decisions again:
/// with more of them a lost decision would come after all.
const REVISION_PAUSE: Duration = Duration::from_secs(5);
/// One of so many decisions is a revocation.
const REVOCATION_EACH: u64 = 6;
/// Disclosure policies that follow each other: wider and stricter ones.
const ROUNDING_STEPS: [Option<f64>; 3] = [None, Some(5.0), Some(0.5)];

/// Engineers and a buyer who change their minds until they are stopped.
pub(super) struct ControlTraffic {
    stop: CancellationToken,
    people: Vec<tokio::task::JoinHandle<Taken>>,
}

/// Number of what was taken.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Taken {
    pub decisions: u64,
    pub revocations: u64,
    pub revisions: u64,
}

impl Taken {
    /// Returns the numbers for people.
    ///
    /// # Errors
    /// When one of them is zero: then the run proves nothing about it.
    pub fn said(self) -> anyhow::Result<String> {
        let Self { decisions, revocations, revisions } = self;
        let is_any = decisions > 0 && revocations > 0 && revisions > 0;
        anyhow::ensure!(is_any, "not all of decisions, revocations, revisions: {self:?}");
        Ok(format!("; {decisions} decisions, {revocations} revocations, {revisions} revisions"))
    }
}

/// Control messages that were in a queue of the broker when it lost its store.
#[derive(Debug, Default)]
pub(super) struct LostControls {
    decisions: BTreeSet<(String, FieldId, i64)>,
    revocations: BTreeSet<String>,
}

struct Person {
    api: Api,
    user: &'static str,
    is_signed_in: bool,
}

impl ControlTraffic {
    /// Starts an engineer at each factory, and the buyer.
    pub fn begin(places: &Places) -> anyhow::Result<Self> {
        let stop = CancellationToken::new();
        let person = |port: u16, user| {
            let api = Api::new(format!("http://127.0.0.1:{port}"))?;
            anyhow::Ok(Person { api, user, is_signed_in: false })
        };
        let mut people =
            vec![tokio::spawn(revise(person(places.platform_web, ADMIN)?, stop.clone()))];
        for factory in [MUNICH, HAMBURG] {
            let engineer = person(places.factory(factory)?.connector_web, ENGINEER)?;
            people.push(tokio::spawn(decide(engineer, factory, stop.clone())));
        }
        Ok(Self { stop, people })
    }

    /// Stops, and returns what was taken.
    pub async fn end(self) -> anyhow::Result<Taken> {
        self.stop.cancel();
        let mut all = Taken::default();
        for person in self.people {
            let taken = person.await?;
            all.decisions += taken.decisions;
            all.revocations += taken.revocations;
            all.revisions += taken.revisions;
        }
        Ok(all)
    }
}

impl Person {
    /// Posts or puts, signed in. Returns whether it was taken.
    async fn does(&mut self, is_put: bool, path: &str, body: &Value) -> bool {
        // A program that starts again has forgotten its sessions.
        if !self.is_signed_in && self.api.sign_in(self.user, PASSWORD).await.is_err() {
            return false;
        }
        let answer: anyhow::Result<Value> = match is_put {
            true => self.api.put(path, body).await,
            false => self.api.post(path, body).await,
        };
        self.is_signed_in = answer.is_ok();
        self.is_signed_in
    }
}

/// Opens and revokes a field by turns, each time with another policy, and refuses others one after the other.
async fn decide(mut engineer: Person, factory: &'static str, stop: CancellationToken) -> Taken {
    let mut taken = Taken::default();
    for number in 0_u64.. {
        if number % REVOCATION_EACH == REVOCATION_EACH - 1 {
            let body = json!({ "fields": [load::toggled_field(factory)], "reason": format!("revoked {number}") });
            let is_taken = engineer.does(false, "/api/v1/revocations", &body).await;
            taken.revocations += u64::from(is_taken);
        } else if number % 2 == 0 {
            // Each field once: what is lost of it does not come with a later decision.
            let (path, body) = load::refuse(factory, number / 2);
            taken.decisions += u64::from(engineer.does(true, &path, &body).await);
        } else {
            let step = ROUNDING_STEPS[usize::try_from(number % 3).unwrap_or_default()];
            let disclosure = step.map_or(json!({}), |step| json!({ "roundingStep": step }));
            let (path, body) = load::toggle(factory, disclosure);
            taken.decisions += u64::from(engineer.does(true, &path, &body).await);
        }
        if stop.run_until_cancelled(tokio::time::sleep(DECISION_PAUSE)).await.is_none() {
            break;
        }
    }
    taken
}

/// Describes the network otherwise each time.
async fn revise(mut buyer: Person, stop: CancellationToken) -> Taken {
    let path = format!("/api/v1/operation-networks/{NETWORK}");
    let mut taken = Taken::default();
    for number in 0_u64.. {
        if let Ok(view) = buyer.api.get::<Value>(&path).await {
            let mut network = view["network"].clone();
            network["description"] = json!(format!("As of change {number}"));
            let body = json!({ "collaborationId": COLLABORATION, "operationNetwork": network });
            taken.revisions += u64::from(buyer.does(true, &path, &body).await);
        } else {
            buyer.is_signed_in = buyer.api.sign_in(buyer.user, PASSWORD).await.is_ok();
        }
        if stop.run_until_cancelled(tokio::time::sleep(REVISION_PAUSE)).await.is_none() {
            break;
        }
    }
    taken
}

impl LostControls {
    /// Adds what waits in a queue of the broker. The broker does not run.
    pub async fn add(&mut self, folder: &Path) -> anyhow::Result<()> {
        let queued = stores::queued(folder).await?;
        for factory in [MUNICH, HAMBURG] {
            let queue = format!("factory.{factory}.ingress");
            let is_queued = |text: &str| {
                let mut bodies = queued.iter().filter(|(name, _)| *name == queue);
                bodies.any(|(_, body)| String::from_utf8_lossy(body).contains(text))
            };
            let Controls { here, there } = stores::control::controls(folder, factory).await?;
            for (field, decided) in &here.decisions {
                let is_open = there.decisions.get(field) != Some(decided);
                if is_open
                    && let Some(at) = decided.at
                    && is_queued(&field.request)
                {
                    self.decisions.insert((factory.to_owned(), field.clone(), at));
                }
            }
            let open = here.revocations.difference(&there.revocations);
            self.revocations.extend(open.filter(|id| is_queued(id)).cloned());
        }
        Ok(())
    }
}

/// Waits until both factories have answered the newest revision.
pub(super) async fn parts_are_answered(
    platform: &Api,
    patience: Duration,
) -> anyhow::Result<Option<String>> {
    let deadline = Deadline::after(patience);
    loop {
        let view: Value = platform.get(&format!("/api/v1/operation-networks/{NETWORK}")).await?;
        let parts = view["parts"].as_array().cloned().unwrap_or_default();
        let is_answered = |part: &Value| {
            ["ACCEPTED", "UNCHANGED"].contains(&part["state"].as_str().unwrap_or_default())
        };
        if parts.len() == 2 && parts.iter().all(is_answered) {
            return Ok(None);
        }
        if deadline.has_passed() {
            return Ok(Some(format!("parts of the network stay unanswered: {}", view["parts"])));
        }
        tokio::time::sleep(Duration::from_millis(200)).await;
    }
}

/// Returns what one side does not have as the other one decided, revoked or revised it, but for what the broker lost
/// with its store.
pub(super) async fn faults(
    folder: &Path,
    factory: &str,
    lost: &LostControls,
) -> anyhow::Result<Vec<String>> {
    let Controls { here, there } = stores::control::controls(folder, factory).await?;
    let mut faults = Vec::new();
    for (field, decided) in &here.decisions {
        let is_lost = decided
            .at
            .is_some_and(|at| lost.decisions.contains(&(factory.to_owned(), field.clone(), at)));
        let found = there.decisions.get(field);
        if found != Some(decided) && !is_lost {
            faults.push(format!(
                "{factory}: {field:?} is decided {decided:?}, the platform has {found:?}"
            ));
        }
    }
    let missing = here.revocations.difference(&there.revocations);
    faults.extend(
        missing
            .filter(|id| !lost.revocations.contains(*id))
            .map(|id| format!("{factory}: the receipt of revocation {id} is lost")),
    );
    let invented = there.revocations.difference(&here.revocations);
    faults.extend(invented.map(|id| format!("{factory}: revocation {id} was never made")));
    if here.network != there.network {
        faults.push(format!(
            "{factory}: the network is {:?}, the platform has sent {:?}",
            here.network, there.network
        ));
    }
    Ok(faults)
}
