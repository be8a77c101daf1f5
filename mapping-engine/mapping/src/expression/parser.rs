//! Parser from tokens to a tree, by recursive descent with a bound on depth.

use super::{
    EXPRESSION_DEPTH_MAX, Expr, Name, Operator, SyntaxError, Value,
    functions::Builtin,
    lexer::{Token, tokens},
};

/// Parses an expression. `input` gives the position of an input by its name.
///
/// # Errors
/// [`SyntaxError`] at the first place that does not belong.
pub(crate) fn parse(
    text: &str,
    input: &dyn Fn(&str) -> Option<usize>,
) -> Result<Expr, SyntaxError> {
    let mut parser = Parser { tokens: tokens(text)?, at: 0, depth: 0, input };
    let expression = parser.choice()?;
    match parser.peek() {
        Token::End => Ok(expression),
        other => Err(parser.error(format!("{} does not belong here", other.describe()))),
    }
}

struct Parser<'a> {
    tokens: Vec<(Token, u32)>,
    at: usize,
    depth: usize,
    input: &'a dyn Fn(&str) -> Option<usize>,
}

type Parsed = Result<Expr, SyntaxError>;

impl Parser<'_> {
    fn peek(&self) -> &Token {
        // The last token is End and is never consumed.
        self.tokens.get(self.at).map_or(&Token::End, |(token, _)| token)
    }

    fn error(&self, message: impl Into<String>) -> SyntaxError {
        let column = self.tokens.get(self.at).map_or(1, |(_, column)| *column);
        SyntaxError { message: message.into(), column }
    }

    fn take(&mut self, symbol: &str) -> bool {
        let found = matches!(self.peek(), Token::Symbol(s) if *s == symbol);
        if found {
            self.at += 1;
        }
        found
    }

    fn expect(&mut self, symbol: &str) -> Result<(), SyntaxError> {
        if self.take(symbol) {
            return Ok(());
        }
        Err(self.error(format!("\"{symbol}\" is expected, but here is {}", self.peek().describe())))
    }

    fn one_of(&mut self, operators: &[(&str, Operator)]) -> Option<Operator> {
        let Token::Symbol(found) = self.peek() else { return None };
        let operator = operators.iter().find(|(symbol, _)| symbol == found)?.1;
        self.at += 1;
        Some(operator)
    }

    /// Every way down passes here.
    fn nested(&mut self, parse: impl FnOnce(&mut Self) -> Parsed) -> Parsed {
        if self.depth >= EXPRESSION_DEPTH_MAX {
            return Err(
                self.error(format!("an expression is nested at most {EXPRESSION_DEPTH_MAX} deep"))
            );
        }
        self.depth += 1;
        let result = parse(self);
        self.depth -= 1;
        result
    }

    fn choice(&mut self) -> Parsed {
        self.nested(|parser| {
            let condition = parser.or()?;
            if !parser.take("?") {
                return Ok(condition);
            }
            let yes = parser.choice()?;
            parser.expect(":")?;
            let no = parser.choice()?;
            Ok(Expr::Choice(condition.into(), yes.into(), no.into()))
        })
    }

    fn or(&mut self) -> Parsed {
        let mut left = self.and()?;
        while self.take("||") {
            left = Expr::Or(left.into(), self.and()?.into());
        }
        Ok(left)
    }

    fn and(&mut self) -> Parsed {
        let mut left = self.comparison()?;
        while self.take("&&") {
            left = Expr::And(left.into(), self.comparison()?.into());
        }
        Ok(left)
    }

    /// Comparisons do not chain: `a < b < c` is an error, not a surprise.
    fn comparison(&mut self) -> Parsed {
        use Operator as O;
        let left = self.sum()?;
        let operators = [
            ("==", O::Equal),
            ("!=", O::NotEqual),
            ("<=", O::LessOrEqual),
            (">=", O::GreaterOrEqual),
            ("<", O::Less),
            (">", O::Greater),
        ];
        match self.one_of(&operators) {
            Some(operator) => Ok(Expr::Binary(operator, left.into(), self.sum()?.into())),
            None => Ok(left),
        }
    }

    fn sum(&mut self) -> Parsed {
        let mut left = self.product()?;
        while let Some(operator) = self.one_of(&[("+", Operator::Add), ("-", Operator::Subtract)]) {
            left = Expr::Binary(operator, left.into(), self.product()?.into());
        }
        Ok(left)
    }

    fn product(&mut self) -> Parsed {
        use Operator as O;
        let operators =
            [("*", O::Multiply), ("/", O::Divide), ("//", O::FloorDivide), ("%", O::Modulo)];
        let mut left = self.unary()?;
        while let Some(operator) = self.one_of(&operators) {
            left = Expr::Binary(operator, left.into(), self.unary()?.into());
        }
        Ok(left)
    }

    fn unary(&mut self) -> Parsed {
        self.nested(|parser| {
            if parser.take("-") {
                return Ok(Expr::Negate(parser.unary()?.into()));
            }
            if parser.take("!") {
                return Ok(Expr::Not(parser.unary()?.into()));
            }
            if parser.take("+") {
                return parser.unary();
            }
            parser.power()
        })
    }

    /// Binds tighter than the sign before it, to the right: `-2 ** 2` is -4.
    fn power(&mut self) -> Parsed {
        let base = self.primary()?;
        if self.take("**") {
            let exponent = self.unary()?;
            return Ok(Expr::Call(Builtin::Pow, Box::new([base, exponent])));
        }
        Ok(base)
    }

    fn primary(&mut self) -> Parsed {
        let start = self.at;
        match self.peek().clone() {
            Token::Number(number) => {
                self.at += 1;
                Ok(Expr::Literal(Value::Number(number)))
            }
            Token::Text(text) => {
                self.at += 1;
                Ok(Expr::Literal(Value::Text(text)))
            }
            Token::Symbol("(") => {
                self.at += 1;
                let inner = self.choice()?;
                self.expect(")")?;
                Ok(inner)
            }
            Token::Name(name) => {
                self.at += 1;
                if self.take("(") { self.call(start, &name) } else { self.name(start, &name) }
            }
            other => {
                Err(self.error(format!("a value is expected, but here is {}", other.describe())))
            }
        }
    }

    fn name(&mut self, start: usize, name: &str) -> Parsed {
        match name {
            "true" => Ok(Expr::Literal(Value::Boolean(true))),
            "false" => Ok(Expr::Literal(Value::Boolean(false))),
            "value" => Ok(Expr::Name(Name::Value)),
            _ => match (self.input)(name) {
                Some(index) => Ok(Expr::Name(Name::Input(index))),
                None => {
                    self.at = start;
                    Err(self
                        .error(format!("\"{name}\" is neither \"value\" nor the name of an input")))
                }
            },
        }
    }

    fn call(&mut self, start: usize, name: &str) -> Parsed {
        let mut arguments = Vec::new();
        if !self.take(")") {
            loop {
                arguments.push(self.choice()?);
                if self.take(")") {
                    break;
                }
                self.expect(",")?;
            }
        }
        let Some(builtin) = Builtin::named(name) else {
            self.at = start;
            return Err(self.error(format!(
                "there is no function \"{name}\"; there are {}",
                Builtin::names()
            )));
        };
        let (least, most) = builtin.arity();
        if arguments.len() < least || arguments.len() > most {
            self.at = start;
            return Err(self.error(format!("\"{name}\" takes {}", arity_text(least, most))));
        }
        Ok(Expr::Call(builtin, arguments.into()))
    }
}

fn arity_text(least: usize, most: usize) -> String {
    match (least, most) {
        (1, 1) => "one argument".to_owned(),
        (least, usize::MAX) => format!("at least {least} arguments"),
        (least, most) if least == most => format!("{least} arguments"),
        (least, most) => format!("{least} to {most} arguments"),
    }
}
