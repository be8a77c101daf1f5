//! Usage of shares by people and their organisations.

use std::{
    collections::HashMap,
    num::{NonZeroU32, NonZeroU64},
    sync::Arc,
    time::{Duration, Instant},
};

use axum::http::StatusCode;
use parking_lot::Mutex;

use super::{
    bucket::Bucket,
    config::FairShareConfig,
    member::Member,
    member_turns::{CHANGES, MemberTurn, MemberTurns, READS},
    refusals::{ShareOwner, count_refusal},
    share::{Places, Share},
};
use crate::web::problem::Problem;

/// Bytes of the bodies of all people that may be under way at once.
const BODY_BYTES_MAX: u64 = 256 * MIB;
const MIB: u64 = 1024 * 1024;
/// Time after which another attempt to send a body makes sense.
const BODY_RETRY_AFTER: Duration = Duration::from_secs(2);

/// Pause between two searches for usage that can be forgotten.
const TIDY_INTERVAL: Duration = Duration::from_secs(1);

/// Usage of all members. Clones share it.
#[derive(Clone)]
pub struct FairShares(Arc<SharedUsage>);

struct SharedUsage {
    config: FairShareConfig,
    usage: Mutex<Usages>,
    reads: MemberTurns,
    changes: MemberTurns,
}

/// Usage of people and organisations that asked lately or hold a place. What is as good as unused is
/// forgotten, so this is bounded by the accounts in use.
#[derive(Default)]
struct Usages {
    persons: HashMap<String, Usage>,
    organisations: HashMap<String, Usage>,
    /// Bytes of all bodies that are under way.
    body_bytes: u64,
    tidied_at: Option<Instant>,
}

#[derive(Default)]
struct Usage {
    requests: Bucket,
    places: Places,
    /// Bytes of bodies that are under way.
    body_bytes: u64,
}

impl FairShares {
    /// Returns shares of which nothing is used yet.
    #[must_use]
    pub fn new(config: FairShareConfig) -> Self {
        let (reads, changes) = (MemberTurns::new(&READS), MemberTurns::new(&CHANGES));
        Self(Arc::new(SharedUsage { config, usage: Mutex::default(), reads, changes }))
    }

    /// Takes a request off the shares of its person and organisation.
    ///
    /// # Errors
    /// 429 `TOO_MANY_REQUESTS`; then nothing was taken off.
    pub fn take_request(&self, member: &Member, now: Instant) -> Result<(), Problem> {
        let config = &self.0.config;
        let mut usages = self.0.usage.lock();
        let (person, organisation) = usages.of(member, now);
        let of_person = person.requests.wait(config.requests_of_person(), now);
        let wait = of_person.max(organisation.as_ref().map_or(Duration::ZERO, |used| {
            used.requests.wait(config.requests_of_organisation(), now)
        }));
        if wait > Duration::ZERO {
            drop(usages);
            count_refusal("requests", member.owner(of_person > Duration::ZERO));
            let detail = "You or your organisation send too many requests; wait a little.";
            return Err(Problem::too_many(detail, wait));
        }
        person.requests.take(config.requests_of_person(), now);
        if let Some(organisation) = organisation {
            organisation.requests.take(config.requests_of_organisation(), now);
        }
        Ok(())
    }

    /// Takes a place for a download or a live stream, which is free again once the place is dropped.
    ///
    /// # Errors
    /// 429 `TOO_MANY_DOWNLOADS` or `TOO_MANY_STREAMS` where person or organisation have no place left.
    pub fn hold(&self, share: Share, member: &Member, now: Instant) -> Result<HeldShare, Problem> {
        let (per_person, per_organisation) = self.0.config.places(share);
        let mut usages = self.0.usage.lock();
        let (person, organisation) = usages.of(member, now);
        let is_person_full = person.places.taken(share) >= per_person;
        let is_full = is_person_full
            || organisation.as_ref().is_some_and(|of| of.places.taken(share) >= per_organisation);
        if is_full {
            drop(usages);
            count_refusal(share.label(), member.owner(is_person_full));
            return Err(share.problem(per_person, per_organisation));
        }
        person.places.take(share);
        if let Some(organisation) = organisation {
            organisation.places.take(share);
        }
        Ok(HeldShare::new(self.clone(), share, member.clone()))
    }

    /// Waits for a turn to read, which ends once it is dropped.
    ///
    /// # Errors
    /// 429 `TOO_MANY_READS` where too many requests of the person wait, or one waits too long.
    pub(super) async fn take_read_turn(&self, member: &Member) -> Result<MemberTurn, Problem> {
        self.0.reads.take(member).await
    }

    /// Waits for a turn to read a portion of an answer that has begun.
    pub(super) async fn wait_to_read(&self, member: &Member) -> MemberTurn {
        self.0.reads.wait(member).await
    }

    /// Waits for a turn to change something, which ends once it is dropped.
    ///
    /// # Errors
    /// 429 `TOO_MANY_CHANGES`, as for reads.
    pub(super) async fn take_change_turn(&self, member: &Member) -> Result<MemberTurn, Problem> {
        self.0.changes.take(member).await
    }

