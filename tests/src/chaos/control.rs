//! Decisions, revocations and revisions of the network while things go wrong: each has to arrive at the other side,
//! as it was last taken.

mod taken;

use std::{
    collections::BTreeSet,
    path::Path,
    time::{Duration, Instant},
};

use asi_model::DateTime;
use serde_json::{Value, json};
pub(super) use taken::Taken;
use tokio_util::sync::CancellationToken;

use super::stores::{
    self,
    control::{Controls, FieldId, Toggled},
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
/// Rounding step of the last decision: no other one has it, so that none can be taken for the last.
const LAST_ROUNDING_STEP: f64 = 2.0;

/// Engineers and a buyer who change their minds until they are stopped.
pub(super) struct ControlTraffic {
    stop: CancellationToken,
    people: Vec<tokio::task::JoinHandle<Taken>>,
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
    /// Starts an engineer at each factory, and the buyer. Refusals are spread over the length of the run.
    pub fn begin(places: &Places, span: Duration) -> anyhow::Result<Self> {
        let stop = CancellationToken::new();
        let person = |port: u16, user| {
            let api = Api::new(format!("http://127.0.0.1:{port}"))?;
            anyhow::Ok(Person { api, user, is_signed_in: false })
        };
        let mut people =
            vec![tokio::spawn(revise(person(places.platform_web, ADMIN)?, stop.clone()))];
        for factory in [MUNICH, HAMBURG] {
            let engineer = person(places.factory(factory)?.connector_web, ENGINEER)?;
            people.push(tokio::spawn(decide(engineer, factory, span, stop.clone())));
        }
        Ok(Self { stop, people })
    }

    /// Stops, and returns what was taken.
    pub async fn end(self) -> anyhow::Result<Taken> {
        self.stop.cancel();
        let mut all = Taken::default();
        for person in self.people {
            all.add(person.await?);
        }
        Ok(all)
    }
}

impl Person {
    /// Posts or puts, signed in. Returns the answer where it was taken.
    async fn does(&mut self, is_put: bool, path: &str, body: &Value) -> Option<Value> {
        // A program that starts again has forgotten its sessions.
        if !self.is_signed_in && self.api.sign_in(self.user, PASSWORD).await.is_err() {
            return None;
        }
        let answer: anyhow::Result<Value> = match is_put {
            true => self.api.put(path, body).await,
            false => self.api.post(path, body).await,
        };
        self.is_signed_in = answer.is_ok();
        answer.ok()
    }

    /// Opens the toggled field of a factory with a disclosure policy. Returns true where it was taken.
    async fn opens(&mut self, factory: &'static str, step: Option<f64>, taken: &mut Taken) -> bool {
        let disclosure = step.map_or(json!({}), |step| json!({ "roundingStep": step }));
        let (path, body) = load::toggle(factory, disclosure);
        let is_taken = self.does(true, &path, &body).await.is_some();
        taken.toggled(factory, Toggled::Open(step), is_taken);
        is_taken
    }
}

/// Opens and revokes a field by turns, each time with another policy, and refuses others one after the other, each once:
/// what is lost of it does not come with a later decision. The last decision is unlike all others.
async fn decide(
    mut engineer: Person,
    factory: &'static str,
    span: Duration,
    stop: CancellationToken,
) -> Taken {
    let mut taken = Taken::default();
    let refusal_each = span / u32::try_from(load::REFUSED_FIELDS).unwrap_or(u32::MAX);
    let start = Instant::now();
    let mut refused = 0;
    for number in 0_u64.. {
        let is_due = refused < load::REFUSED_FIELDS
            && start.elapsed() >= refusal_each * u32::try_from(refused).unwrap_or(u32::MAX);
        if number % REVOCATION_EACH == REVOCATION_EACH - 1 {
            let body = json!({ "fields": [load::toggled_field(factory)], "reason": format!("revoked {number}") });
            let answer = engineer.does(false, "/api/v1/revocations", &body).await;
            let id = answer.as_ref().and_then(|answer| answer["revocationId"].as_str());
            taken.revoked(factory, id);
        } else if number % 2 == 0 && is_due {
            let (field, reason) = (load::refused_field(refused), format!("Refusal {refused}"));
            let (path, body) = load::refuse(factory, &field, &reason);
            // Stored or not, where no answer came: none may come later.
            refused += 1;
            if engineer.does(true, &path, &body).await.is_some() {
                let field = FieldId { request: load::refused_request(factory), field };
                taken.refused(factory, field, reason);
            }
        } else {
            let step = ROUNDING_STEPS[usize::try_from(number % 3).unwrap_or_default()];
            engineer.opens(factory, step, &mut taken).await;
        }
        if stop.run_until_cancelled(tokio::time::sleep(DECISION_PAUSE)).await.is_none() {
            break;
        }
    }
    // Again, where the program has forgotten who was signed in.
    if !engineer.opens(factory, Some(LAST_ROUNDING_STEP), &mut taken).await {
        engineer.opens(factory, Some(LAST_ROUNDING_STEP), &mut taken).await;
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
            network["description"] = json!(taken::description(number));
            let body = json!({ "collaborationId": COLLABORATION, "operationNetwork": network });
            let answer = buyer.does(true, &path, &body).await;
            if let Some(revision) = answer.and_then(|answer| answer["revision"].as_i64()) {
                taken.revised(revision, number);
            }
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
            let bodies: Vec<&[u8]> = queued
                .iter()
                .filter(|(name, _)| *name == queue)
                .map(|(_, body)| body.as_slice())
                .collect();
            let waiting: Vec<Value> = bodies.iter().flat_map(|body| documents(body)).collect();
            let decisions: BTreeSet<_> = waiting.iter().filter_map(decision).collect();
            // The receipt is a signed text in a message: its id is nowhere else.
            let is_queued =
                |id: &str| bodies.iter().any(|body| String::from_utf8_lossy(body).contains(id));
            let Controls { here, there, .. } = stores::control::controls(folder, factory).await?;
            for (field, decided) in &here.decisions {
                let is_open = there.decisions.get(field) != Some(decided);
                if is_open
                    && let Some(at) = decided.at
                    && decisions.contains(&(field.clone(), at))
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

/// Returns the JSON objects of a message, which has other parts, too.
pub(super) fn documents(mut body: &[u8]) -> Vec<Value> {
    let mut documents = Vec::new();
    while let Some(place) = body.iter().position(|byte| *byte == b'{') {
        body = &body[place..];
        let mut stream = serde_json::Deserializer::from_slice(body).into_iter::<Value>();
        let document = stream.next().and_then(Result::ok);
        let length = if document.is_some() { stream.byte_offset() } else { 1 };
        documents.extend(document);
        body = &body[length..];
    }
    documents
}

/// Returns the field that a message decides, and the time in microseconds since 1970.
fn decision(message: &Value) -> Option<(FieldId, i64)> {
    let text = |name: &str| message[name].as_str().map(str::to_owned);
    let at: DateTime = serde_json::from_value(message["decidedAt"].clone()).ok()?;
    let field = FieldId { request: text("dynamicDataRequestId")?, field: text("fieldName")? };
    Some((field, at.unix_micros()))
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
/// with its store, and what a program does not have though it was `taken`.
pub(super) async fn faults(
    folder: &Path,
    factory: &str,
    lost: &LostControls,
    taken: Option<&Taken>,
) -> anyhow::Result<Vec<String>> {
    let controls = stores::control::controls(folder, factory).await?;
    let mut faults = taken.map_or_else(Vec::new, |taken| taken.missing(factory, &controls));
    let Controls { here, there, .. } = controls;
    let unknown = there
        .decisions
        .iter()
        .filter(|(field, decided)| decided.at.is_some() && !here.decisions.contains_key(*field));
    faults.extend(unknown.map(|(field, decided)| {
        format!("{factory}: {field:?} was never decided, the platform has {decided:?}")
    }));
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

#[cfg(test)]
mod tests {
    use super::*;

    fn field(name: &str) -> FieldId {
        FieldId { request: "r".to_owned(), field: name.to_owned() }
    }

    #[test]
    fn a_decision_is_found_in_a_message_by_its_field_and_time() {
        let body = b"\0Sx{ {\"operationNetworkId\":\"n\",\"dynamicDataRequestId\":\"r\",\"fieldName\":\"f1\",\
            \"decidedAt\":\"1970-01-01T00:00:02.000001Z\"}\0{\"messageId\":{}}";
        let documents = documents(body);
        assert_eq!(documents.len(), 2, "{documents:?}");
        let found: Vec<_> = documents.iter().filter_map(decision).collect();
        assert_eq!(found, [(field("f1"), 2_000_001)]);
    }
}
