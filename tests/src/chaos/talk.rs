//! Remarks both ways while things go wrong. No receipt brings them again, so every hop alone must
//! keep them: the sender's outbox, the broker's queue, and the receiver, which stores before it
//! settles.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
    time::Duration,
};

use serde_json::{Value, json};
use tokio_util::sync::CancellationToken;

use super::stores;
use crate::{
    harness::Api,
    scenario::frame_order::{HAMBURG, MUNICH, NETWORK},
    world::{ADMIN, ENGINEER, PASSWORD, Places},
};

/// Between two remarks of one speaker: often enough that many are being received whenever something
/// is killed.
const PAUSE: Duration = Duration::from_millis(40);

/// A remark, from or to a factory.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Remark {
    pub factory: String,
    pub is_from_factory: bool,
    pub text: String,
}

/// Talks until told to stop.
pub(super) struct Talk {
    stop: CancellationToken,
    speakers: Vec<tokio::task::JoinHandle<Vec<Remark>>>,
}

struct Speaker {
    api: Api,
    user: &'static str,
    factory: &'static str,
    is_from_factory: bool,
}

impl Talk {
    /// Each factory talks to the platform, and the platform to each factory.
    pub fn begin(places: &Places) -> anyhow::Result<Self> {
        let stop = CancellationToken::new();
        let mut speakers = Vec::new();
        for factory in [MUNICH, HAMBURG] {
            let ports = [
                (places.platform_web, ADMIN, false),
                (places.factory(factory)?.connector_web, ENGINEER, true),
            ];
            for (port, user, is_from_factory) in ports {
                let api = Api::new(format!("http://127.0.0.1:{port}"))?;
                let speaker = Speaker { api, user, factory, is_from_factory };
                speakers.push(tokio::spawn(speaker.talk(stop.clone())));
            }
        }
        Ok(Self { stop, speakers })
    }

    /// Everything that was said and taken.
    pub async fn end(self) -> anyhow::Result<Vec<Remark>> {
        self.stop.cancel();
        let mut said = Vec::new();
        for speaker in self.speakers {
            said.extend(speaker.await?);
        }
        Ok(said)
    }
}

impl Speaker {
    async fn talk(mut self, stop: CancellationToken) -> Vec<Remark> {
        let mut said = Vec::new();
        let mut is_signed_in = false;
        for number in 0_u64.. {
            // A program that starts again has forgotten its sessions.
            is_signed_in = is_signed_in || self.api.sign_in(self.user, PASSWORD).await.is_ok();
            if is_signed_in {
                let text = format!("remark {number}");
                is_signed_in = self.say(&text).await.is_ok();
                if is_signed_in {
                    let (factory, is_from_factory) =
                        (self.factory.to_owned(), self.is_from_factory);
                    said.push(Remark { factory, is_from_factory, text });
                }
            }
            if stop.run_until_cancelled(tokio::time::sleep(PAUSE)).await.is_none() {
                break;
            }
        }
        said
    }

    async fn say(&self, text: &str) -> anyhow::Result<()> {
        let path = format!("/api/v1/operation-networks/{NETWORK}/comments");
        let body = match self.is_from_factory {
            true => json!({ "text": text }),
            false => json!({ "factoryId": self.factory, "text": text }),
        };
        self.api.post::<Value>(&path, &body).await.map(drop)
    }
}

/// Remarks that nobody but the broker has yet: one side has not got what the other has said, and it
/// waits in a queue.
pub(super) async fn on_the_way(folder: &Path) -> anyhow::Result<BTreeSet<Remark>> {
    let queued = stores::queued(folder).await?;
    let mut found = BTreeSet::new();
    for factory in [MUNICH, HAMBURG] {
        let (here, there) = stores::remarks(folder, factory).await?;
        let (here, there): (BTreeSet<_>, BTreeSet<_>) =
            (here.into_iter().collect(), there.into_iter().collect());
        found.extend(
            here.symmetric_difference(&there).filter(|remark| remark.is_in(&queued)).cloned(),
        );
    }
    Ok(found)
}

impl Remark {
    /// Whether it is in one of these messages, each with its queue.
    fn is_in(&self, messages: &[(String, Vec<u8>)]) -> bool {
        let queue = format!(
            "factory.{}.{}",
            self.factory,
            if self.is_from_factory { "ingress" } else { "requests" }
        );
        let said = format!("\"text\":{}", Value::from(self.text.as_str()));
        let says = |body: &[u8]| body.windows(said.len()).any(|window| window == said.as_bytes());
        messages.iter().any(|(name, body)| *name == queue && says(body))
    }
}

/// What does not hold: each remark is on both sides once, but for those that the broker lost with
/// its store.
pub(super) async fn faults(
    folder: &Path,
    said: &[Remark],
    lost: &BTreeSet<Remark>,
) -> anyhow::Result<Vec<String>> {
    let mut faults = Vec::new();
    for factory in [MUNICH, HAMBURG] {
        let (here, there) = stores::remarks(folder, factory).await?;
        let (here, there) = (counted(here), counted(there));
        for remark in
            said.iter().filter(|remark| remark.factory == factory && !lost.contains(remark))
        {
            if !here.contains_key(remark) || !there.contains_key(remark) {
                faults.push(format!("a remark is lost: {remark:?}"));
            }
        }
        let twice = here.iter().chain(&there).filter(|(_, count)| **count > 1);
        faults.extend(
            twice.map(|(remark, count)| format!("a remark is held {count} times: {remark:?}")),
        );
    }
    Ok(faults)
}

fn counted(remarks: Vec<Remark>) -> BTreeMap<Remark, usize> {
    let mut counts = BTreeMap::new();
    for remark in remarks {
        *counts.entry(remark).or_default() += 1;
    }
    counts
}
