//! Values in, values out, faults with their places, and what is not there.

use std::sync::Arc;

use asi_model::{
    DateTime, NodeId, Scalar, StatusCode, Variant,
    values::{Array, ExpandedNodeId, ExtensionBody, ExtensionObject, Server, StructureValue},
};
use mapping_engine::FaultKind;

use super::bench::{Bench, Worker};

fn array(elements: Vec<Scalar>) -> Variant {
    let element_type = elements[0].built_in_type();
    Variant::Array(Arc::new(Array { element_type, elements, dimensions: None }))
}

fn structure() -> Variant {
    let mut value = StructureValue::default();
    value.fields.insert("Watts".into(), 7.5.into());
    value.fields.insert("Count".into(), u64::MAX.into());
    let type_id = ExpandedNodeId { node_id: NodeId::ua(1), server: Server::Local };
    let object = ExtensionObject { type_id, body: ExtensionBody::Structure(value) };
    Variant::Scalar(Scalar::ExtensionObject(Box::new(object)))
}

pub async fn results_are_typed(worker: &Worker) {
    let time = |text: &str| Variant::from(text.parse::<DateTime>().expect("a time"));
    let table: Vec<(&str, Variant, &str, Variant)> = vec![
        ("(v) => v * 2", 21_i32.into(), "Double", 42.0.into()),
        ("(v) => v * 2", 21_u16.into(), "Int32", 42_i32.into()),
        ("(v) => v", u64::MAX.into(), "UInt64", u64::MAX.into()),
        ("(v) => v - 1n", i64::MAX.into(), "Int64", (i64::MAX - 1).into()),
        ("(v) => -v", (1_i64 << 62).into(), "Int64", (-1_i64 << 62).into()),
        ("(v) => BigInt(v)", 300_i32.into(), "UInt16", 300_u16.into()),
        (
            "(v) => v.toUpperCase() + '\u{e4}\u{1f600}'",
            "grün".into(),
            "String",
            "GRÜN\u{e4}\u{1f600}".into(),
        ),
        ("(v) => v", "00123".into(), "String", "00123".into()),
        ("(v) => !v", true.into(), "Boolean", false.into()),
        (
            "(v) => new Date(v.getTime() + 1500)",
            time("2026-01-01T00:00:00.25Z"),
            "DateTime",
            time("2026-01-01T00:00:01.75Z"),
        ),
        ("(v) => v.getTimezoneOffset()", time("2026-07-01T00:00:00Z"), "Double", 0.0.into()),
        (
            "(v) => v.map((x) => x + 1)",
            array(vec![1_i32.into(), 2_i32.into()]),
            "Double",
            array(vec![2.0.into(), 3.0.into()]),
        ),
        ("(v) => v.Watts", structure(), "Double", 7.5.into()),
        ("(v) => v.Count", structure(), "UInt64", u64::MAX.into()),
        (
            "(v) => v[1]",
            Variant::Scalar(Scalar::ByteString(Some(Arc::from([1_u8, 200])))),
            "Byte",
            200_u8.into(),
        ),
        ("(v, ctx) => ctx.status", 1_i32.into(), "UInt32", 0_u32.into()),
        (
            "(v, ctx) => ctx.sourceTimestamp",
            1_i32.into(),
            "DateTime",
            DateTime::from_unix_micros(1_600_000_000_001_000).into(),
        ),
        (
            "(v, ctx) => ctx.inputs.a.value + ctx.inputs.a.status",
            5_i32.into(),
            "Double",
            5.0.into(),
        ),
        ("const k = 10; (v) => v * k", 5_i32.into(), "Double", 50.0.into()),
        ("(function (v) { return { value: v, status: 0 } })", 5_i32.into(), "Double", 5.0.into()),
    ];
    for (index, (source, input, target, expected)) in table.into_iter().enumerate() {
        let mut bench = Bench::start(worker, |_| {});
        let id = format!("m{index}");
        let mapping = {
            let mut mapping = super::bench::script_mapping(&id, &["a"], target, source);
            mapping.target_value_rank = if matches!(expected, Variant::Array(_)) { 1 } else { -1 };
            mapping
        };
        bench.put(mapping).await;
        let value = bench.ask(&id, input).await;
        let fault = bench.status(&id).await.last_fault;
        assert_eq!(
            (value.value, value.status),
            (expected, StatusCode::GOOD),
            "{source}: {fault:?}"
        );
        bench.stop().await;
    }
    side_inputs_and_silence(worker).await;
}

