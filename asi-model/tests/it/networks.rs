//! Random operation networks that are sound: built around a plan that keeps every relation and
//! condition.

mod texts;

use asi_model::{
    BuiltInType, DateTime, FactoryId,
    ids::{AssetId, FieldName, OrganisationId, ToolId},
    messages::OperationNetworkMessage,
    network::{
        ConditionKind, DynamicDataRequest, EquipmentRequirement, FieldType, IsoDuration, Operation,
        OperationKind, OperationNetwork, OperationRelation, RelationCondition, RelationType,
        ReportDataFormat, ReportField, Semantic, UpdateFrequencyUnit,
    },
};
use proptest::{collection::vec, option, prelude::*, sample::select};

use texts::{ids, name, numbered, quantity, said, text, time, unit};

/// The factory whose parts are made.
pub fn factory() -> FactoryId {
    "FOR_MUC".parse().unwrap()
}

fn field() -> impl Strategy<Value = ReportField> {
    let iri = prop_oneof!["[a-z]{1,8}:[!-~]{1,20}", Just("urn:größe:€".to_owned())];
    let meaning = (select(BuiltInType::ALL.to_vec()), option::of(iri.prop_map(Semantic::Iri)));
    let known = select(vec![
        (BuiltInType::UInt64, Semantic::ProducedQuantity),
        (BuiltInType::Double, Semantic::GoodQuantity),
        (BuiltInType::Byte, Semantic::ScrapQuantity),
        (BuiltInType::Float, Semantic::PercentComplete),
        (BuiltInType::String, Semantic::OperationState),
        (BuiltInType::DateTime, Semantic::ActualStart),
        (BuiltInType::DateTime, Semantic::ActualEnd),
        (BuiltInType::DateTime, Semantic::ExpectedEnd),
    ])
    .prop_map(|(built_in, semantic)| (built_in, Some(semantic)));
    let rank = select(vec![-1, -1, 1, 2, 8]);
    (
        "[A-Za-z_][A-Za-z0-9_.-]{0,30}",
        prop_oneof![meaning, known],
        rank,
        option::of(text()),
        option::of(unit()),
    )
        .prop_map(|(name, (built_in, semantic), rank, description, unit)| ReportField {
            name: name.parse().unwrap(),
            field_type: FieldType(built_in),
            value_rank: if matches!(semantic, None | Some(Semantic::Iri(_))) { rank } else { -1 },
            description,
            unit,
            semantic,
        })
}

/// Fields with distinct names that are not reserved and collide with no unit's member; the first
/// may be called as a part of the model is.
fn fields() -> impl Strategy<Value = Vec<ReportField>> {
    let parts = [
        "ReportName",
        "EngineeringUnits",
        "Semantic",
        "MappingState",
        "IsMapped",
        "ReportDataFormat",
    ];
    (vec(field(), 1..5), option::of(select(parts.to_vec()))).prop_map(|(mut fields, part)| {
        for (number, field) in fields.iter_mut().enumerate() {
            field.name = FieldName::new(format!("{}_{number}", field.name)).unwrap();
        }
        if let Some(part) = part {
            fields[0].name = FieldName::new(part).unwrap();
        }
        fields
    })
}

fn request(id: String) -> impl Strategy<Value = DynamicDataRequest> {
    let publisher = option::of(name().prop_map(|id| ToolId::new(id).unwrap()));
    let recipients = vec(name(), 1..4).prop_map(|mut names| {
        names.sort();
        names.dedup();
        names.into_iter().map(|id| OrganisationId::new(id).unwrap()).collect::<Vec<_>>()
    });
    let validity = (option::of(time()), option::of(time())).prop_map(|validity| match validity {
        (Some(a), Some(b)) if a == b => (Some(a), None),
        (Some(a), Some(b)) => (Some(a.min(b)), Some(a.max(b))),
        other => other,
    });
    use UpdateFrequencyUnit as U;
    let cadence =
        option::of((1_u32.., select(vec![U::Second, U::Minute, U::Hour, U::Day, U::Week])));
    let texts = (said(), option::of(text()), option::of(text()), said());
    (publisher, name(), recipients, validity, cadence, texts, fields()).prop_map(
        move |(
            publisher,
            requester,
            recipient_list,
            (valid_from, valid_until),
            cadence,
            texts,
            report_field_list,
        )| {
            let (purpose, description, buffer_id, report_name) = texts;
            DynamicDataRequest {
                dynamic_data_request_id: id.parse().unwrap(),
                dynamic_data_request_publisher_id: publisher,
                requester_id: requester.parse().unwrap(),
                recipient_list,
                purpose,
                valid_from,
                valid_until,
                description,
                buffer_id,
                update_frequency: cadence.map(|(frequency, _)| frequency),
                update_frequency_unit: cadence.map(|(_, unit)| unit),
                report_data_format: ReportDataFormat { report_name, report_field_list },
            }
        },
    )
}

