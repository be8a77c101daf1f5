//! Leases on factories' identities. Of all running connectors with one credential, one holds the
//! lease; the others are refused, and both sides are notified. Pure: the time and the holder's
//! silence are arguments.
//!
//! A connector names the place where its store is in use, and no two living processes can name the
//! same place. So a request from the holder's place comes from its successor, for example after a
//! crash, and is granted at once. A request from another place comes from a successor on another
//! machine or from a copy. It is granted when the holder has fallen silent, unless the holder was
//! heard *after* the first request: then both run, and an administrator has to decide.

use asi_model::{
    DateTime, FactoryId, InstanceId, PlaceId,
    messages::{Lease, LeaseParty, LeaseRequest, LeaseResult},
};
use serde::{Deserialize, Serialize};
use std::time::Duration;
use utoipa::ToSchema;

use crate::clock::new_message_id;

/// Refused connectors that are remembered; beyond, the one heard least recently is forgotten. A
/// copied credential can start any number.
const CONTENDERS_MAX: usize = 8;
/// Time for which the holder is notified of a refused connector, from its last request. Refused
/// connectors ask again far sooner, so one that is quiet for so long is gone.
const CONTENDER_SHOWN_FOR: Duration = Duration::from_secs(15 * 60);

/// A connector that holds the lease or has requested it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Party {
    /// The running connector; another one at every start.
    pub instance_id: InstanceId,
    /// Place of its store.
    pub place: PlaceId,
    /// Machine and folder of its store.
    pub host: String,
    /// Time of the grant, or of the first refused request.
    pub since: DateTime,
    /// Time of the last request.
    pub last_heard_at: DateTime,
    /// True if the holder was heard after the first request: both run, and only an administrator can
    /// grant the lease.
    #[serde(default)]
    pub is_second: bool,
}

/// Lease of a factory, with its holder and the refused connectors.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FactoryLease {
    /// Counts up whenever the lease passes to another place.
    pub number: u64,
    /// Holder of the credential.
    pub holder: Party,
    /// Refused connectors, the last heard first.
    pub contenders: Vec<Party>,
}

/// Decision about a lease request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeaseDecision {
    /// Granted to the holder, at the same place.
    Renewed,
    /// Granted to a new holder.
    Passed,
    /// Held by another connector.
    Refused {
        /// True for the first refusal of this connector.
        is_new: bool,
    },
}

impl Party {
    fn asking(request: &LeaseRequest, since: DateTime, now: DateTime) -> Self {
        Self {
            instance_id: request.instance_id.clone(),
            place: request.place.clone(),
            host: request.host.clone(),
            since,
            last_heard_at: now,
            is_second: false,
        }
    }

    fn view(&self) -> LeaseParty {
        LeaseParty {
            instance_id: self.instance_id.clone(),
            host: self.host.clone(),
            since: self.since,
            last_heard_at: self.last_heard_at,
        }
    }
}

impl FactoryLease {
    /// Decides about a request. `is_silent`: the holder was not heard for the time after which it
    /// counts as gone.
    #[must_use]
    pub fn ask(
        before: Option<Self>,
        request: &LeaseRequest,
        is_silent: bool,
        now: DateTime,
    ) -> (Self, LeaseDecision) {
        let Some(mut lease) = before else {
            let holder = Party::asking(request, now, now);
            return (Self { number: 1, holder, contenders: Vec::new() }, LeaseDecision::Passed);
        };
        // By place and not by instance: a connector that was restarted has its lease back at once.
        if lease.holder.place == request.place {
            lease.holder = Party::asking(request, lease.holder.since, now);
            for contender in &mut lease.contenders {
                contender.is_second = true;
            }
            return (lease, LeaseDecision::Renewed);
        }
        let known = lease.contenders.iter().position(|contender| contender.place == request.place);
        let known = known.map(|place| lease.contenders.remove(place));
        let is_second = known.as_ref().is_some_and(|known| known.is_second);
        if is_silent && !is_second {
            lease.number += 1;
            lease.holder = Party::asking(request, now, now);
            return (lease, LeaseDecision::Passed);
        }
        // Logged once: later refusals repeat the first as long as the connector goes on asking.
        let is_new = known.is_none();
        let since = known.map_or(now, |known| known.since);
        lease.remember(Party { is_second, ..Party::asking(request, since, now) });
        (lease, LeaseDecision::Refused { is_new })
    }

