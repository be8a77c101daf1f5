//! Checks of monitoring options, and their conversion to what the protocol stack takes.

use opcua_stack::opcua::types::NumericRange;
use shop_floor_model::{PATH_ELEMENTS_MAX, SEVERITY_MAX};

use crate::{BrowsePath, EventSelection, EventValue, MonitorOptions, ShopFloorError};

/// Checks the ranges of all options.
pub(crate) fn check(options: &MonitorOptions) -> Result<(), ShopFloorError> {
    let invalid = |text: &str| Err(ShopFloorError::Invalid(text.into()));
    let is_interval = |interval: f64| (0.0..=86_400_000.0).contains(&interval);
    if !options.sampling_interval_ms.is_none_or(is_interval) {
        return invalid("a sampling interval must be between 0 ms and a day");
    }
    if options.queue_size.is_some_and(|size| !(1..=10_000).contains(&size)) {
        return invalid("a queue must hold 1 to 10000 changes");
    }
    let is_range = |text: &str| text.len() <= 200 && parse_range(text).is_some();
    if !options.index_range.as_deref().is_none_or(is_range) {
        return invalid("an index range must look like 2 or 1:3");
    }
    let is_path = |path: &BrowsePath| (1..=PATH_ELEMENTS_MAX).contains(&path.0.len());
    if !options.browse_path.as_ref().is_none_or(is_path) {
        return invalid("a browse path must have 1 to 64 elements");
    }
    match &options.events {
        Some(_) if options.index_range.is_some() => {
            invalid("an index range is a part of a variable, events have none")
        }
        Some(events) => check_events(events),
        None => Ok(()),
    }
}

fn check_events(events: &EventSelection) -> Result<(), ShopFloorError> {
    let invalid = |text: &str| Err(ShopFloorError::Invalid(text.into()));
    if let EventValue::Field { path } = &events.value
        && !(1..=PATH_ELEMENTS_MAX).contains(&path.0.len())
    {
        return invalid("the path of an event's field must have 1 to 64 elements");
    }
    if events.severity_min.is_some_and(|least| !(1..=SEVERITY_MAX).contains(&least)) {
        return invalid("the severity of an event is 1 to 1000");
    }
    Ok(())
}

/// Returns the part of an array that is monitored.
pub(crate) fn numeric_range(options: &MonitorOptions) -> NumericRange {
    options.index_range.as_deref().and_then(parse_range).unwrap_or(NumericRange::None)
}

/// Returns the requested sampling interval, else that of the source.
pub(crate) fn sampling_interval_ms(options: &MonitorOptions, default_ms: f64) -> f64 {
    options.sampling_interval_ms.unwrap_or(default_ms)
}

/// Parses `2` or `1:3` (OPC 10000-4 §7.27).
fn parse_range(text: &str) -> Option<NumericRange> {
    text.parse().ok().filter(|range| *range != NumericRange::None)
}
