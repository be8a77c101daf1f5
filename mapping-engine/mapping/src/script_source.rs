//! Static checks of a script's source text.

/// Longest source text, in bytes.
pub const SOURCE_BYTES_MAX: usize = 65_536;

/// # Errors
/// A sentence when the text cannot be a script.
pub(crate) fn check(source: &str) -> Result<(), String> {
    if source.trim().is_empty() {
        return Err("the script is empty: write a function as (value, ctx) => value".to_owned());
    }
    if source.len() > SOURCE_BYTES_MAX {
        return Err(format!("a script has at most {SOURCE_BYTES_MAX} bytes"));
    }
    if source.contains('\0') {
        return Err("a script has no NUL characters".to_owned());
    }
    Ok(())
}

/// Variables declared with `let` or `var` outside of any function: what they hold is lost when the
/// worker restarts. Line and column (from 1) of each, with a sentence.
pub(crate) fn closure_state(source: &str) -> Vec<(u32, u32, String)> {
    let mut found = Vec::new();
    let mut scanner = Scanner { rest: source, line: 1, column: 1, depth: 0, word: String::new() };
    while let Some((word, line, column)) = scanner.next_top_level_word() {
        if matches!(word.as_str(), "let" | "var") {
            let message = format!(
                "\"{word}\" outside of the function: its value is lost when the script's worker restarts; keep it in \
                 ctx.state"
            );
            found.push((line, column, message));
        }
    }
    found
}

/// Walks over words outside of brackets, skipping comments and texts. Regular expressions are not
/// told from divisions; a quote inside one can hide a word, which costs a warning and nothing else.
struct Scanner<'a> {
    rest: &'a str,
    line: u32,
    column: u32,
    depth: u32,
    word: String,
}

impl Scanner<'_> {
    fn next_top_level_word(&mut self) -> Option<(String, u32, u32)> {
        let mut start = (self.line, self.column);
        loop {
            let c = self.rest.chars().next();
            if c.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == '$') {
                if self.word.is_empty() {
                    start = (self.line, self.column);
                }
                self.word.extend(c);
                self.advance(c?);
                continue;
            }
            if !self.word.is_empty() {
                let word = std::mem::take(&mut self.word);
                if self.depth == 0 {
                    return Some((word, start.0, start.1));
                }
            }
            match c? {
                '/' if self.rest.starts_with("//") => self.skip_until("\n"),
                '/' if self.rest.starts_with("/*") => self.skip_until("*/"),
                quote @ ('\'' | '"' | '`') => self.skip_text(quote),
                open @ ('(' | '[' | '{') => {
                    self.depth += 1;
                    self.advance(open);
                }
                close @ (')' | ']' | '}') => {
                    self.depth = self.depth.saturating_sub(1);
                    self.advance(close);
                }
                other => self.advance(other),
            }
        }
    }

    fn advance(&mut self, c: char) {
        self.rest = &self.rest[c.len_utf8()..];
        if c == '\n' {
            self.line += 1;
            self.column = 1;
        } else {
            self.column += 1;
        }
    }

    fn skip_until(&mut self, end: &str) {
        let length = self.rest.find(end).map_or(self.rest.len(), |at| at + end.len());
        let skipped: Vec<char> = self.rest[..length].chars().collect();
        skipped.into_iter().for_each(|c| self.advance(c));
    }

    fn skip_text(&mut self, quote: char) {
        self.advance(quote);
        while let Some(c) = self.rest.chars().next() {
            self.advance(c);
            match (c, self.rest.chars().next()) {
                ('\\', Some(escaped)) => self.advance(escaped),
                (c, _) if c == quote => return,
                _ => {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn state_outside_of_the_function_is_seen() {
        for (source, expected) in [
            ("let n = 0;\n(value) => ++n", vec![(1, 1)]),
            (
                "// let x\nconst k = 2;\n  var m = [];\n(v) => { let inner = v; return inner }",
                vec![(3, 3)],
            ),
            ("(value, ctx) => { let n = 1; return n }", vec![]),
            ("'let x'; /* var y */ `let z`; (v) => v", vec![]),
            ("const letter = 1; (v) => v", vec![]),
            ("let", vec![(1, 1)]),
            ("'unterminated", vec![]),
        ] {
            let found: Vec<_> =
                closure_state(source).into_iter().map(|(line, column, _)| (line, column)).collect();
            assert_eq!(found, expected, "{source}");
        }
    }
}
