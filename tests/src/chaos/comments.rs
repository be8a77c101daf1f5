//! Comments both ways while things go wrong. No receipt brings them again, so every hop alone must
//! keep them: the sender's spool, the broker's queue, and the receiver, which stores before it
//! settles.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
    time::Duration,
};

use serde_json::{Value, json};
use tokio::sync::watch;
use tokio_util::sync::CancellationToken;

use super::stores::{self, Comment};
use crate::{
    frame_order::{HAMBURG, MUNICH, NETWORK},
    harness::Api,
    world::{ADMIN, ENGINEER, PASSWORD, Places},
};

/// Time between two comments of one author while they hurry: many are being received when something is killed.
const SHORT_PAUSE: Duration = Duration::from_millis(10);
/// Time otherwise: a person and a factory have a quota.
const LONG_PAUSE: Duration = Duration::from_secs(2);
/// Most comments of an author; below the quota of a person on a network.
const COMMENTS_MAX: usize = 1900;

/// Comments of one side, and how often each is held.
type Counts = BTreeMap<Comment, usize>;

/// Authors who comment until they are stopped.
pub(super) struct CommentTraffic {
    stop: CancellationToken,
    authors: Vec<tokio::task::JoinHandle<Vec<Comment>>>,
}

struct Author {
    api: Api,
    user: &'static str,
    factory: &'static str,
    is_from_factory: bool,
}

impl CommentTraffic {
    /// Starts an author at each factory, and one at the platform for each factory. They hurry where `comments_hurry` says so.
    pub fn begin(places: &Places, comments_hurry: &watch::Receiver<bool>) -> anyhow::Result<Self> {
        let stop = CancellationToken::new();
        let mut authors = Vec::new();
        for factory in [MUNICH, HAMBURG] {
            let ports = [
                (places.platform_web, ADMIN, false),
                (places.factory(factory)?.connector_web, ENGINEER, true),
            ];
            for (port, user, is_from_factory) in ports {
                let api = Api::new(format!("http://127.0.0.1:{port}"))?;
                let author = Author { api, user, factory, is_from_factory };
                authors
                    .push(tokio::spawn(author.write_until(stop.clone(), comments_hurry.clone())));
            }
        }
        Ok(Self { stop, authors })
    }

    /// Stops the authors, and returns every comment that was accepted.
    pub async fn end(self) -> anyhow::Result<Vec<Comment>> {
        self.stop.cancel();
        let mut accepted = Vec::new();
        for author in self.authors {
            accepted.extend(author.await?);
        }
        Ok(accepted)
    }
}

impl Author {
    async fn write_until(
        mut self,
        stop: CancellationToken,
        mut comments_hurry: watch::Receiver<bool>,
    ) -> Vec<Comment> {
        let mut accepted = Vec::new();
        let mut is_signed_in = false;
        for number in 0_u64.. {
            if accepted.len() >= COMMENTS_MAX {
                break;
            }
            // A program that starts again has forgotten its sessions.
            is_signed_in = is_signed_in || self.api.sign_in(self.user, PASSWORD).await.is_ok();
            if is_signed_in {
                let text = format!("comment {number}");
                is_signed_in = self.post(&text).await.is_ok();
                if is_signed_in {
                    let (factory, is_from_factory) =
                        (self.factory.to_owned(), self.is_from_factory);
                    accepted.push(Comment { factory, is_from_factory, text });
                }
            }
            let pause = async {
                if *comments_hurry.borrow_and_update() {
                    return tokio::time::sleep(SHORT_PAUSE).await;
                }
                tokio::time::timeout(LONG_PAUSE, comments_hurry.changed()).await.ok();
            };
            if stop.run_until_cancelled(pause).await.is_none() {
                break;
            }
        }
        accepted
    }

    async fn post(&self, text: &str) -> anyhow::Result<()> {
        let path = format!("/api/v1/operation-networks/{NETWORK}/comments");
        let body = match self.is_from_factory {
            true => json!({ "text": text }),
            false => json!({ "factoryId": self.factory, "text": text }),
        };
        self.api.post::<Value>(&path, &body).await.map(drop)
    }
}