    /// Hands the lease to a refused connector; none when no such connector is remembered.
    #[must_use]
    pub fn handed_over(mut self, to: &InstanceId, now: DateTime) -> Option<Self> {
        let place = self.contenders.iter().position(|contender| contender.instance_id == *to)?;
        let heir = Party { since: now, is_second: false, ..self.contenders.remove(place) };
        let former = std::mem::replace(&mut self.holder, heir);
        self.number += 1;
        // It may be alive, and must not get the lease back by the new holder's silence.
        self.remember(Party { since: now, is_second: true, ..former });
        Some(self)
    }

    /// Returns the answer to a request. `silence`: time after which the holder counts as gone.
    #[must_use]
    pub fn answer(
        &self,
        request: &LeaseRequest,
        decision: LeaseDecision,
        silence: Duration,
        now: DateTime,
    ) -> Lease {
        let is_second = self.contenders.first().is_some_and(|contender| contender.is_second);
        let (result, ask_again) = match decision {
            // Three renewals fit into the time after which the holder counts as gone.
            LeaseDecision::Renewed | LeaseDecision::Passed => (LeaseResult::Granted, silence / 3),
            // Seldom, since only an administrator can change this answer.
            LeaseDecision::Refused { .. } if is_second => (LeaseResult::Refused, silence * 2),
            // Often, to take over as soon as the holder counts as gone.
            LeaseDecision::Refused { .. } => (LeaseResult::Refused, silence / 6),
        };
        let is_granted = result == LeaseResult::Granted;
        let contender = self
            .contenders
            .first()
            .filter(|contender| now.since(contender.last_heard_at) < CONTENDER_SHOWN_FOR);
        Lease {
            message_id: new_message_id(),
            factory_id: request.factory_id.clone(),
            correlation_id: request.message_id.clone(),
            instance_id: request.instance_id.clone(),
            place: request.place.clone(),
            host: request.host.clone(),
            result,
            lease_number: self.number,
            ask_again_ms: u64::try_from(ask_again.as_millis()).unwrap_or(u64::MAX),
            holder: (!is_granted).then(|| self.holder.view()),
            contender: contender.filter(|_| is_granted).map(Party::view),
        }
    }

    /// Returns the reason for which a message with another lease number is rejected.
    #[must_use]
    pub fn why_not(&self, factory: &FactoryId, number: u64) -> String {
        let Self { number: current, holder, .. } = self;
        format!(
            "It was sent under the lease {number} of {factory}; in force is the lease {current}, which {} holds since {}.",
            holder.host, holder.since
        )
    }

    fn remember(&mut self, contender: Party) {
        self.contenders.insert(0, contender);
        self.contenders.truncate(CONTENDERS_MAX);
    }
}

#[cfg(test)]
mod tests {
    use asi_model::messages::PlatformMessage;

    use super::*;

    const SILENCE: Duration = Duration::from_secs(30);

    fn at(seconds: i64) -> DateTime {
        DateTime::from_unix_micros(seconds * 1_000_000)
    }

    fn request(instance: &str, place: &str) -> LeaseRequest {
        LeaseRequest {
            message_id: new_message_id(),
            factory_id: "F".parse().expect("valid"),
            instance_id: instance.parse().expect("valid"),
            place: place.parse().expect("valid"),
            host: format!("host of {place}"),
            started_at: at(0),
        }
    }

    /// Sends requests one after the other (instance, place, whether the holder is silent); returns
    /// the lease and the decisions.
    fn request_in_turn(asked: &[(&str, &str, bool)]) -> (FactoryLease, Vec<LeaseDecision>) {
        let mut lease = None;
        let mut decisions = Vec::new();
        for (second, (instance, place, is_silent)) in (1..).zip(asked) {
            let (after, decision) =
                FactoryLease::ask(lease, &request(instance, place), *is_silent, at(second));
            lease = Some(after);
            decisions.push(decision);
        }
        (lease.expect("an instance asked"), decisions)
    }

    const fn refused(is_new: bool) -> LeaseDecision {
        LeaseDecision::Refused { is_new }
    }

    #[test]
    fn a_successor_at_the_same_place_is_granted_at_once() {
        let (lease, decisions) =
            request_in_turn(&[("a1", "here", false), ("a2", "here", false), ("a3", "here", true)]);
        assert_eq!(
            decisions,
            [LeaseDecision::Passed, LeaseDecision::Renewed, LeaseDecision::Renewed]
        );
        assert_eq!((lease.number, lease.holder.since), (1, at(1)));
        assert_eq!(lease.holder.instance_id.as_str(), "a3");
    }

