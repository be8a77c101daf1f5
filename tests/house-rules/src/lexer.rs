//! Lexer that separates code, comments and string literals line by line; the parser of syn drops
//! comments.

/// One source line in its three parts.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Line {
    pub(crate) code: String,
    /// Text of line, block and doc comments.
    pub(crate) comment: String,
    /// Content of string literals, without quotes and escapes.
    pub(crate) text: String,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Code,
    LineComment,
    /// Depth of nesting.
    BlockComment(usize),
    Text,
    /// Number of `#` that end the literal.
    RawText(usize),
}

/// Splits a source into its lines.
pub(crate) fn lines(source: &str) -> Vec<Line> {
    let characters: Vec<char> = source.chars().collect();
    let mut lines = vec![Line::default()];
    let mut state = State::Code;
    let mut at = 0;
    while let Some(&character) = characters.get(at) {
        let next = characters.get(at + 1).copied();
        let mut taken = 1;
        if character == '\n' {
            if state == State::LineComment {
                state = State::Code;
            }
            lines.push(Line::default());
            at += 1;
            continue;
        }
        let line = lines.last_mut().expect("there is a first line");
        match state {
            State::Code => match (character, next) {
                ('/', Some('/')) => {
                    state = State::LineComment;
                    taken = 2;
                }
                ('/', Some('*')) => {
                    state = State::BlockComment(1);
                    taken = 2;
                }
                ('"', _) => {
                    // Two literals of a line share no word.
                    line.text.push(' ');
                    state = State::Text;
                }
                ('\'', _) => taken = character_length(&characters[at..]),
                ('r', _) if let Some(hashes) = raw_text(&characters, at) => {
                    state = State::RawText(hashes);
                    taken = hashes + 2;
                }
                _ => line.code.push(character),
            },
            State::LineComment => line.comment.push(character),
            State::BlockComment(depth) => match (character, next) {
                ('/', Some('*')) => {
                    state = State::BlockComment(depth + 1);
                    taken = 2;
                }
                ('*', Some('/')) => {
                    state = if depth == 1 { State::Code } else { State::BlockComment(depth - 1) };
                    taken = 2;
                }
                _ => line.comment.push(character),
            },
            State::Text => match character {
                // An escaped line end still ends the line.
                '\\' if next != Some('\n') => {
                    line.text.push(' ');
                    taken = 2;
                }
                '"' => state = State::Code,
                _ => line.text.push(character),
            },
            State::RawText(hashes) => {
                let end = characters.get(at + 1..=at + hashes).unwrap_or_default();
                if character == '"' && end.len() == hashes && end.iter().all(|c| *c == '#') {
                    state = State::Code;
                    taken = hashes + 1;
                } else {
                    line.text.push(character);
                }
            }
        }
        at += taken;
    }
    lines
}

/// Returns the length of a character literal, or 1 for the apostrophe of a lifetime.
fn character_length(characters: &[char]) -> usize {
    match characters {
        ['\'', '\\', _, rest @ ..] => {
            rest.iter().position(|c| *c == '\'').map_or(1, |length| length + 4)
        }
        ['\'', _, '\'', ..] => 3,
        _ => 1,
    }
}

/// Returns the number of `#` when a raw string begins with the `r` at `at`.
fn raw_text(characters: &[char], at: usize) -> Option<usize> {
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let before = at.checked_sub(1).map(|before| characters[before]);
    // `br"..."` and `cr"..."` are strings as well; the `r` of an identifier begins none.
    if before.is_some_and(|c| is_name(c) && !matches!(c, 'b' | 'c')) {
        return None;
    }
    let hashes = characters[at + 1..].iter().take_while(|c| **c == '#').count();
    (characters.get(at + 1 + hashes) == Some(&'"')).then_some(hashes)
}