/// Returns the comments that wait in a queue of the broker: the sender's store has them, and the
/// receiver's has not.
pub(super) async fn on_the_way(folder: &Path) -> anyhow::Result<BTreeSet<Comment>> {
    let queued = stores::queued(folder).await?;
    let mut found = BTreeSet::new();
    for factory in [MUNICH, HAMBURG] {
        let (here, there) = stores::comments(folder, factory).await?;
        let (here, there): (BTreeSet<_>, BTreeSet<_>) =
            (here.into_iter().collect(), there.into_iter().collect());
        found.extend(
            here.symmetric_difference(&there).filter(|comment| comment.is_in(&queued)).cloned(),
        );
    }
    Ok(found)
}

impl Comment {
    /// True when it is in one of these messages, each with its queue.
    fn is_in(&self, messages: &[(String, Vec<u8>)]) -> bool {
        let queue = format!(
            "factory.{}.{}",
            self.factory,
            if self.is_from_factory { "ingress" } else { "requests" }
        );
        let text = format!("\"text\":{}", Value::from(self.text.as_str()));
        let has_text =
            |body: &[u8]| body.windows(text.len()).any(|window| window == text.as_bytes());
        messages.iter().any(|(name, body)| *name == queue && has_text(body))
    }
}

/// Returns breaches of the promise that each comment is on both sides once, but for those that the
/// broker lost with its store.
pub(super) async fn faults(
    folder: &Path,
    accepted: &[Comment],
    lost: &BTreeSet<Comment>,
) -> anyhow::Result<Vec<String>> {
    let mut faults = Vec::new();
    for factory in [MUNICH, HAMBURG] {
        let (here, there) = stores::comments(folder, factory).await?;
        let (here, there) = (counted(here), counted(there));
        for comment in accepted.iter().filter(|comment| comment.factory == factory) {
            let sender = if comment.is_from_factory { &here } else { &there };
            if !sender.contains_key(comment) {
                faults.push(format!("a comment was taken, and is not stored: {comment:?}"));
            }
        }
        faults.extend(lost_ones(&here, &there, lost));
        let twice = here.iter().chain(&there).filter(|(_, count)| **count > 1);
        faults.extend(
            twice.map(|(comment, count)| format!("a comment is held {count} times: {comment:?}")),
        );
    }
    Ok(faults)
}

/// Returns the comments that one side alone has. One that was stored and not answered before its program was killed
/// has to arrive like others.
fn lost_ones(here: &Counts, there: &Counts, lost: &BTreeSet<Comment>) -> Vec<String> {
    let one_side = |side: &Counts, other: &Counts| -> Vec<Comment> {
        side.keys().filter(|comment| !other.contains_key(*comment)).cloned().collect()
    };
    let all = one_side(here, there).into_iter().chain(one_side(there, here));
    all.filter(|comment| !lost.contains(comment))
        .map(|comment| format!("a comment is lost: {comment:?}"))
        .collect()
}

fn counted(comments: Vec<Comment>) -> Counts {
    let mut counts = BTreeMap::new();
    for comment in comments {
        *counts.entry(comment).or_default() += 1;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame_order::MUNICH;

    #[test]
    fn a_comment_on_one_side_alone_is_lost() {
        let comment = |text: &str| Comment {
            factory: MUNICH.to_owned(),
            is_from_factory: true,
            text: text.to_owned(),
        };
        let side = |texts: [&str; 2]| counted(texts.map(comment).to_vec());
        let lost = |here, there, lost: &[Comment]| {
            lost_ones(&side(here), &side(there), &lost.iter().cloned().collect()).len()
        };
        assert_eq!(lost(["1", "2"], ["1", "2"], &[]), 0);
        assert_eq!(lost(["1", "2"], ["1", "1"], &[]), 1);
        assert_eq!(lost(["1", "1"], ["1", "2"], &[]), 1);
        assert_eq!(lost(["1", "2"], ["1", "1"], &[comment("2")]), 0);
    }
}