fn requirement(id: String) -> impl Strategy<Value = EquipmentRequirement> {
    let asset = option::of(ids(1).prop_map(|ids| AssetId::new(&ids[0]).unwrap()));
    (text(), option::of(text()), option::of(quantity()), asset).prop_map(
        move |(equipment_type, capability, quantity, asset_id)| EquipmentRequirement {
            equipment_requirement_id: id.parse().unwrap(),
            equipment_type,
            capability,
            quantity,
            asset_id,
        },
    )
}

/// Time of an operation in the plan that everything agrees with.
#[derive(Debug, Clone, Copy)]
struct Window {
    start: i64,
    end: i64,
}

/// An operation of the factory's own, or a stub; `others` are the ids it may inspect.
fn operation(id: String, window: Window, others: Vec<String>) -> impl Strategy<Value = Operation> {
    let kind = prop_oneof![
        option::of(text()).prop_map(|product_id| OperationKind::Production { product_id }),
        (option::of(select(others)), option::of(text())).prop_map(|(inspected, characteristic)| {
            let inspected_operation_id = inspected.map(|id: String| id.parse().unwrap());
            OperationKind::Inspection { inspected_operation_id, characteristic }
        }),
        (option::of(text()), option::of(text())).prop_map(|(origin, destination)| {
            OperationKind::Transportation { origin, destination }
        }),
    ];
    let is_inspecting_itself = {
        let id = id.clone();
        move |kind: &OperationKind| matches!(kind, OperationKind::Inspection { inspected_operation_id: Some(other), .. } if other.as_str() == id)
    };
    let kind = kind.prop_map(move |kind| match kind {
        kind if is_inspecting_itself(&kind) => OperationKind::Production { product_id: None },
        kind => kind,
    });
    let planned = (any::<bool>(), any::<bool>());
    let quantity = (option::of(quantity()), option::of(unit()));
    let several =
        |count: usize, id: &str| (0..count).map(|number| numbered(id, number)).collect::<Vec<_>>();
    let requirements = (0_usize..3).prop_flat_map({
        let id = id.clone();
        move |count| several(count, &id).into_iter().map(requirement).collect::<Vec<_>>()
    });
    let requests = (0_usize..3).prop_flat_map({
        let id = id.clone();
        move |count| several(count, &id).into_iter().map(request).collect::<Vec<_>>()
    });
    let owner = select(vec![None, Some(factory()), Some("INS_HAM".parse().unwrap())]);
    let texts = (option::of(text()), option::of(text()));
    (kind, texts, owner, planned, quantity, requirements, requests).prop_map(
        move |(
            kind,
            (name, description),
            owner,
            (has_start, has_end),
            quantity,
            requirements,
            requests,
        )| {
            let stub = owner.as_ref().is_some_and(|owner| *owner != factory());
            Operation {
                operation_id: id.parse().unwrap(),
                kind,
                name,
                description,
                stub,
                owning_factory_id: owner,
                planned_start: has_start.then(|| DateTime::from_ticks(window.start)),
                planned_end: has_end.then(|| DateTime::from_ticks(window.end)),
                planned_quantity: quantity.0,
                quantity_unit: quantity.1,
                equipment_requirement_list: if stub { Vec::new() } else { requirements },
                dynamic_data_request_list: if stub { Vec::new() } else { requests },
            }
        },
    )
}

/// A random relation: its ends, its type, and conditions with their distance from the plan.
type RelationDraw =
    (prop::sample::Index, prop::sample::Index, RelationType, Vec<(ConditionKind, i64)>);

fn relation_draw() -> impl Strategy<Value = RelationDraw> {
    use ConditionKind as C;
    use RelationType as R;
    let kinds = vec![
        C::StartNoEarlierThan,
        C::StartNoLaterThan,
        C::FinishNoEarlierThan,
        C::FinishNoLaterThan,
        C::MinimumGap,
        C::MaximumGap,
    ];
    let types = vec![R::FinishToStart, R::StartToStart, R::FinishToFinish, R::StartToFinish];
    (
        any::<prop::sample::Index>(),
        any::<prop::sample::Index>(),
        select(types),
        vec((select(kinds), distance()), 0..4),
    )
}

