//! A small expression language, so that most arithmetic needs no script.
//!
//! Values are numbers (exact integers or doubles), Booleans and texts. There are no loops and no
//! assignments, so an expression always ends. Grammar, weakest first: `c ? a : b`, `||`, `&&`, `==
//! != < <= > >=`, `+ -`, `* / // %`, unary `- + !`, call, literal, name, parentheses.

mod evaluate;
mod functions;
mod lexer;
mod parser;
mod value;

pub(crate) use parser::parse;
pub(crate) use value::{ResultKind, Value};

/// Longest expression, in bytes.
pub const EXPRESSION_BYTES_MAX: usize = 4096;
/// Deepest nesting.
pub const EXPRESSION_DEPTH_MAX: usize = 64;

/// Syntax fault, with the column (in characters, from 1) where the text stops being an expression.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message} (column {column})")]
pub(crate) struct SyntaxError {
    pub message: String,
    pub column: u32,
}

/// A parsed expression; names are resolved.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Expr {
    Literal(Value),
    Name(Name),
    Negate(Box<Expr>),
    Not(Box<Expr>),
    Binary(Operator, Box<Expr>, Box<Expr>),
    And(Box<Expr>, Box<Expr>),
    Or(Box<Expr>, Box<Expr>),
    Choice(Box<Expr>, Box<Expr>, Box<Expr>),
    Call(functions::Builtin, Box<[Expr]>),
}

/// Operand that a name refers to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Name {
    Value,
    /// An input, by its position.
    Input(usize),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    FloorDivide,
    Modulo,
    Equal,
    NotEqual,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
}

/// The inputs that an expression reads, and whether it reads `value`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Names {
    pub value: bool,
    pub inputs: Vec<usize>,
}

impl Expr {
    /// Returns the names that it reads.
    pub fn names(&self) -> Names {
        let mut names = Names::default();
        self.collect(&mut names);
        names
    }

    fn collect(&self, names: &mut Names) {
        match self {
            Self::Literal(_) => {}
            Self::Name(Name::Value) => names.value = true,
            Self::Name(Name::Input(index)) => {
                if !names.inputs.contains(index) {
                    names.inputs.push(*index);
                }
            }
            Self::Negate(a) | Self::Not(a) => a.collect(names),
            Self::Binary(_, a, b) | Self::And(a, b) | Self::Or(a, b) => {
                a.collect(names);
                b.collect(names);
            }
            Self::Choice(a, b, c) => [a, b, c].into_iter().for_each(|e| e.collect(names)),
            Self::Call(_, arguments) => arguments.iter().for_each(|e| e.collect(names)),
        }
    }

    /// The kind of value it yields where that can be said beforehand.
    pub fn result(&self) -> Option<ResultKind> {
        use ResultKind as K;
        match self {
            Self::Literal(Value::Number(_)) | Self::Negate(_) => Some(K::Number),
            Self::Literal(Value::Boolean(_)) | Self::Not(_) | Self::And(..) | Self::Or(..) => {
                Some(K::Boolean)
            }
            Self::Literal(Value::Text(_)) => Some(K::Text),
            Self::Name(_) => None,
            Self::Binary(Operator::Add, a, b) => match (a.result(), b.result()) {
                (Some(K::Text), _) | (_, Some(K::Text)) => Some(K::Text),
                (Some(K::Number), Some(K::Number)) => Some(K::Number),
                _ => None,
            },
            Self::Binary(
                Operator::Subtract
                | Operator::Multiply
                | Operator::Divide
                | Operator::FloorDivide
                | Operator::Modulo,
                ..,
            ) => Some(K::Number),
            Self::Binary(..) => Some(K::Boolean),
            Self::Choice(_, a, b) => a.result().filter(|kind| b.result() == Some(*kind)),
            Self::Call(builtin, _) => Some(builtin.result()),
        }
    }
}

#[cfg(test)]
mod tests {
    use asi_model::Variant;

    use super::*;
    use crate::number::Number;
    use proptest::prelude::*;

    fn run(text: &str, value: &Variant, inputs: &[Variant]) -> Result<Variant, String> {
        let names = ["a", "b"];
        let expression = parse(text, &|name| names.iter().position(|n| *n == name))
            .map_err(|e| e.to_string())?;
        let lookup = |name| match name {
            Name::Value => Value::of(value),
            Name::Input(index) => Value::of(&inputs[index]),
        };
        expression.evaluate(&lookup).map(Value::into_variant).map_err(|e| e.message.to_string())
    }

