//! Values into the engine and out of it.

use std::sync::Arc;

use rquickjs::{Array, BigInt, Ctx, Filter, Function, IntoJs, Object, TypedArray, Value};
use script_protocol::{FaultKind, ScriptFault, ScriptValue, Yielded, value::DEPTH_MAX};

/// Most elements of a list or record that a script returns.
const ELEMENTS_MAX: usize = 65_536;
/// Longest text that a script returns, in bytes.
const TEXT_BYTES_MAX: usize = 65_536;

/// A value as the engine's own.
pub fn to_js<'js>(
    ctx: &Ctx<'js>,
    tools: &Object<'js>,
    value: &ScriptValue,
) -> rquickjs::Result<Value<'js>> {
    Ok(match value {
        ScriptValue::Null => Value::new_null(ctx.clone()),
        ScriptValue::Boolean(v) => Value::new_bool(ctx.clone(), *v),
        ScriptValue::Number(v) => Value::new_number(ctx.clone(), *v),
        ScriptValue::Signed(v) => BigInt::from_i64(ctx.clone(), *v)?.into_value(),
        ScriptValue::Unsigned(v) => BigInt::from_u64(ctx.clone(), *v)?.into_value(),
        ScriptValue::Text(v) => (&**v).into_js(ctx)?,
        ScriptValue::Time(ms) => tools.get::<_, Function<'js>>("date")?.call((*ms,))?,
        ScriptValue::Bytes(v) => TypedArray::<u8>::new_copy(ctx.clone(), v)?.into_value(),
        ScriptValue::List(values) => {
            let array = Array::new(ctx.clone())?;
            for (index, value) in values.iter().enumerate() {
                array.set(index, to_js(ctx, tools, value)?)?;
            }
            array.into_value()
        }
        ScriptValue::Record(members) => {
            let object = Object::new(ctx.clone())?;
            for (name, value) in members {
                object.set(&**name, to_js(ctx, tools, value)?)?;
            }
            object.into_value()
        }
    })
}

/// What a script returned. The outer error is what was thrown on the way (by a getter, say).
pub fn yielded<'js>(
    ctx: &Ctx<'js>,
    tools: &Object<'js>,
    result: Value<'js>,
) -> rquickjs::Result<Result<Yielded, ScriptFault>> {
    if result.is_undefined() {
        return Ok(Ok(Yielded::Nothing));
    }
    let mut value = result;
    let mut status = 0;
    if let Some(object) = value
        .as_object()
        .filter(|o| !o.is_array() && !o.is_function() && !o.as_value().is_promise())
        && kind(tools, object)? == "result"
    {
        let said: Value<'js> = object.get("status")?;
        if !said.is_undefined() {
            match said
                .as_number()
                .filter(|n| n.fract() == 0.0 && (0.0..=4_294_967_295.0).contains(n))
            {
                #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
                Some(number) => status = number as u32,
                None => {
                    return Ok(Err(wrong(
                        "\"status\" must be an OPC UA status code, a number from 0 to 2^32-1",
                    )));
                }
            }
        }
        value = object.get("value")?;
        if value.is_undefined() {
            return Ok(Ok(Yielded::Nothing));
        }
    }
    let mut left = ELEMENTS_MAX;
    Ok(from_js(ctx, tools, &value, 0, &mut left)?.map(|value| Yielded::Value { value, status }))
}

fn kind<'js>(tools: &Object<'js>, object: &Object<'js>) -> rquickjs::Result<String> {
    tools.get::<_, Function<'js>>("kind")?.call((object.clone(),))
}

fn wrong(message: impl Into<Arc<str>>) -> ScriptFault {
    ScriptFault::new(FaultKind::Result, message)
}

type Converted = rquickjs::Result<Result<ScriptValue, ScriptFault>>;

