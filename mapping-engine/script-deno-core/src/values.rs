//! Values of the protocol to V8 and back. Functions return `None` where the engine threw.

use deno_core::v8;
use script_protocol::{
    ScriptFault, ScriptValue, Yielded,
    worker::result::{self, ResultBudget},
};

type Scope<'s, 'i> = v8::PinScope<'s, 'i>;
type Value<'s> = v8::Local<'s, v8::Value>;

/// Returns a value of the protocol as one of the engine.
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

/// Returns a member of an object, `undefined` where there is none.
pub fn member<'s>(
    scope: &Scope<'s, '_>,
    object: v8::Local<'s, v8::Object>,
    name: &str,
) -> Option<Value<'s>> {
    let name = v8::String::new(scope, name)?;
    object.get(scope, name.into())
}

/// Returns what a script yielded: nothing, a value, or the members of a result object.
pub fn yielded<'s>(
    scope: &Scope<'s, '_>,
    kind_of: v8::Local<'s, v8::Function>,
    returned: Value<'s>,
) -> Option<Result<Yielded, ScriptFault>> {
    if returned.is_undefined() {
        return Some(Ok(Yielded::Nothing));
    }
    let mut value = returned;
    let mut status = 0;
    if let Some(object) = plain_object(value)
        && kind(scope, kind_of, value)? == "result"
    {
        let member_value = member(scope, object, "status")?;
        if !member_value.is_undefined() {
            let number = member_value.number_value(scope).filter(|_| member_value.is_number());
            match result::status(number) {
                Ok(code) => status = code,
                Err(fault) => return Some(Err(fault)),
            }
        }
        value = member(scope, object, "value")?;
        if value.is_undefined() {
            return Some(Ok(Yielded::Nothing));
        }
    }
    let mut budget = ResultBudget::default();
    let value = from_js(scope, kind_of, value, 0, &mut budget)?;
    Some(value.map(|value| Yielded::Value { value, status }))
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

type Converted = Option<Result<ScriptValue, ScriptFault>>;

fn from_js<'s>(
    scope: &Scope<'s, '_>,
    kind_of: v8::Local<'s, v8::Function>,
    value: Value<'s>,
    depth: usize,
    budget: &mut ResultBudget,
) -> Converted {
    if let Err(fault) = budget.take(depth) {
        return Some(Err(fault));
    }
    Some(Ok(if value.is_number() {
        ScriptValue::Number(value.number_value(scope)?)
    } else if value.is_boolean() {
        ScriptValue::Boolean(value.is_true())
    } else if value.is_null_or_undefined() {
        ScriptValue::Null
    } else if value.is_string() {
        return Some(result::text(value.to_rust_string_lossy(scope)));
    } else if let Ok(big) = v8::Local::<v8::BigInt>::try_from(value) {
        match (big.i64_value(), big.u64_value()) {
            ((signed, true), _) => ScriptValue::Signed(signed),
            (_, (unsigned, true)) => ScriptValue::Unsigned(unsigned),
            _ => return Some(Err(result::wide_big_int())),
        }
    } else if value.is_promise() {
        return Some(Err(result::promise()));
    } else if let Ok(date) = v8::Local::<v8::Date>::try_from(value) {
        return Some(result::time(date.value_of()));
    } else if let Ok(bytes) = v8::Local::<v8::Uint8Array>::try_from(value) {
        if let Err(fault) = result::check_bytes(bytes.byte_length()) {
            return Some(Err(fault));
        }
        let mut content = vec![0; bytes.byte_length()];
        bytes.copy_contents(&mut content);
        ScriptValue::Bytes(content.into())
    } else if let Ok(array) = v8::Local::<v8::Array>::try_from(value) {
        return list(scope, kind_of, array, depth, budget);
    } else if value.is_object() && !value.is_function() {
        return record(scope, kind_of, v8::Local::try_from(value).ok()?, depth, budget);
    } else {
        return Some(Err(result::invalid("a function or symbol is not a value")));
    }))
}

fn list<'s>(
    scope: &Scope<'s, '_>,
    kind_of: v8::Local<'s, v8::Function>,
    array: v8::Local<'s, v8::Array>,
    depth: usize,
    budget: &mut ResultBudget,
) -> Converted {
    let length = usize::try_from(array.length()).unwrap_or(usize::MAX);
    if let Err(fault) = budget.check_list(length) {
        return Some(Err(fault));
    }
    let mut list = Vec::new();
    for index in 0..array.length() {
        match from_js(scope, kind_of, array.get_index(scope, index)?, depth + 1, budget)? {
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
    budget: &mut ResultBudget,
) -> Converted {
    let names = object.get_own_property_names(scope, Default::default())?;
    let mut members = Vec::new();
    for index in 0..names.length() {
        let name = names.get_index(scope, index)?;
        let value = object.get(scope, name)?;
        match from_js(scope, kind_of, value, depth + 1, budget)? {
            Ok(value) => members.push((name.to_rust_string_lossy(scope).into(), value)),
            Err(fault) => return Some(Err(fault)),
        }
    }
    Some(Ok(ScriptValue::Record(members)))
}
