//! Who speaks for a factory. Of all running connectors with its credential one holds the lease; the
//! others are refused, and everybody concerned is told. Pure: the time and what was heard are
//! arguments.
//!
//! A connector says *where* its store is in use (its place), and no two living processes can say
//! the same place. So who asks from the holder's place has come after it, as after a crash, and
//! goes on at once. Who asks from elsewhere may be the holder's successor on another machine or a
//! copy beside it. It gets the lease when the holder has fallen silent - but never any more once
//! the holder was heard *after* it had asked: then there are two, and people have to decide.

use asi_model::{
    DateTime, FactoryId, InstanceId, PlaceId,
    messages::{Lease, LeaseParty, LeaseRequest, LeaseResult},
};
use serde::{Deserialize, Serialize};
use std::time::Duration;
use utoipa::ToSchema;

use crate::clock::new_message_id;

/// Connectors remembered that were refused; beyond, those that were not heard for longest go.
const CONTENDERS_MAX: usize = 8;
/// How long the holder is told of a connector that was refused.
const TOLD_FOR: Duration = Duration::from_secs(15 * 60);

/// A connector that holds the lease or asked for it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Party {
    /// The running connector; another one at every start.
    #[schema(value_type = String)]
    pub instance_id: InstanceId,
    /// Where its store is in use.
    #[schema(value_type = String)]
    pub place: PlaceId,
    /// Its machine and folder.
    pub host: String,
    /// Since when it holds the lease, or when it asked first.
    #[schema(value_type = String, format = DateTime)]
    pub since: DateTime,
    /// When it asked last.
    #[schema(value_type = String, format = DateTime)]
    pub last_heard_at: DateTime,
    /// The holder was heard after it had asked: both run. It gets the lease from an administrator
    /// only.
    #[serde(default)]
    pub is_second: bool,
}

/// How a factory's lease stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FactoryLease {
    /// Counts up whenever the lease passes to another place.
    pub number: u64,
    /// Who holds it.
    pub holder: Party,
    /// Who else asked and was refused, whoever was heard last first.
    pub contenders: Vec<Party>,
}

/// What a request for the lease led to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Who asks has it, and had it before at the same place.
    Renewed,
    /// Who asks has it from now on.
    Passed,
    /// Somebody else has it.
    Refused {
        /// It was not known of this one before, or not that both run.
        is_news: bool,
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

    fn told(&self) -> LeaseParty {
        LeaseParty {
            instance_id: self.instance_id.clone(),
            host: self.host.clone(),
            since: self.since,
            last_heard_at: self.last_heard_at,
        }
    }
}

impl FactoryLease {
    /// Decides about a request. `is_silent`: nothing was heard of the holder for the time that
    /// makes it count as gone.
    #[must_use]
    pub fn ask(
        before: Option<Self>,
        request: &LeaseRequest,
        is_silent: bool,
        now: DateTime,
    ) -> (Self, Verdict) {
        let Some(mut lease) = before else {
            let holder = Party::asking(request, now, now);
            return (Self { number: 1, holder, contenders: Vec::new() }, Verdict::Passed);
        };
        if lease.holder.place == request.place {
            lease.holder = Party::asking(request, lease.holder.since, now);
            for contender in &mut lease.contenders {
                contender.is_second = true;
            }
            return (lease, Verdict::Renewed);
        }
        let known = lease.contenders.iter().position(|contender| contender.place == request.place);
        let known = known.map(|place| lease.contenders.remove(place));
        let is_second = known.as_ref().is_some_and(|known| known.is_second);
        if is_silent && !is_second {
            lease.number += 1;
            lease.holder = Party::asking(request, now, now);
            return (lease, Verdict::Passed);
        }
        // Told once when it first asks; what follows is the same as long as it goes on asking.
        let is_news = known.is_none();
        let since = known.map_or(now, |known| known.since);
        lease.remember(Party { is_second, ..Party::asking(request, since, now) });
        (lease, Verdict::Refused { is_news })
    }

    /// Gives the lease to a connector that was refused; none where there is no such connector.
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

