//! Reading statements of the precision in which a value leaves.

use super::{
    message_members::{milliseconds, number},
    reader::Reader,
};
use crate::{
    json::JsonNode,
    messages::{
        AggregateStatement, DisclosureStatement, HoursStatement, RateStatement, StatusResolution,
    },
};

/// Most limits of the rate that one disclosure states.
const RATE_LIMITS_MAX: usize = 16;
/// Most ranges of hours of one disclosure.
const HOURS_MAX: usize = 32;
/// Most bands of one disclosure.
const BANDS_MAX: usize = 1_000;
const DAYS: [(&str, &str); 7] = [
    ("MONDAY", "MONDAY"),
    ("TUESDAY", "TUESDAY"),
    ("WEDNESDAY", "WEDNESDAY"),
    ("THURSDAY", "THURSDAY"),
    ("FRIDAY", "FRIDAY"),
    ("SATURDAY", "SATURDAY"),
    ("SUNDAY", "SUNDAY"),
];
const STATUS_RESOLUTIONS: [(&str, StatusResolution); 2] =
    [("FULL", StatusResolution::Full), ("SEVERITY", StatusResolution::Severity)];

pub(super) fn disclosure(
    reader: &mut Reader,
    node: JsonNode<'_, '_>,
) -> Option<DisclosureStatement> {
    if !reader.is_object(node, "A disclosure") {
        return None;
    }
    let millis = |reader: &mut Reader, name: &str| reader.optional(node, name, milliseconds);
    Some(DisclosureStatement {
        description: reader.required(node, "description", Reader::text).unwrap_or_default(),
        rounding_step: reader.optional(node, "roundingStep", Reader::quantity),
        significant_digits: reader.optional(node, "significantDigits", |reader, node| {
            reader.integer(node, "digits as a number from 0")
        }),
        aggregate: reader.optional(node, "aggregate", aggregate),
        minimum_interval_ms: millis(reader, "minimumIntervalMs"),
        rate_limit_list: reader.optional_list(node, "rateLimitList", RATE_LIMITS_MAX, rate),
        time_step_ms: millis(reader, "timeStepMs"),
        delay_ms: millis(reader, "delayMs"),
        band_list: reader.optional_list(node, "bandList", BANDS_MAX, Reader::number),
        hours_list: reader.optional_list(node, "hoursList", HOURS_MAX, hours),
        is_withheld_in_states: reader
            .optional(node, "isWithheldInStates", Reader::boolean)
            .unwrap_or_default(),
        status_codes: reader
            .optional(node, "statusCodes", |reader, node| reader.choice(node, &STATUS_RESOLUTIONS)),
    })
}

fn hours(reader: &mut Reader, node: JsonNode<'_, '_>) -> Option<HoursStatement> {
    if !reader.is_object(node, "Hours") {
        return None;
    }
    let day_list =
        reader.list(node, "dayList", DAYS.len(), |reader, node| reader.choice(node, &DAYS));
    let from = reader.required(node, "from", Reader::name);
    let until = reader.required(node, "until", Reader::name);
    let offset =
        |reader: &mut Reader, node: JsonNode<'_, '_>| reader.integer(node, "minutes ahead of UTC");
    let utc_offset_minutes = reader.optional(node, "utcOffsetMinutes", offset).unwrap_or_default();
    let day_list = day_list.into_iter().map(str::to_owned).collect();
    Some(HoursStatement { day_list, from: from?, until: until?, utc_offset_minutes })
}

fn aggregate(reader: &mut Reader, node: JsonNode<'_, '_>) -> Option<AggregateStatement> {
    if !reader.is_object(node, "An aggregate") {
        return None;
    }
    let function = reader.required(node, "function", Reader::text);
    let window_ms = reader.required(node, "windowMs", milliseconds);
    Some(AggregateStatement { function: function?, window_ms: window_ms? })
}

fn rate(reader: &mut Reader, node: JsonNode<'_, '_>) -> Option<RateStatement> {
    if !reader.is_object(node, "A limit of the rate") {
        return None;
    }
    let values = number(reader, node, "values");
    let period_ms = reader.required(node, "periodMs", milliseconds);
    Some(RateStatement { values: values?, period_ms: period_ms? })
}
