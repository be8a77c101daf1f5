//! The JavaScript between a script and its worker: `ctx`, and the few questions that only
//! JavaScript can answer. The same for every engine.

/// Evaluates to an object of functions that an engine calls. Takes its intrinsics before any script
/// can touch them, and removes what scripts shall not have.
pub const PRELUDE: &str = r#"(() => {
  "use strict";
  const { parse, stringify } = JSON;
  const { asIntN, asUintN } = BigInt;
  const DateOf = Date, BytesOf = Uint8Array, BigIntOf = BigInt, ErrorOf = TypeError;
  const timeOf = Function.prototype.call.bind(Date.prototype.getTime);
  const names = Object.keys, hasOwn = Function.prototype.call.bind(Object.prototype.hasOwnProperty);

  let status = 0, time = null;
  const values = [], statuses = [], times = [];
  const inputs = Object.create(null);
  const date = (ms) => ms === null ? null : new DateOf(ms);
  const ctx = { state: undefined };
  Object.defineProperties(ctx, {
    inputs: { value: inputs, enumerable: true },
    status: { get: () => status, enumerable: true },
    sourceTimestamp: { get: () => date(time), enumerable: true },
  });
  Object.seal(ctx);

  const wide = (_, v) => typeof v === "bigint" ? { $bigint: `${v}` } : v;
  const narrow = (_, v) =>
    v !== null && typeof v === "object" && typeof v.$bigint === "string" ? BigIntOf(v.$bigint) : v;

  // No way back from text to code: a mapping's behaviour is what was checked.
  for (const f of [function () {}, function* () {}, async function () {}, async function* () {}])
    Object.defineProperty(Object.getPrototypeOf(f), "constructor", { value: undefined });
  for (const name of ["eval", "Function", "SharedArrayBuffer", "Atomics", "performance", "queueMicrotask", "WeakRef",
    "FinalizationRegistry", "gc", "print", "console", "std", "os", "scriptArgs", "navigator", "WebAssembly",
    "ShadowRealm", "Deno", "Intl", "Temporal"])
    delete globalThis[name];
  // Internals of V8's shims.
  for (const name of Object.getOwnPropertyNames(globalThis)) if (name.startsWith("__")) delete globalThis[name];

  return {
    define(index, name) {
      Object.defineProperty(inputs, name, {
        enumerable: true,
        value: Object.freeze(Object.defineProperties({}, {
          value: { get: () => values[index], enumerable: true },
          status: { get: () => statuses[index], enumerable: true },
          sourceTimestamp: { get: () => date(times[index] ?? null), enumerable: true },
        })),
      });
    },
    input(index, v, s, t) { values[index] = v; statuses[index] = s; times[index] = t; },
    valueOf(index) { return values[index]; },
    invoke(f, v, s, t) { status = s; time = t; return f(v, ctx); },
    invokeInput(f, i) { status = statuses[i] ?? 0; time = times[i] ?? null; return f(values[i], ctx); },
    restore(json) { ctx.state = parse(json, narrow); },
    state() {
      const s = ctx.state;
      if (s === undefined || s === null) return undefined;
      let json;
      try { json = stringify(s); } catch { json = stringify(s, wide); }
      if (json === undefined) throw new ErrorOf("ctx.state must be JSON: a function or symbol is not");
      return json;
    },
    date(ms) { return new DateOf(ms); },
    bytes(length) { return new BytesOf(length); },
    // 1: fits with sign, 2: fits without, 0: neither.
    width(v) { return asIntN(64, v) === v ? 1 : asUintN(64, v) === v ? 2 : 0; },
    // "time", "bytes", "result" or "record".
    kind(o) {
      try { timeOf(o); return "time"; } catch {}
      if (o instanceof BytesOf) return "bytes";
      return hasOwn(o, "value") && names(o).every((n) => n === "value" || n === "status") ? "result" : "record";
    },
    timeOf(o) { return timeOf(o); },
  };
})()"#;