fn from_js<'js>(
    ctx: &Ctx<'js>,
    tools: &Object<'js>,
    value: &Value<'js>,
    depth: usize,
    left: &mut usize,
) -> Converted {
    if depth > DEPTH_MAX || *left == 0 {
        let message = format!(
            "a result nests at most {DEPTH_MAX} deep and has at most {ELEMENTS_MAX} elements"
        );
        return Ok(Err(wrong(message)));
    }
    *left -= 1;
    if let Some(number) = value.as_number() {
        return Ok(Ok(ScriptValue::Number(number)));
    }
    if let Some(boolean) = value.as_bool() {
        return Ok(Ok(ScriptValue::Boolean(boolean)));
    }
    if value.is_null() || value.is_undefined() {
        return Ok(Ok(ScriptValue::Null));
    }
    if let Some(text) = value.as_string() {
        let text = text.to_string()?;
        if text.len() > TEXT_BYTES_MAX {
            return Ok(Err(wrong(format!("a text has at most {TEXT_BYTES_MAX} bytes"))));
        }
        return Ok(Ok(ScriptValue::Text(text.into())));
    }
    if let Some(big) = value.as_big_int() {
        return big_int(tools, big);
    }
    if value.is_promise() {
        let message =
            "the script must return a value, not a promise: async functions do not work here";
        return Ok(Err(wrong(message)));
    }
    if let Some(array) = value.as_array() {
        if array.len() > *left {
            return Ok(Err(wrong(format!("a result has at most {ELEMENTS_MAX} elements"))));
        }
        let mut list = Vec::with_capacity(array.len());
        for element in array.iter::<Value<'js>>() {
            match from_js(ctx, tools, &element?, depth + 1, left)? {
                Ok(value) => list.push(value),
                Err(fault) => return Ok(Err(fault)),
            }
        }
        return Ok(Ok(ScriptValue::List(list)));
    }
    match value.as_object() {
        Some(object) if !object.is_function() => record(ctx, tools, object, depth, left),
        _ => Ok(Err(wrong(format!("a {} is not a value", value.type_name())))),
    }
}

/// There is no way to read 64 bits without sign but the same bits with it.
fn big_int<'js>(tools: &Object<'js>, big: &BigInt<'js>) -> Converted {
    let width: i32 = tools.get::<_, Function<'js>>("width")?.call((big.clone(),))?;
    let bits = big.clone().to_i64()?;
    Ok(match width {
        1 => Ok(ScriptValue::Signed(bits)),
        2 => Ok(ScriptValue::Unsigned(bits.cast_unsigned())),
        _ => Err(wrong("the BigInt is beyond 64 bits")),
    })
}

fn record<'js>(
    ctx: &Ctx<'js>,
    tools: &Object<'js>,
    object: &Object<'js>,
    depth: usize,
    left: &mut usize,
) -> Converted {
    match kind(tools, object)?.as_str() {
        "time" => {
            let ms: f64 = tools.get::<_, Function<'js>>("timeOf")?.call((object.clone(),))?;
            Ok(if ms.is_nan() {
                Err(wrong("the Date is invalid"))
            } else {
                Ok(ScriptValue::Time(ms))
            })
        }
        "bytes" => {
            let length: usize = object.get("length")?;
            if length > TEXT_BYTES_MAX {
                return Ok(Err(wrong(format!("a Uint8Array has at most {TEXT_BYTES_MAX} bytes"))));
            }
            let mut bytes = Vec::with_capacity(length);
            for index in 0..length {
                bytes.push(object.get::<_, u8>(u32::try_from(index).unwrap_or(u32::MAX))?);
            }
            Ok(Ok(ScriptValue::Bytes(bytes.into())))
        }
        _ => {
            let mut members = Vec::new();
            for member in object.own_props::<String, Value<'js>>(Filter::new().string().enum_only())
            {
                let (name, value) = member?;
                match from_js(ctx, tools, &value, depth + 1, left)? {
                    Ok(value) => members.push((name.into(), value)),
                    Err(fault) => return Ok(Err(fault)),
                }
            }
            Ok(Ok(ScriptValue::Record(members)))
        }
    }
}