/// Ticks between a bound and the plan.
fn distance() -> impl Strategy<Value = i64> {
    prop_oneof![Just(0), 0..1_000_000_i64, 0..1_000_000_000_000_000_i64]
}

fn relation(
    id: String,
    draw: &RelationDraw,
    operations: &[String],
    windows: &[Window],
) -> Option<OperationRelation> {
    let (a, b) = (draw.0.index(operations.len()), draw.1.index(operations.len()));
    if a == b {
        return None;
    }
    let (from, to) = (a.min(b), a.max(b));
    let (by_finish, bounds_start) = match draw.2 {
        RelationType::FinishToStart => (true, true),
        RelationType::StartToStart => (false, true),
        RelationType::FinishToFinish => (true, false),
        RelationType::StartToFinish => (false, false),
    };
    let earlier = if by_finish { windows[from].end } else { windows[from].start };
    let later = if bounds_start { windows[to].start } else { windows[to].end };
    let condition = |number: usize, kind: ConditionKind, distance: i64| {
        // Durations are written to the microsecond.
        let span = |ticks: i64| {
            IsoDuration(std::time::Duration::from_micros(
                u64::try_from(ticks / 10).unwrap_or_default(),
            ))
        };
        let round_up = |ticks: i64| ticks + 9;
        let (time, duration) = match kind {
            ConditionKind::StartNoEarlierThan => (Some(windows[to].start - distance), None),
            ConditionKind::StartNoLaterThan => (Some(windows[to].start + distance), None),
            ConditionKind::FinishNoEarlierThan => (Some(windows[to].end - distance), None),
            ConditionKind::FinishNoLaterThan => (Some(windows[to].end + distance), None),
            ConditionKind::MinimumGap => (None, Some(span(later - earlier - distance))),
            ConditionKind::MaximumGap => (None, Some(span(round_up(later - earlier + distance)))),
        };
        RelationCondition {
            condition_id: numbered(&id, number).parse().unwrap(),
            condition_kind: kind,
            time: time.map(DateTime::from_ticks),
            duration,
        }
    };
    let condition_list = draw
        .3
        .iter()
        .enumerate()
        .map(|(number, (kind, distance))| condition(number, *kind, *distance))
        .collect();
    Some(OperationRelation {
        operation_relation_id: id.parse().unwrap(),
        relation_type: draw.2,
        predecessor_operation_id: operations[from].parse().unwrap(),
        successor_operation_id: operations[to].parse().unwrap(),
        condition_list,
    })
}

/// A factory's part of a network that has no faults.
pub fn network() -> impl Strategy<Value = OperationNetwork> {
    let spans = vec((0_i64..1_000_000_000_000, 0_i64..1_000_000_000_000), 1..6);
    (spans, vec(relation_draw(), 0..6)).prop_flat_map(|(spans, draws)| {
        // Around the year 2019, one operation after the other.
        let mut now = 132_000_000_000_000_000_i64;
        let windows: Vec<Window> = spans
            .into_iter()
            .map(|(pause, length)| {
                let window = Window { start: now + pause, end: now + pause + length };
                now = window.end;
                window
            })
            .collect();
        let texts = (ids(1), option::of(text()), option::of(text()));
        (ids(windows.len()), ids(draws.len()), texts).prop_flat_map(
            move |(operations, relations, texts)| {
                let operation_relation_list: Vec<OperationRelation> = relations
                    .into_iter()
                    .zip(&draws)
                    .filter_map(|(id, draw)| relation(id, draw, &operations, &windows))
                    .collect();
                let operation_list: Vec<_> = operations
                    .iter()
                    .zip(&windows)
                    .map(|(id, window)| operation(id.clone(), *window, operations.clone()))
                    .collect();
                operation_list.prop_map(move |operation_list| OperationNetwork {
                    operation_network_id: texts.0[0].parse().unwrap(),
                    name: texts.1.clone(),
                    description: texts.2.clone(),
                    operation_list,
                    operation_relation_list: operation_relation_list.clone(),
                })
            },
        )
    })
}

/// A message with such a network.
pub fn message() -> impl Strategy<Value = OperationNetworkMessage> {
    ("[!-~]{1,128}", name(), 0_u64..1 << 53, network()).prop_map(
        |(message_id, collaboration_id, revision, operation_network)| OperationNetworkMessage {
            message_id: message_id.parse().unwrap(),
            factory_id: factory(),
            collaboration_id: collaboration_id.parse().unwrap(),
            revision,
            operation_network,
        },
    )
}
