//! Sharing of the throughput between live reports and a replayed backlog: the backlog drains
//! without starving live values.

use serde::{Deserialize, Serialize};

/// Share of the messages that the replayed backlog gets while live reports wait, in percent (1 to
/// 99).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "u8", into = "u8")]
pub struct ReplayShare(u8);

impl ReplayShare {
    /// A share in percent; none unless it is between 1 and 99, so that neither lane starves.
    #[must_use]
    pub const fn new(percent: u8) -> Option<Self> {
        if percent >= 1 && percent <= 99 { Some(Self(percent)) } else { None }
    }

    /// The share, in percent.
    #[must_use]
    pub const fn percent(self) -> u8 {
        self.0
    }
}

impl Default for ReplayShare {
    fn default() -> Self {
        Self(30)
    }
}

impl TryFrom<u8> for ReplayShare {
    type Error = String;

    fn try_from(percent: u8) -> Result<Self, String> {
        Self::new(percent).ok_or_else(|| {
            format!("the replay share must be between 1 and 99 percent, not {percent}")
        })
    }
}

impl From<ReplayShare> for u8 {
    fn from(share: ReplayShare) -> Self {
        share.0
    }
}

/// The lane to take the next report from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NextLane {
    Live,
    Replay,
}

/// Interleaves the live lane and the replay lane evenly: neither waits for a burst of the other.
#[derive(Debug, Clone)]
pub struct LaneScheduler {
    share: ReplayShare,
    /// Credit of the replay lane, in percent of a message.
    replay_credit: u8,
}

impl LaneScheduler {
    /// A scheduler that has sent nothing yet.
    #[must_use]
    pub const fn new(share: ReplayShare) -> Self {
        Self { share, replay_credit: 0 }
    }

    /// Chooses the lane of the next message; none when both are empty.
    pub fn next(&mut self, is_live_waiting: bool, is_replay_waiting: bool) -> Option<NextLane> {
        match (is_live_waiting, is_replay_waiting) {
            (false, false) => None,
            (true, false) => Some(NextLane::Live),
            (false, true) => Some(NextLane::Replay),
            (true, true) => {
                self.replay_credit += self.share.0;
                if self.replay_credit >= 100 {
                    self.replay_credit -= 100;
                    Some(NextLane::Replay)
                } else {
                    Some(NextLane::Live)
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn scheduler(percent: u8) -> LaneScheduler {
        LaneScheduler::new(ReplayShare::new(percent).expect("in range"))
    }

    proptest! {
        #[test]
        fn the_replay_lane_gets_exactly_its_share(percent in 1u8..=99) {
            let mut lanes = scheduler(percent);
            let replayed = (0..1000)
                .filter(|_| lanes.next(true, true) == Some(NextLane::Replay))
                .count();
            prop_assert_eq!(replayed, usize::from(percent) * 10);
        }

        #[test]
        fn a_lane_that_waits_alone_is_served(percent in 1u8..=99, before in 0usize..200) {
            let mut lanes = scheduler(percent);
            for _ in 0..before {
                lanes.next(true, true);
            }
            prop_assert_eq!(lanes.next(true, false), Some(NextLane::Live));
            prop_assert_eq!(lanes.next(false, true), Some(NextLane::Replay));
            prop_assert_eq!(lanes.next(false, false), None);
        }
    }

    #[test]
    fn a_share_that_starves_a_lane_is_invalid() {
        assert_eq!(ReplayShare::new(0), None);
        assert_eq!(ReplayShare::new(100), None);
        assert!(serde_json::from_str::<ReplayShare>("30").is_ok());
        assert!(serde_json::from_str::<ReplayShare>("100").is_err());
    }
}