async fn side_inputs_and_silence(worker: &Worker) {
    let mut bench = Bench::start(worker, |_| {});
    bench.put_script("sum", &["a", "b"], "Double", "(v, ctx) => v + ctx.inputs.b.value").await;
    bench.feed("sum", "a", 1_i32).await;
    bench.feed("sum", "b", 10_i32).await;
    assert_eq!(bench.next("sum").await.value.value, 11.0.into());
    assert_eq!(bench.ask("sum", 2_i32).await.value, 12.0.into());
    bench.feed("sum", "b", 20_i32).await;
    assert_eq!(bench.next("sum").await.value.value, 22.0.into());

    bench.put_script("odd", &["a"], "Double", "(v) => v % 2 ? v : undefined").await;
    bench.feed_all("odd", "a", [1_i32.into(), 2_i32.into(), 3_i32.into()]).await;
    assert_eq!(bench.next("odd").await.value.value, 1.0.into());
    assert_eq!(bench.next("odd").await.value.value, 3.0.into(), "undefined says nothing");

    bench.put_script("null", &["a"], "Double", "(v) => null").await;
    let value = bench.ask("null", 1_i32).await;
    assert_eq!((value.value, value.status), (Variant::Null, StatusCode::BAD_NO_DATA));

    bench.put_script("doubt", &["a"], "Double", "(v) => ({ value: v, status: 0x40000000 })").await;
    let value = bench.ask("doubt", 1_i32).await;
    assert_eq!((value.value, value.status), (1.0.into(), StatusCode::UNCERTAIN));
    bench.stop().await;
}

pub async fn faults_have_kind_and_place(worker: &Worker) {
    use FaultKind as K;
    let table: &[(&str, K, Option<u32>)] = &[
        ("(v) => {\n  return v +;\n}", K::ScriptSyntax, Some(2)),
        ("42", K::ScriptResult, None),
        ("throw new Error('at the top')", K::ScriptError, Some(1)),
        ("(v) => {\n\n  return v.no.such;\n}", K::ScriptError, Some(3)),
        ("(v) => { throw new RangeError('far') }", K::ScriptError, Some(1)),
        ("(v) => { throw 'a text' }", K::ScriptError, None),
        ("(v) => ({ some: 'thing' })", K::ScriptResult, None),
        ("(v) => 2n ** 64n", K::ScriptResult, None),
        ("(v) => -(2n ** 63n) - 1n", K::ScriptResult, None),
        ("(v) => Symbol('s')", K::ScriptResult, None),
        ("(v) => () => 1", K::ScriptResult, None),
        ("async (v) => v", K::ScriptResult, None),
        ("(v) => new Date(NaN)", K::ScriptResult, None),
        ("(v) => [1, 'x']", K::ScriptResult, None),
        ("(v) => 'text'", K::TypeMismatch, None),
        ("(v) => 1.5", K::OutOfRange, None),
        ("(v, ctx) => { ctx.state = 'x'.repeat(5000); return 1 }", K::ScriptResult, None),
        ("(v, ctx) => { ctx.state = () => 1; return 1 }", K::ScriptError, None),
        ("(v) => { const f = () => f(); f() }", K::ScriptError, None),
        ("(v) => JSON.parse('{')", K::ScriptError, None),
        ("(v) => { undeclared = v }", K::ScriptError, Some(1)),
        ("(v) => '\\ud800'", K::ScriptResult, None),
    ];
    let mut bench = Bench::start(worker, |_| {});
    for (index, (source, kind, line)) in table.iter().enumerate() {
        let id = format!("m{index}");
        bench.put_script(&id, &["a"], "Int32", source).await;
        let value = bench.ask(&id, 1_i32).await;
        assert!(value.status.0 >> 30 == 2 && value.value.is_null(), "{source}: {value:?}");
        let fault = bench.status(&id).await.last_fault.expect("a fault");
        assert_eq!(fault.kind, *kind, "{source}: {fault:?}");
        if let Some(line) = line {
            assert_eq!(fault.line, Some(*line), "{source}: {fault:?}");
            assert!(fault.column.is_some(), "{source}: {fault:?}");
        }
    }
    bench.stop().await;
}

