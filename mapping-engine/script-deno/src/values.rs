//! Values into the engine and out of it. `None` where the engine threw.

use std::sync::Arc;

use deno_core::v8;
use script_protocol::{FaultKind, ScriptFault, ScriptValue, Yielded, value::DEPTH_MAX};

/// Most elements of a list or record that a script returns.
const ELEMENTS_MAX: usize = 65_536;
/// Longest text that a script returns, in bytes.
const TEXT_BYTES_MAX: usize = 65_536;

type Scope<'s, 'i> = v8::PinScope<'s, 'i>;
type Value<'s> = v8::Local<'s, v8::Value>;

/// A value as the engine's own.
pub fn to_js<'s>(scope: &Scope<'s, '_>, value: &ScriptValue) -> Option<Value<'s>> {
    Some(match value {
        ScriptValue::Null => v8::null(scope).into(),
        ScriptValue::Boolean(v) => v8::Boolean::new(scope, *v).into(),
        ScriptValue::Number(v) => v8::Number::new(scope, *v).into(),
        ScriptValue::Signed(v) => v8::BigInt::new_from_i64(scope, *v).into(),
        ScriptValue::Unsigned(v) => v8::BigInt::new_from_u64(scope, *v).into(),
        ScriptValue::Text(v) => v8::String::new(scope, v)?.into(),
        ScriptValue::Time(ms) => v8::Date::new(scope, *ms)?.into(),
        ScriptValue::Bytes(v) => {
            let store = v8::ArrayBuffer::new_backing_store_from_vec(v.to_vec()).make_shared();
            let buffer = v8::ArrayBuffer::with_backing_store(scope, &store);
            v8::Uint8Array::new(scope, buffer, 0, v.len())?.into()
        }
        ScriptValue::List(values) => {
            let array = v8::Array::new(scope, i32::try_from(values.len()).ok()?);
            for (index, value) in values.iter().enumerate() {
                array.set_index(scope, u32::try_from(index).ok()?, to_js(scope, value)?)?;
            }
            array.into()
        }
        ScriptValue::Record(members) => {
            let object = v8::Object::new(scope);
            for (name, value) in members {
                let name = v8::String::new(scope, name)?;
                object.set(scope, name.into(), to_js(scope, value)?)?;
            }
            object.into()
        }
    })
}

/// Gets a member.
pub fn member<'s>(
    scope: &Scope<'s, '_>,
    object: v8::Local<'s, v8::Object>,
    name: &str,
) -> Option<Value<'s>> {
    let name = v8::String::new(scope, name)?;
    object.get(scope, name.into())
}

/// What a script returned.
pub fn yielded<'s>(
    scope: &Scope<'s, '_>,
    kind_of: v8::Local<'s, v8::Function>,
    result: Value<'s>,
) -> Option<Result<Yielded, ScriptFault>> {
    if result.is_undefined() {
        return Some(Ok(Yielded::Nothing));
    }
    let mut value = result;
    let mut status = 0;
    if let Some(object) = plain_object(value)
        && kind(scope, kind_of, value)? == "result"
    {
        let said = member(scope, object, "status")?;
        if !said.is_undefined() {
            let number = said.number_value(scope).filter(|_| said.is_number());
            match number.filter(|n| n.fract() == 0.0 && (0.0..=4_294_967_295.0).contains(n)) {
                #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
                Some(number) => status = number as u32,
                None => {
                    return Some(Err(wrong(
                        "\"status\" must be an OPC UA status code, a number from 0 to 2^32-1",
                    )));
                }
            }
        }
        value = member(scope, object, "value")?;
        if value.is_undefined() {
            return Some(Ok(Yielded::Nothing));
        }
    }
    let mut left = ELEMENTS_MAX;
    Some(
        from_js(scope, kind_of, value, 0, &mut left)?.map(|value| Yielded::Value { value, status }),
    )
}

fn plain_object<'s>(value: Value<'s>) -> Option<v8::Local<'s, v8::Object>> {
    let is_plain = value.is_object()
        && !(value.is_array()
            || value.is_function()
            || value.is_promise()
            || value.is_date()
            || value.is_uint8_array());
    if is_plain { v8::Local::try_from(value).ok() } else { None }
}

fn kind<'s>(
    scope: &Scope<'s, '_>,
    kind_of: v8::Local<'s, v8::Function>,
    value: Value<'s>,
) -> Option<String> {
    let undefined = v8::undefined(scope);
    Some(kind_of.call(scope, undefined.into(), &[value])?.to_rust_string_lossy(scope))
}

