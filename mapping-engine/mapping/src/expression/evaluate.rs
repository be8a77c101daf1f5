//! Running an expression.

use std::cmp::Ordering;

use super::{
    Expr, Name, Operator, Value,
    functions::{TEXT_BYTES_MAX, floor_divide, modulo, overflow},
};
use crate::{fault::Fault, number::Number};

impl Expr {
    /// The value, with names looked up when they are met.
    ///
    /// # Errors
    /// A [`Fault`] for operands of the wrong kind, division by zero and overflow.
    pub fn evaluate(&self, lookup: &dyn Fn(Name) -> Result<Value, Fault>) -> Result<Value, Fault> {
        match self {
            Self::Literal(value) => Ok(value.clone()),
            Self::Name(name) => lookup(*name),
            Self::Negate(operand) => match operand.evaluate(lookup)? {
                Value::Number(number) => {
                    Number::ZERO.minus(number).map(Value::Number).ok_or_else(overflow)
                }
                other => {
                    Err(Fault::type_mismatch(format!("\"-\" takes a number, not {}", other.kind())))
                }
            },
            Self::Not(operand) => Ok(Value::Boolean(!boolean(operand, lookup, "!")?)),
            Self::And(a, b) => {
                Ok(Value::Boolean(boolean(a, lookup, "&&")? && boolean(b, lookup, "&&")?))
            }
            Self::Or(a, b) => {
                Ok(Value::Boolean(boolean(a, lookup, "||")? || boolean(b, lookup, "||")?))
            }
            Self::Choice(condition, yes, no) => {
                if boolean(condition, lookup, "?")? {
                    yes.evaluate(lookup)
                } else {
                    no.evaluate(lookup)
                }
            }
            Self::Binary(operator, ..) if operator.is_chained() => self.chained(lookup),
            Self::Binary(operator, a, b) => {
                binary(*operator, a.evaluate(lookup)?, b.evaluate(lookup)?)
            }
            Self::Call(builtin, arguments) => {
                let arguments: Vec<Value> =
                    arguments.iter().map(|a| a.evaluate(lookup)).collect::<Result<_, _>>()?;
                builtin.call(&arguments)
            }
        }
    }

    /// `a + b + c + ...` hangs to the left and may be as long as the text allows, so it is walked,
    /// not recursed into.
    fn chained(&self, lookup: &dyn Fn(Name) -> Result<Value, Fault>) -> Result<Value, Fault> {
        let mut pending = Vec::new();
        let mut leftmost = self;
        while let Self::Binary(operator, a, b) = leftmost
            && operator.is_chained()
        {
            pending.push((*operator, b));
            leftmost = a;
        }
        let mut value = leftmost.evaluate(lookup)?;
        while let Some((operator, operand)) = pending.pop() {
            value = binary(operator, value, operand.evaluate(lookup)?)?;
        }
        Ok(value)
    }
}

impl Operator {
    const fn is_chained(self) -> bool {
        matches!(
            self,
            Self::Add
                | Self::Subtract
                | Self::Multiply
                | Self::Divide
                | Self::FloorDivide
                | Self::Modulo
        )
    }
}

fn boolean(
    operand: &Expr,
    lookup: &dyn Fn(Name) -> Result<Value, Fault>,
    symbol: &str,
) -> Result<bool, Fault> {
    match operand.evaluate(lookup)? {
        Value::Boolean(v) => Ok(v),
        other => {
            Err(Fault::type_mismatch(format!("\"{symbol}\" takes a Boolean, not {}", other.kind())))
        }
    }
}

fn binary(operator: Operator, a: Value, b: Value) -> Result<Value, Fault> {
    use Operator as O;
    match (operator, &a, &b) {
        (O::Equal | O::NotEqual, ..) => {
            let equal = match (&a, &b) {
                (Value::Number(a), Value::Number(b)) => a == b,
                (Value::Boolean(a), Value::Boolean(b)) => a == b,
                (Value::Text(a), Value::Text(b)) => a == b,
                _ => return Err(different(&a, &b)),
            };
            Ok(Value::Boolean(equal == (operator == O::Equal)))
        }
        (O::Less | O::LessOrEqual | O::Greater | O::GreaterOrEqual, ..) => {
            let order = match (&a, &b) {
                (Value::Number(a), Value::Number(b)) => a.partial_cmp(b),
                (Value::Text(a), Value::Text(b)) => Some(a.cmp(b)),
                _ => return Err(different(&a, &b)),
            };
            Ok(Value::Boolean(order.is_some_and(|order| holds(operator, order))))
        }
        (O::Add, Value::Text(a), Value::Text(b)) => {
            if a.len() + b.len() > TEXT_BYTES_MAX {
                return Err(Fault::out_of_range(format!(
                    "a text has at most {TEXT_BYTES_MAX} bytes"
                )));
            }
            Ok(Value::Text(format!("{a}{b}").into()))
        }
        (_, Value::Number(a), Value::Number(b)) => arithmetic(operator, *a, *b).map(Value::Number),
        _ if operator == O::Add => Err(different(&a, &b)),
        (_, Value::Number(_), other) | (_, other, _) => {
            Err(Fault::type_mismatch(format!("arithmetic takes numbers, not {}", other.kind())))
        }
    }
}

fn different(a: &Value, b: &Value) -> Fault {
    Fault::type_mismatch(format!(
        "{} and {} do not go together: use text() or number()",
        a.kind(),
        b.kind()
    ))
}

fn holds(operator: Operator, order: Ordering) -> bool {
    match operator {
        Operator::Less => order == Ordering::Less,
        Operator::LessOrEqual => order != Ordering::Greater,
        Operator::Greater => order == Ordering::Greater,
        _ => order != Ordering::Less,
    }
}

fn arithmetic(operator: Operator, a: Number, b: Number) -> Result<Number, Fault> {
    match operator {
        Operator::Add => a.plus(b).ok_or_else(overflow),
        Operator::Subtract => a.minus(b).ok_or_else(overflow),
        Operator::Multiply => a.times(b).ok_or_else(overflow),
        Operator::Divide => a.divided_by(b).ok_or_else(|| Fault::out_of_range("division by zero")),
        Operator::FloorDivide => floor_divide(a, b),
        _ => modulo(a, b),
    }
}
