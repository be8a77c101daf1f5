//! Code of TypeScript, JavaScript and Svelte without its comments and string literals.

/// Kind of the text at a position.
#[derive(Clone, Copy, PartialEq, Eq)]
enum WebText {
    Code,
    LineComment,
    /// Comment that this text ends.
    BlockComment(&'static str),
    /// String literal that this quote ends.
    Quoted(char),
}

/// Returns the code of each line. A template literal counts as a string with all that is inside.
pub(crate) fn lines(source: &str) -> Vec<String> {
    let mut kind = WebText::Code;
    let mut lines = Vec::new();
    for line in source.lines() {
        // An apostrophe in the text of a page begins no string of several lines.
        if !matches!(kind, WebText::BlockComment(_) | WebText::Quoted('`')) {
            kind = WebText::Code;
        }
        let mut code = String::new();
        let mut rest = line;
        while let Some(character) = rest.chars().next() {
            let mut taken = character.len_utf8();
            match kind {
                WebText::Code if rest.starts_with("//") => kind = WebText::LineComment,
                WebText::Code if rest.starts_with("/*") => kind = WebText::BlockComment("*/"),
                WebText::Code if rest.starts_with("<!--") => kind = WebText::BlockComment("-->"),
                WebText::Code if matches!(character, '\'' | '"' | '`') => {
                    kind = WebText::Quoted(character);
                }
                WebText::Code => code.push(character),
                WebText::BlockComment(end) if rest.starts_with(end) => {
                    kind = WebText::Code;
                    taken = end.len();
                }
                WebText::Quoted(_) if character == '\\' => {
                    taken += rest[taken..].chars().next().map_or(0, char::len_utf8);
                }
                WebText::Quoted(quote) if character == quote => kind = WebText::Code,
                WebText::LineComment | WebText::BlockComment(_) | WebText::Quoted(_) => {}
            }
            rest = &rest[taken..];
        }
        lines.push(code);
    }
    lines
}