fn wrong(message: impl Into<Arc<str>>) -> ScriptFault {
    ScriptFault::new(FaultKind::Result, message)
}

type Converted = Option<Result<ScriptValue, ScriptFault>>;

fn from_js<'s>(
    scope: &Scope<'s, '_>,
    kind_of: v8::Local<'s, v8::Function>,
    value: Value<'s>,
    depth: usize,
    left: &mut usize,
) -> Converted {
    if depth > DEPTH_MAX || *left == 0 {
        let message = format!(
            "a result nests at most {DEPTH_MAX} deep and has at most {ELEMENTS_MAX} elements"
        );
        return Some(Err(wrong(message)));
    }
    *left -= 1;
    Some(Ok(if value.is_number() {
        ScriptValue::Number(value.number_value(scope)?)
    } else if value.is_boolean() {
        ScriptValue::Boolean(value.is_true())
    } else if value.is_null_or_undefined() {
        ScriptValue::Null
    } else if value.is_string() {
        let text = value.to_rust_string_lossy(scope);
        if text.len() > TEXT_BYTES_MAX {
            return Some(Err(wrong(format!("a text has at most {TEXT_BYTES_MAX} bytes"))));
        }
        ScriptValue::Text(text.into())
    } else if let Ok(big) = v8::Local::<v8::BigInt>::try_from(value) {
        match (big.i64_value(), big.u64_value()) {
            ((signed, true), _) => ScriptValue::Signed(signed),
            (_, (unsigned, true)) => ScriptValue::Unsigned(unsigned),
            _ => return Some(Err(wrong("the BigInt is beyond 64 bits"))),
        }
    } else if value.is_promise() {
        return Some(Err(wrong(
            "the script must return a value, not a promise: async functions do not work here",
        )));
    } else if let Ok(date) = v8::Local::<v8::Date>::try_from(value) {
        let ms = date.value_of();
        if ms.is_nan() {
            return Some(Err(wrong("the Date is invalid")));
        }
        ScriptValue::Time(ms)
    } else if let Ok(bytes) = v8::Local::<v8::Uint8Array>::try_from(value) {
        if bytes.byte_length() > TEXT_BYTES_MAX {
            return Some(Err(wrong(format!("a Uint8Array has at most {TEXT_BYTES_MAX} bytes"))));
        }
        let mut content = vec![0; bytes.byte_length()];
        bytes.copy_contents(&mut content);
        ScriptValue::Bytes(content.into())
    } else if let Ok(array) = v8::Local::<v8::Array>::try_from(value) {
        return list(scope, kind_of, array, depth, left);
    } else if value.is_object() && !value.is_function() {
        return record(scope, kind_of, v8::Local::try_from(value).ok()?, depth, left);
    } else {
        return Some(Err(wrong("a function or symbol is not a value")));
    }))
}

fn list<'s>(
    scope: &Scope<'s, '_>,
    kind_of: v8::Local<'s, v8::Function>,
    array: v8::Local<'s, v8::Array>,
    depth: usize,
    left: &mut usize,
) -> Converted {
    if usize::try_from(array.length()).unwrap_or(usize::MAX) > *left {
        return Some(Err(wrong(format!("a result has at most {ELEMENTS_MAX} elements"))));
    }
    let mut list = Vec::new();
    for index in 0..array.length() {
        match from_js(scope, kind_of, array.get_index(scope, index)?, depth + 1, left)? {
            Ok(value) => list.push(value),
            Err(fault) => return Some(Err(fault)),
        }
    }
    Some(Ok(ScriptValue::List(list)))
}

fn record<'s>(
    scope: &Scope<'s, '_>,
    kind_of: v8::Local<'s, v8::Function>,
    object: v8::Local<'s, v8::Object>,
    depth: usize,
    left: &mut usize,
) -> Converted {
    let names = object.get_own_property_names(scope, Default::default())?;
    let mut members = Vec::new();
    for index in 0..names.length() {
        let name = names.get_index(scope, index)?;
        let value = object.get(scope, name)?;
        match from_js(scope, kind_of, value, depth + 1, left)? {
            Ok(value) => members.push((name.to_rust_string_lossy(scope).into(), value)),
            Err(fault) => return Some(Err(fault)),
        }
    }
    Some(Ok(ScriptValue::Record(members)))
}
