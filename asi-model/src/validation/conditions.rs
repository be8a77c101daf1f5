//! Rules on conditions, and whether all time frames can hold together.

use super::{FaultCode, reader::Reader};
use crate::{
    network::{ConditionKind, OperationNetwork, OperationRelation},
    schedule::{Conflict, ConflictOrigin, Schedule},
};

/// An absolute kind needs a time, a gap a duration, and neither the other.
pub(super) fn check_bound(
    kind: ConditionKind,
    has_time: bool,
    has_duration: bool,
    pointer: &str,
    reader: &mut Reader,
) {
    if kind.is_gap() {
        if !has_duration {
            let message = "A gap needs a duration, as PT8H.";
            reader.faults.push(
                format!("{pointer}/duration"),
                FaultCode::ConditionNeedsDuration,
                message,
            );
        }
        if has_time {
            let message = "A gap has a duration, not a time; remove the time.";
            reader.faults.push(
                format!("{pointer}/time"),
                FaultCode::ConditionNeedsDuration,
                message,
            );
        }
    } else {
        if !has_time {
            let message = "A condition of this kind needs a time, as 2019-04-18T06:00:00Z.";
            reader.faults.push(format!("{pointer}/time"), FaultCode::ConditionNeedsTime, message);
        }
        if has_duration {
            let message =
                "A condition of this kind has a time, not a duration; remove the duration.";
            reader.faults.push(
                format!("{pointer}/duration"),
                FaultCode::ConditionNeedsTime,
                message,
            );
        }
    }
}

/// The bounds of each condition, and that a relation's conditions do not exclude each other.
pub(super) fn check(relation: &OperationRelation, pointer: &str, reader: &mut Reader) {
    for (index, condition) in relation.condition_list.iter().enumerate() {
        let origin = format!("{pointer}/conditionList/{index}");
        // Read from a text, this was judged where the text is; an unreadable bound is no missing
        // one.
        if !reader.has_text {
            let (has_time, has_duration) = (condition.time.is_some(), condition.duration.is_some());
            check_bound(condition.condition_kind, has_time, has_duration, &origin, reader);
        }
    }
    use ConditionKind as K;
    let gaps = |kind| {
        relation
            .condition_list
            .iter()
            .filter(move |c| c.condition_kind == kind)
            .filter_map(|c| c.duration)
    };
    let times = |kind| {
        relation
            .condition_list
            .iter()
            .filter(move |c| c.condition_kind == kind)
            .filter_map(|c| c.time)
    };
    let contradictions = [
        (
            gaps(K::MinimumGap).max() > gaps(K::MaximumGap).min()
                && gaps(K::MaximumGap).next().is_some(),
            "gap",
        ),
        (
            times(K::StartNoEarlierThan).max() > times(K::StartNoLaterThan).min()
                && times(K::StartNoLaterThan).next().is_some(),
            "start",
        ),
        (
            times(K::FinishNoEarlierThan).max() > times(K::FinishNoLaterThan).min()
                && times(K::FinishNoLaterThan).next().is_some(),
            "finish",
        ),
    ];
    for (_, what) in contradictions.into_iter().filter(|(is_contradiction, _)| *is_contradiction) {
        let message = format!("The lower bound of the {what} lies above its upper bound.");
        reader.faults.push(
            format!("{pointer}/conditionList"),
            FaultCode::ConditionsContradict,
            message,
        );
    }
}

/// Relations, conditions and planned times together.
pub(super) fn check_feasible(network: &OperationNetwork, pointer: &str, reader: &mut Reader) {
    for Conflict { origin, message } in Schedule::of(network).conflicts {
        let origin = match origin {
            ConflictOrigin::PlannedStart { operation } => {
                format!("{pointer}/operationList/{operation}/plannedStart")
            }
            ConflictOrigin::PlannedEnd { operation } => {
                format!("{pointer}/operationList/{operation}/plannedEnd")
            }
            ConflictOrigin::Condition { relation, condition } => {
                format!("{pointer}/operationRelationList/{relation}/conditionList/{condition}")
            }
        };
        reader.faults.push(origin, FaultCode::TimeFrameInfeasible, message);
    }
}