    /// The answer to a request. `silence`: after how long the holder counts as gone.
    #[must_use]
    pub fn answer(
        &self,
        request: &LeaseRequest,
        verdict: Verdict,
        silence: Duration,
        now: DateTime,
    ) -> Lease {
        let is_second = self.contenders.first().is_some_and(|contender| contender.is_second);
        let (result, ask_again) = match verdict {
            Verdict::Renewed | Verdict::Passed => (LeaseResult::Granted, silence / 3),
            Verdict::Refused { .. } if is_second => (LeaseResult::Refused, silence * 2),
            Verdict::Refused { .. } => (LeaseResult::Refused, silence / 6),
        };
        let is_granted = result == LeaseResult::Granted;
        let contender = self
            .contenders
            .first()
            .filter(|contender| now.since(contender.last_heard_at) < TOLD_FOR);
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
            holder: (!is_granted).then(|| self.holder.told()),
            contender: contender.filter(|_| is_granted).map(Party::told),
        }
    }

    /// Why a message that carries another lease's number is of no use.
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

    /// Asks one after the other: instance, place, whether the holder is silent; and what the
    /// answers are.
    fn play(asked: &[(&str, &str, bool)]) -> (FactoryLease, Vec<Verdict>) {
        let mut lease = None;
        let mut verdicts = Vec::new();
        for (second, (instance, place, is_silent)) in (1..).zip(asked) {
            let (after, verdict) =
                FactoryLease::ask(lease, &request(instance, place), *is_silent, at(second));
            lease = Some(after);
            verdicts.push(verdict);
        }
        (lease.expect("somebody asked"), verdicts)
    }

    const fn refused(is_news: bool) -> Verdict {
        Verdict::Refused { is_news }
    }

    #[test]
    fn who_comes_after_at_the_same_place_goes_on_at_once() {
        let (lease, verdicts) =
            play(&[("a1", "here", false), ("a2", "here", false), ("a3", "here", true)]);
        assert_eq!(verdicts, [Verdict::Passed, Verdict::Renewed, Verdict::Renewed]);
        assert_eq!((lease.number, lease.holder.since), (1, at(1)));
        assert_eq!(lease.holder.instance_id.as_str(), "a3");
    }

    #[test]
    fn a_copy_is_refused_and_gets_nothing_by_waiting_once_both_were_heard() {
        let asked = [
            ("a", "here", false),
            ("b", "there", false),
            ("a", "here", false),
            ("b", "there", true),
            ("b2", "there", true),
        ];
        let (lease, verdicts) = play(&asked);
        assert_eq!(
            verdicts,
            [Verdict::Passed, refused(true), Verdict::Renewed, refused(false), refused(false)]
        );
        assert_eq!((lease.number, lease.holder.instance_id.as_str()), (1, "a"));
        let contender = &lease.contenders[0];
        assert_eq!(
            (contender.instance_id.as_str(), contender.since, contender.is_second),
            ("b2", at(2), true)
        );
    }

    #[test]
    fn a_successor_elsewhere_gets_it_when_the_holder_has_fallen_silent() {
        let (lease, verdicts) =
            play(&[("a", "here", false), ("b", "there", false), ("b", "there", true)]);
        assert_eq!(verdicts, [Verdict::Passed, refused(true), Verdict::Passed]);
        assert_eq!(
            (lease.number, lease.holder.instance_id.as_str(), lease.contenders.len()),
            (2, "b", 0)
        );
        // What was forgotten elsewhere stays refused, whoever else comes.
        let asked = [
            ("a", "here", false),
            ("b", "there", false),
            ("a", "here", false),
            ("c", "boot-2", true),
            ("b", "there", true),
        ];
        let (lease, verdicts) = play(&asked);
        assert_eq!(verdicts[3..], [Verdict::Passed, refused(false)]);
        assert_eq!((lease.number, lease.holder.instance_id.as_str()), (2, "c"));
    }

    #[test]
    fn people_hand_it_over_and_the_former_holder_does_not_get_it_back_by_silence() {
        let (lease, _) = play(&[("a", "here", false), ("b", "there", false)]);
        assert_eq!(lease.clone().handed_over(&"nobody".parse().expect("valid"), at(3)), None);
        let lease = lease.handed_over(&"b".parse().expect("valid"), at(3)).expect("b was refused");
        assert_eq!(
            (lease.number, lease.holder.instance_id.as_str(), lease.holder.since),
            (2, "b", at(3))
        );
        let (lease, verdict) = FactoryLease::ask(Some(lease), &request("a", "here"), true, at(4));
        assert_eq!((verdict, lease.number), (refused(false), 2));
    }

    #[test]
    fn both_are_told_of_each_other() {
        let told =
            |lease: &FactoryLease, request: &LeaseRequest, verdict, seconds| -> serde_json::Value {
                let message = lease.answer(request, verdict, SILENCE, at(seconds));
                serde_json::to_value(PlatformMessage::Lease(message)).expect("JSON")
            };
        let (lease, verdicts) = play(&[("a", "here", false), ("b", "there", false)]);
        let refusal = told(&lease, &request("b", "there"), verdicts[1], 2);
        assert_eq!(
            (&refusal["result"], &refusal["holder"]["host"]),
            (&"REFUSED".into(), &"host of here".into())
        );
        assert_eq!(refusal["askAgainMs"], 5_000, "whether there are two is not known yet");
        let (lease, verdict) = FactoryLease::ask(Some(lease), &request("a", "here"), false, at(3));
        let grant = told(&lease, &request("a", "here"), verdict, 3);
        assert_eq!(
            (&grant["result"], &grant["contender"]["host"]),
            (&"GRANTED".into(), &"host of there".into())
        );
        assert_eq!(
            (&grant["holder"], &grant["askAgainMs"]),
            (&serde_json::Value::Null, &10_000.into())
        );
        let later = told(&lease, &request("a", "here"), verdict, 3600);
        assert_eq!(later["contender"], serde_json::Value::Null, "it has not asked for long");
    }

    #[test]
    fn what_is_remembered_has_a_bound() {
        let mut asked = vec![("a".to_owned(), "here".to_owned())];
        asked.extend((0..20).map(|number| (format!("c{number}"), format!("place{number}"))));
        let asked: Vec<_> =
            asked.iter().map(|(instance, place)| (&**instance, &**place, false)).collect();
        let (lease, _) = play(&asked);
        assert_eq!(
            (lease.contenders.len(), lease.contenders[0].instance_id.as_str()),
            (CONTENDERS_MAX, "c19")
        );
    }
}
