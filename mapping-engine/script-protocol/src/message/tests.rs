use super::*;
use crate::{Landlock, Sandbox, ScriptValue, frame, value::DEPTH_MAX};
use proptest::{collection::vec, option, prelude::*};

fn text() -> impl Strategy<Value = Arc<str>> {
    "\\PC{0,12}".prop_map(Arc::from)
}

fn value() -> impl Strategy<Value = ScriptValue> {
    let number = any::<f64>().prop_filter("comparable", |v| !v.is_nan());
    let leaf = prop_oneof![
        Just(ScriptValue::Null),
        any::<bool>().prop_map(ScriptValue::Boolean),
        number.clone().prop_map(ScriptValue::Number),
        any::<i64>().prop_map(ScriptValue::Signed),
        any::<u64>().prop_map(ScriptValue::Unsigned),
        text().prop_map(ScriptValue::Text),
        number.prop_map(ScriptValue::Time),
        vec(any::<u8>(), 0..8).prop_map(|bytes| ScriptValue::Bytes(bytes.into())),
    ];
    leaf.prop_recursive(4, 32, 6, |inner| {
        prop_oneof![
            vec(inner.clone(), 0..6).prop_map(ScriptValue::List),
            vec((text(), inner), 0..6).prop_map(ScriptValue::Record),
        ]
    })
}

fn spoken() -> impl Strategy<Value = Spoken> {
    (value(), any::<u32>(), option::of(0.0..1e13))
        .prop_map(|(value, status, source_time_ms)| Spoken { value, status, source_time_ms })
}

fn input() -> impl Strategy<Value = InputValue> {
    (any::<u16>(), spoken()).prop_map(|(input, spoken)| InputValue { input, spoken })
}

fn fault() -> impl Strategy<Value = ScriptFault> {
    let kind = prop::sample::select(vec![
        FaultKind::Syntax,
        FaultKind::Error,
        FaultKind::Timeout,
        FaultKind::OutOfMemory,
        FaultKind::Result,
        FaultKind::NotLoaded,
    ]);
    (kind, text(), text(), option::of(any::<u32>()), option::of(any::<u32>())).prop_map(
        |(kind, name, message, line, column)| ScriptFault { kind, name, message, line, column },
    )
}

fn host_message() -> impl Strategy<Value = HostMessage> {
    let limits = ScriptLimits {
        script_memory_bytes: 8 << 20,
        script_stack_bytes: 256 << 10,
        call_budget: Duration::from_millis(100),
        overrun_budget: Duration::from_millis(150),
        batch_budget: Duration::from_millis(50),
        address_space_bytes: 1 << 30,
    };
    let load =
        (any::<u32>(), text(), text(), vec(text(), 0..4), option::of(text()), vec(input(), 0..3))
            .prop_map(|(script, name, source, inputs, state, values)| {
                HostMessage::Load(Load {
                    script: ScriptId(script),
                    name,
                    source,
                    inputs,
                    state,
                    values,
                })
            });
    let call_value =
        prop_oneof![any::<u16>().prop_map(CallValue::Input), spoken().prop_map(CallValue::Own)];
    let call = (any::<u32>(), call_value, vec(input(), 0..3))
        .prop_map(|(script, value, inputs)| Call { script: ScriptId(script), value, inputs });
    prop_oneof![
        any::<u16>().prop_map(move |version| HostMessage::Hello { version, limits }),
        load,
        any::<u32>().prop_map(|script| HostMessage::Unload(ScriptId(script))),
        vec(call, 0..5).prop_map(HostMessage::Batch),
    ]
}

fn sandbox() -> impl Strategy<Value = Sandbox> {
    let landlock = prop_oneof![Just(Landlock::None), Just(Landlock::Partial), Just(Landlock::Full)];
    (any::<bool>(), landlock, any::<u32>(), any::<bool>()).prop_map(
        |(is_filtered, landlock, user_id, has_limits)| Sandbox {
            is_filtered,
            landlock,
            user_id,
            has_limits,
        },
    )
}

fn worker_message() -> impl Strategy<Value = WorkerMessage> {
    let outcome = prop_oneof![
        Just(Ok(Yielded::Nothing)),
        (value(), any::<u32>()).prop_map(|(value, status)| Ok(Yielded::Value { value, status })),
        fault().prop_map(Err),
    ];
    let result =
        (outcome, option::of(text()), any::<u32>()).prop_map(|(outcome, state, micros)| {
            CallResult { outcome, state, spent: Duration::from_micros(micros.into()) }
        });
    let results = vec(result, 0..5).boxed();
    prop_oneof![
        (any::<u16>(), text(), sandbox()).prop_map(|(version, engine, sandbox)| {
            WorkerMessage::Welcome { version, engine, sandbox }
        }),
        (any::<u32>(), option::of(fault()))
            .prop_map(|(script, fault)| WorkerMessage::Loaded { script: ScriptId(script), fault }),
        results.clone().prop_map(WorkerMessage::Results),
        results.prop_map(WorkerMessage::Overrun),
        any::<u32>().prop_map(|script| WorkerMessage::LoadOverrun(ScriptId(script))),
    ]
}

proptest! {
    #[test]
    fn host_messages_round_trip(message in host_message()) {
        prop_assert_eq!(HostMessage::decode(&message.encode()), Ok(message));
    }

    #[test]
    fn worker_messages_round_trip(message in worker_message()) {
        prop_assert_eq!(WorkerMessage::decode(&message.encode()), Ok(message));
    }

    #[test]
    fn damaged_messages_are_refused_or_read_but_never_worse(
        message in worker_message(),
        at in any::<prop::sample::Index>(),
        byte in any::<u8>(),
        cut in any::<prop::sample::Index>(),
    ) {
        let mut body = message.encode();
        let position = at.index(body.len());
        body[position] = byte;
        let _ = WorkerMessage::decode(&body);
        let _ = HostMessage::decode(&body);
        let shorter = &message.encode()[..cut.index(body.len())];
        prop_assert!(WorkerMessage::decode(shorter).is_err());
    }

    #[test]
    fn any_bytes_are_survived(body in vec(any::<u8>(), 0..200)) {
        let _ = WorkerMessage::decode(&body);
        let _ = HostMessage::decode(&body);
        let mut stream = body.as_slice();
        while let Ok(Some(_)) = frame::read(&mut stream) {}
    }
}

#[test]
fn announced_sizes_reserve_nothing() {
    // A batch of 2^32-1 results in six bytes, and a list nested beyond the bound.
    assert_eq!(WorkerMessage::decode(&[2, 255, 255, 255, 255, 0]), Err(DecodeError::Truncated));
    let mut deep = vec![2, 1, 0, 0, 0, 1];
    deep.extend([8, 1, 0, 0, 0].repeat(DEPTH_MAX + 2));
    assert_eq!(WorkerMessage::decode(&deep), Err(DecodeError::TooDeep(DEPTH_MAX)));
    assert!(frame::read(&mut [255, 255, 255, 255, 0].as_slice()).is_err());
    assert!(frame::framed(&vec![0; frame::FRAME_BYTES_MAX + 1]).is_err());
}