pub async fn the_sandbox_has_no_way_out(worker: &Worker) {
    let mut bench = Bench::start(worker, |_| {});
    for (index, name) in [
        "eval",
        "Function",
        "require",
        "process",
        "Deno",
        "fetch",
        "XMLHttpRequest",
        "WebAssembly",
        "SharedArrayBuffer",
        "Atomics",
        "setTimeout",
        "queueMicrotask",
        "performance",
        "console",
        "std",
        "os",
        "gc",
        "ShadowRealm",
        "__bootstrap",
        "Worker",
        "Intl",
        "Temporal",
    ]
    .into_iter()
    .enumerate()
    {
        let id = format!("global{index}");
        bench
            .put_script(&id, &["a"], "String", &format!("(v) => typeof globalThis[{name:?}]"))
            .await;
        assert_eq!(bench.ask(&id, 1_i32).await.value, "undefined".into(), "{name}");
    }
    // No way from text to code, and nothing that one script does to its world reaches another.
    bench.put_script("code", &["a"], "String", "(v) => typeof (() => {}).constructor").await;
    assert_eq!(bench.ask("code", 1_i32).await.value, "undefined".into());
    let pollute = "Object.prototype.x = 1; Array.prototype.map = () => 'gone'; globalThis.y = 2; JSON.stringify = 1; (v) => v";
    bench.put_script("polluter", &["a"], "Double", pollute).await;
    assert_eq!(bench.ask("polluter", 1_i32).await.value, 1.0.into());
    let look = "(v) => `${({}).x} ${typeof globalThis.y} ${[1].map((n) => n + 1)}`";
    bench.put_script("neighbour", &["a"], "String", look).await;
    assert_eq!(bench.ask("neighbour", 1_i32).await.value, "undefined undefined 2".into());
    assert_eq!(
        bench.ask("polluter", 2_i32).await.value,
        2.0.into(),
        "its own world still serves it"
    );
    // What the engine itself makes is of the script's own world, too, and no way out of it.
    let climb = "(v) => [v, [], import('fs'), (() => { try { null.x } catch (e) { return e } })(), globalThis] \
                 .map((o) => { try { return typeof o.constructor.constructor('return Deno')() } catch { return 'no' } }).join()";
    bench.put_script("climber", &["a"], "String", climb).await;
    assert_eq!(
        bench.ask("climber", array(vec![1_i32.into()])).await.value,
        "no,no,no,no,no".into()
    );
    let sites = "(v) => { try { Error.prepareStackTrace = (e, s) => s } catch {} const s = new Error('x').stack; \
                 return [].concat(s).map((o) => typeof o === 'object' && typeof o.getThis?.constructor).join() }";
    bench.put_script("frames", &["a"], "String", sites).await;
    let value = format!("{:?}", bench.ask("frames", 1_i32).await.value);
    assert!(!value.contains("function"), "{value}");
    let other = "(v) => { let got; const sites = { prepareStackTrace: (e, s) => { got = s } }; \
                 try { globalThis.Error = Object.assign(function () {}, sites); new TypeError('x').stack } catch {} \
                 return typeof got }";
    bench.put_script("impostor", &["a"], "String", other).await;
    assert_eq!(bench.ask("impostor", 1_i32).await.value, "undefined".into());
    // Setters on what all arrays inherit from disturb the script that has them, and no call after it.
    let setter = "Object.defineProperty(Array.prototype, 0, { set() { throw new Error('mine') } }); (v) => v";
    bench.put_script("setter", &["a"], "Double", setter).await;
    bench.feed("setter", "a", 1_i32).await;
    assert_eq!(bench.ask("neighbour", 1_i32).await.value, "undefined undefined 2".into());
    // Modules are asked for in vain.
    bench.put_script("import", &["a"], "String", "(v) => { import('fs'); return 'asked' }").await;
    assert_eq!(bench.ask("import", 1_i32).await.value, "asked".into());
    bench.stop().await;
}