    /// Takes the bytes of a body, which are free again once the hold is dropped. Who has none under way
    /// may always send one.
    ///
    /// # Errors
    /// 429 `TOO_MANY_BODIES` where person, organisation or all together have too many.
    pub(super) fn hold_bytes(
        &self,
        member: &Member,
        bytes: u64,
        now: Instant,
    ) -> Result<HeldBytes, Problem> {
        let config = &self.0.config;
        let mut usages = self.0.usage.lock();
        let of_all = usages.body_bytes;
        let (person, organisation) = usages.of(member, now);
        let is_beyond = |used: u64, max: u64| used.saturating_add(bytes) > max;
        let max = |mib: NonZeroU32| u64::from(mib.get()) * MIB;
        let is_person_full = is_beyond(person.body_bytes, max(config.person.body_mib));
        let is_organisation_full = organisation
            .as_ref()
            .is_some_and(|of| is_beyond(of.body_bytes, max(config.organisation.body_mib)));
        let is_full = is_person_full || is_organisation_full || is_beyond(of_all, BODY_BYTES_MAX);
        if is_full && person.body_bytes > 0 {
            drop(usages);
            let is_own = is_person_full || is_organisation_full;
            let owner = if is_own { member.owner(is_person_full) } else { ShareOwner::All };
            count_refusal("bodies", owner);
            let detail = "You, your organisation or all together send too much at once; wait until some of \
                          it has arrived.";
            return Err(Problem {
                retry_after_seconds: NonZeroU64::new(BODY_RETRY_AFTER.as_secs()),
                ..Problem::new(StatusCode::TOO_MANY_REQUESTS, "TOO_MANY_BODIES", detail)
            });
        }
        person.body_bytes = person.body_bytes.saturating_add(bytes);
        if let Some(organisation) = organisation {
            organisation.body_bytes = organisation.body_bytes.saturating_add(bytes);
        }
        usages.body_bytes = usages.body_bytes.saturating_add(bytes);
        Ok(HeldBytes { shares: self.clone(), member: member.clone(), bytes })
    }

    fn release_bytes(&self, member: &Member, bytes: u64) {
        let mut usages = self.0.usage.lock();
        usages.body_bytes = usages.body_bytes.saturating_sub(bytes);
        if let Some(person) = usages.persons.get_mut(&member.person) {
            person.body_bytes = person.body_bytes.saturating_sub(bytes);
        }
        let organisation = member.organisation.as_ref();
        if let Some(of) = organisation.and_then(|id| usages.organisations.get_mut(id)) {
            of.body_bytes = of.body_bytes.saturating_sub(bytes);
        }
    }

    /// Gives a place back.
    fn release(&self, share: Share, member: &Member) {
        let mut usages = self.0.usage.lock();
        if let Some(person) = usages.persons.get_mut(&member.person) {
            person.places.release(share);
        }
        let organisation = member.organisation.as_ref();
        if let Some(of) = organisation.and_then(|id| usages.organisations.get_mut(id)) {
            of.places.release(share);
        }
    }
}

impl Usages {
    /// Returns the usage of a member's person and organisation.
    fn of(&mut self, member: &Member, now: Instant) -> (&mut Usage, Option<&mut Usage>) {
        self.tidy(now);
        let person = self.persons.entry(member.person.clone()).or_default();
        let organisation = member.organisation.clone();
        (person, organisation.map(|id| self.organisations.entry(id).or_default()))
    }

    /// Forgets those that hold nothing and whose buckets are full again.
    fn tidy(&mut self, now: Instant) {
        if self.tidied_at.is_some_and(|at| now.saturating_duration_since(at) < TIDY_INTERVAL) {
            return;
        }
        self.tidied_at = Some(now);
        let is_in_use = |used: &Usage| {
            !used.places.are_free() || used.body_bytes > 0 || !used.requests.is_full(now)
        };
        self.persons.retain(|_, used| is_in_use(used));
        self.organisations.retain(|_, used| is_in_use(used));
    }
}

impl std::fmt::Debug for FairShares {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("FairShares").field("config", &self.0.config).finish_non_exhaustive()
    }
}

/// Place of one answer; free again when this is dropped.
#[derive(Debug)]
pub struct HeldShare {
    shares: FairShares,
    share: Share,
    member: Member,
}

impl HeldShare {
    fn new(shares: FairShares, share: Share, member: Member) -> Self {
        metrics::gauge!("verbund_shares_held", "share" => share.label()).increment(1.0);
        Self { shares, share, member }
    }
}

impl Drop for HeldShare {
    fn drop(&mut self) {
        metrics::gauge!("verbund_shares_held", "share" => self.share.label()).decrement(1.0);
        self.shares.release(self.share, &self.member);
    }
}

/// Bytes of a body that is under way; free again when this is dropped.
pub(super) struct HeldBytes {
    shares: FairShares,
    member: Member,
    bytes: u64,
}

impl Drop for HeldBytes {
    fn drop(&mut self) {
        self.shares.release_bytes(&self.member, self.bytes);
    }
}

#[cfg(test)]
mod tests;