    #[test]
    fn expressions_yield() {
        let inputs = [Variant::from(u64::MAX), Variant::from("pcs")];
        for (text, expected) in [
            ("1 + 2 * 3", Variant::from(7_i64)),
            ("(1 + 2) * 3", 9_i64.into()),
            ("a - 1", (u64::MAX - 1).into()),
            ("a / 5 * 5 == a", true.into()),
            ("7 / 2", 3.5.into()),
            ("-7 // 2", (-4_i64).into()),
            ("-7 % 3", 2_i64.into()),
            ("value * 0.5", 5.0.into()),
            ("value >= 10 && value < 11 ? 'hot' : \"cold\"", "hot".into()),
            ("false && (1/0 > 1)", false.into()),
            ("text(value) + ' ' + upper(b)", "10 PCS".into()),
            ("max(1, value, 3)", 10_i64.into()),
            ("round(2.675, 2)", 2.68.into()),
            ("round(value / 3)", 3_i64.into()),
            ("clamp(value, 0, 5)", 5_i64.into()),
            ("bit(value, 1)", true.into()),
            ("length(b)", 3_i64.into()),
            ("number('12') + 1", 13_i64.into()),
            ("!(1 == 1.0)", false.into()),
            ("2 ** 3", 8_i64.into()),
            ("-2 ** 2", (-4_i64).into()),
            ("1e3 + 0x10", 1016.0.into()),
            ("sqrt(16)", 4.0.into()),
        ] {
            assert_eq!(run(text, &10_i32.into(), &inputs), Ok(expected), "{text}");
        }
    }

    #[test]
    fn wrong_text_is_pointed_at() {
        for (text, column) in [
            ("", 1),
            ("1 +", 4),
            ("1 + * 2", 5),
            ("foo + 1", 1),
            ("min()", 1),
            ("nope(1)", 1),
            ("'abc", 1),
            ("1 2", 3),
            ("(1", 3),
            ("a ? 1", 6),
            ("ä", 1),
            ("1 < 2 < 3", 7),
        ] {
            let error = parse(text, &|name| (name == "a").then_some(0)).expect_err(text);
            assert_eq!(error.column, column, "{text}: {error}");
        }
        assert!(parse(&"(".repeat(5000), &|_| None).is_err());
        assert!(parse(&"-".repeat(4000), &|_| None).is_err());
        assert!(parse(&format!("1{}", "+1".repeat(2000)), &|_| None).is_ok(), "long but flat");
    }

    #[test]
    fn wrong_values_are_faults() {
        for text in [
            "1 / 0",
            "1 % 0",
            "b + 1 > 2",
            "b * 2",
            "!1",
            "1 && true",
            "number(b)",
            "a * a * a * a",
            "sqrt(0-1)",
        ] {
            let inputs = [Variant::from(u64::MAX), Variant::from("pcs")];
            assert!(run(text, &1_i32.into(), &inputs).is_err(), "{text}");
        }
        assert!(run("value", &Variant::Null, &[]).is_err());
    }

    proptest! {
        #[test]
        fn no_text_makes_it_panic(text in "[-+*/%()?:<>=!&|'\" .,0-9a-z]{0,64}") {
            let _ = run(&text, &1_i32.into(), &[Variant::from(2_i32), Variant::from("x")]);
        }

        #[test]
        fn arithmetic_is_that_of_i128(a in any::<i64>(), b in any::<i64>()) {
            let inputs = [Variant::from(a), Variant::from(b)];
            let expected = Number::Integer(i128::from(a) + i128::from(b)).to_scalar();
            prop_assert_eq!(run("a + b", &Variant::Null, &inputs), Ok(expected.into()));
            let floor = if b == 0 { None } else { Some(i128::from(a).div_euclid(i128::from(b))) };
            if let Some(quotient) = floor.filter(|_| b > 0) {
                let expected = Number::Integer(quotient).to_scalar();
                prop_assert_eq!(run("a // b", &Variant::Null, &inputs), Ok(expected.into()));
            }
        }
    }
}
