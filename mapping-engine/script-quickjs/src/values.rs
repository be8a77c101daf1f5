//! Values of the protocol to QuickJS and back.

use rquickjs::{Array, BigInt, Ctx, Filter, Function, IntoJs, Object, TypedArray, Value};
use script_protocol::{
    ScriptValue, Yielded,
    worker::result::{self, ResultBudget},
};

use crate::fault::Failure;

/// Returns a value of the protocol as one of the engine.
///
/// # Errors
/// Those of the engine, above all memory that ran out.
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

/// Returns what a script yielded: nothing, a value, or the members of a result object.
///
/// # Errors
/// [`Failure::Engine`] where reading it threw, [`Failure::Fault`] for what is not a value.
pub fn yielded<'js>(tools: &Object<'js>, result: Value<'js>) -> Result<Yielded, Failure> {
    if result.is_undefined() {
        return Ok(Yielded::Nothing);
    }
    let mut value = result;
    let mut status = 0;
    if let Some(object) = value
        .as_object()
        .filter(|o| !o.is_array() && !o.is_function() && !o.as_value().is_promise())
        && kind(tools, object)? == "result"
    {
        let member: Value<'js> = object.get("status")?;
        if !member.is_undefined() {
            status = result::status(member.as_number())?;
        }
        value = object.get("value")?;
        if value.is_undefined() {
            return Ok(Yielded::Nothing);
        }
    }
    let value = Reader { tools, budget: ResultBudget::default() }.value(&value, 0)?;
    Ok(Yielded::Value { value, status })
}

fn kind<'js>(tools: &Object<'js>, object: &Object<'js>) -> rquickjs::Result<String> {
    tools.get::<_, Function<'js>>("kind")?.call((object.clone(),))
}

/// Reads one result within its limits.
struct Reader<'a, 'js> {
    tools: &'a Object<'js>,
    budget: ResultBudget,
}

impl<'js> Reader<'_, 'js> {
    fn value(&mut self, value: &Value<'js>, depth: usize) -> Result<ScriptValue, Failure> {
        self.budget.take(depth)?;
        if let Some(number) = value.as_number() {
            Ok(ScriptValue::Number(number))
        } else if let Some(boolean) = value.as_bool() {
            Ok(ScriptValue::Boolean(boolean))
        } else if value.is_null() || value.is_undefined() {
            Ok(ScriptValue::Null)
        } else if let Some(text) = value.as_string() {
            Ok(result::text(text.to_string()?)?)
        } else if let Some(big) = value.as_big_int() {
            self.big_int(big)
        } else if value.is_promise() {
            Err(result::promise().into())
        } else if let Some(array) = value.as_array() {
            self.list(array, depth)
        } else {
            match value.as_object() {
                Some(object) if !object.is_function() => self.object(object, depth),
                _ => Err(result::invalid(format!("a {} is not a value", value.type_name())).into()),
            }
        }
    }

    /// The engine has no way to read 64 bits without sign, but the same bits with it.
    fn big_int(&self, big: &BigInt<'js>) -> Result<ScriptValue, Failure> {
        let width: i32 = self.tools.get::<_, Function<'js>>("width")?.call((big.clone(),))?;
        let bits = big.clone().to_i64()?;
        match width {
            1 => Ok(ScriptValue::Signed(bits)),
            2 => Ok(ScriptValue::Unsigned(bits.cast_unsigned())),
            _ => Err(result::wide_big_int().into()),
        }
    }

    fn list(&mut self, array: &Array<'js>, depth: usize) -> Result<ScriptValue, Failure> {
        self.budget.check_list(array.len())?;
        let mut list = Vec::with_capacity(array.len());
        for element in array.iter::<Value<'js>>() {
            list.push(self.value(&element?, depth + 1)?);
        }
        Ok(ScriptValue::List(list))
    }

    fn object(&mut self, object: &Object<'js>, depth: usize) -> Result<ScriptValue, Failure> {
        match kind(self.tools, object)?.as_str() {
            "time" => {
                let time_of = self.tools.get::<_, Function<'js>>("timeOf")?;
                Ok(result::time(time_of.call((object.clone(),))?)?)
            }
            "bytes" => {
                let length: usize = object.get("length")?;
                result::check_bytes(length)?;
                let mut bytes = Vec::with_capacity(length);
                for index in 0..length {
                    bytes.push(object.get::<_, u8>(u32::try_from(index).unwrap_or(u32::MAX))?);
                }
                Ok(ScriptValue::Bytes(bytes.into()))
            }
            _ => {
                let mut members = Vec::new();
                let enumerable = Filter::new().string().enum_only();
                for member in object.own_props::<String, Value<'js>>(enumerable) {
                    let (name, value) = member?;
                    members.push((name.into(), self.value(&value, depth + 1)?));
                }
                Ok(ScriptValue::Record(members))
            }
        }
    }
}
