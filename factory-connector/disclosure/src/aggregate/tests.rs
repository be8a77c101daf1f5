use super::*;

fn at(ms: i64) -> DateTime {
    DateTime::from_unix_micros(1_800_000_000_000_000 + ms * 1_000)
}

/// Aggregates values at milliseconds over windows of a second. Returns the releases until 3.5 s,
/// with their seconds.
fn run(function: AggregateFunction, values: &[(i64, f64)]) -> Vec<(i64, f64)> {
    let aggregate = WindowAggregate { function, window_ms: 1000 };
    let mut aggregation = Aggregation::default();
    let mut left = Vec::new();
    let mut close = |aggregation: &mut Aggregation, now| {
        while let Some((end, value)) = aggregation.close(aggregate, now, BuiltInType::Double) {
            left.push((
                (end.unix_millis() - at(0).unix_millis()) / 1000,
                value.value.as_f64().expect("a number"),
            ));
        }
    };
    for (ms, value) in values {
        close(&mut aggregation, at(*ms));
        aggregation.take(aggregate, at(*ms), DataValue::good(*value, at(*ms)), BuiltInType::Double);
    }
    close(&mut aggregation, at(3500));
    left
}

#[test]
fn each_window_has_one_value() {
    use AggregateFunction as F;
    for (function, values, expected) in [
        (F::Last, &[(0, 1.0), (400, 5.0), (900, 2.0)][..], &[(1, 2.0)][..]),
        (F::Maximum, &[(0, 1.0), (400, 5.0), (900, 2.0)], &[(1, 5.0), (2, 2.0)]),
        (F::Minimum, &[(0, 3.0), (400, 1.0), (900, 2.0)], &[(1, 1.0), (2, 2.0)]),
        // 2 in the first quarter of the window, then 6: the mean is weighted with their times.
        (F::Mean, &[(0, 2.0), (750, 6.0)], &[(1, 3.0), (2, 6.0)]),
        // A window without a candidate has the sum zero, released once.
        (F::Sum, &[(0, 2.0), (500, 3.0), (600, 5.0)], &[(1, 10.0), (2, 0.0)]),
        // The value that is current when the window begins belongs to it.
        (F::Maximum, &[(0, 9.0), (2500, 1.0)], &[(1, 9.0), (3, 9.0)]),
        (F::Mean, &[(0, 4.0), (2500, 8.0)], &[(1, 4.0), (3, 6.0)]),
    ] {
        assert_eq!(run(function, values), expected, "{function:?} of {values:?}");
    }
}

#[test]
fn a_sum_that_overflows_has_no_value() {
    let aggregate = WindowAggregate { function: AggregateFunction::Sum, window_ms: 1000 };
    let mut aggregation = Aggregation::default();
    for ms in [0, 1] {
        aggregation.take(aggregate, at(ms), DataValue::good(200_u8, at(ms)), BuiltInType::Byte);
    }
    let (_, value) = aggregation.close(aggregate, at(1000), BuiltInType::Byte).expect("closed");
    assert_eq!(value.status, StatusCode::BAD_OUT_OF_RANGE);
}

#[test]
fn bad_values_do_not_count_but_their_status_shows() {
    let aggregate = WindowAggregate { function: AggregateFunction::Mean, window_ms: 1000 };
    let mut aggregation = Aggregation::default();
    let lost = DataValue::status_only(StatusCode::BAD_NO_DATA, Some(at(500)));
    aggregation.take(aggregate, at(0), DataValue::good(7_i32, at(0)), BuiltInType::Int32);
    aggregation.take(aggregate, at(500), lost, BuiltInType::Int32);
    let (_, value) = aggregation.close(aggregate, at(1000), BuiltInType::Int32).expect("closed");
    assert_eq!((value.value, value.status), (7_i32.into(), StatusCode::UNCERTAIN_SUB_NORMAL));
    let (_, value) = aggregation.close(aggregate, at(2000), BuiltInType::Int32).expect("closed");
    assert_eq!(value.status, StatusCode::BAD_NO_DATA);
}