    #[test]
    fn a_copy_stays_refused_once_both_were_heard() {
        let asked = [
            ("a", "here", false),
            ("b", "there", false),
            ("a", "here", false),
            ("b", "there", true),
            ("b2", "there", true),
        ];
        let (lease, decisions) = request_in_turn(&asked);
        assert_eq!(
            decisions,
            [
                LeaseDecision::Passed,
                refused(true),
                LeaseDecision::Renewed,
                refused(false),
                refused(false)
            ]
        );
        assert_eq!((lease.number, lease.holder.instance_id.as_str()), (1, "a"));
        let contender = &lease.contenders[0];
        assert_eq!(contender.instance_id.as_str(), "b2");
        assert_eq!(contender.since, at(2));
        assert!(contender.is_second);
    }

    #[test]
    fn a_successor_elsewhere_is_granted_when_the_holder_is_silent() {
        let (lease, decisions) =
            request_in_turn(&[("a", "here", false), ("b", "there", false), ("b", "there", true)]);
        assert_eq!(decisions, [LeaseDecision::Passed, refused(true), LeaseDecision::Passed]);
        assert_eq!(lease.number, 2);
        assert_eq!(lease.holder.instance_id.as_str(), "b");
        assert_eq!(lease.contenders.len(), 0);
        // A contender stays refused after the lease has passed to a third connector.
        let asked = [
            ("a", "here", false),
            ("b", "there", false),
            ("a", "here", false),
            ("c", "boot-2", true),
            ("b", "there", true),
        ];
        let (lease, decisions) = request_in_turn(&asked);
        assert_eq!(decisions[3..], [LeaseDecision::Passed, refused(false)]);
        assert_eq!((lease.number, lease.holder.instance_id.as_str()), (2, "c"));
    }

    #[test]
    fn a_former_holder_does_not_regain_a_lease_that_was_handed_over() {
        let (lease, _) = request_in_turn(&[("a", "here", false), ("b", "there", false)]);
        assert_eq!(lease.clone().handed_over(&"nobody".parse().expect("valid"), at(3)), None);
        let lease = lease.handed_over(&"b".parse().expect("valid"), at(3)).expect("b was refused");
        assert_eq!(lease.number, 2);
        assert_eq!(lease.holder.instance_id.as_str(), "b");
        assert_eq!(lease.holder.since, at(3));
        let (lease, decision) = FactoryLease::ask(Some(lease), &request("a", "here"), true, at(4));
        assert_eq!((decision, lease.number), (refused(false), 2));
    }

    #[test]
    fn answers_name_the_other_connector() {
        let answered = |lease: &FactoryLease,
                        request: &LeaseRequest,
                        decision,
                        seconds|
         -> serde_json::Value {
            let message = lease.answer(request, decision, SILENCE, at(seconds));
            serde_json::to_value(PlatformMessage::Lease(message)).expect("JSON")
        };
        let (lease, decisions) = request_in_turn(&[("a", "here", false), ("b", "there", false)]);
        let refusal = answered(&lease, &request("b", "there"), decisions[1], 2);
        assert_eq!(
            (&refusal["result"], &refusal["holder"]["host"]),
            (&"REFUSED".into(), &"host of here".into())
        );
        assert_eq!(refusal["askAgainMs"], 5_000, "whether there are two is not known yet");
        let (lease, decision) = FactoryLease::ask(Some(lease), &request("a", "here"), false, at(3));
        let grant = answered(&lease, &request("a", "here"), decision, 3);
        assert_eq!(
            (&grant["result"], &grant["contender"]["host"]),
            (&"GRANTED".into(), &"host of there".into())
        );
        assert_eq!(
            (&grant["holder"], &grant["askAgainMs"]),
            (&serde_json::Value::Null, &10_000.into())
        );
        let later = answered(&lease, &request("a", "here"), decision, 3600);
        assert_eq!(later["contender"], serde_json::Value::Null, "it has not asked for long");
    }

    #[test]
    fn refused_connectors_are_bounded() {
        let mut asked = vec![("a".to_owned(), "here".to_owned())];
        asked.extend((0..20).map(|number| (format!("c{number}"), format!("place{number}"))));
        let asked: Vec<_> =
            asked.iter().map(|(instance, place)| (&**instance, &**place, false)).collect();
        let (lease, _) = request_in_turn(&asked);
        assert_eq!(
            (lease.contenders.len(), lease.contenders[0].instance_id.as_str()),
            (CONTENDERS_MAX, "c19")
        );
    }
}
