//! Comma-separated values as RFC 4180 has them, and as spreadsheets write them where the comma is
//! the decimal sign.

/// Fault of a text that is not a table.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {message}")]
pub struct CsvError {
    /// The line of the file, from 1.
    pub line: usize,
    /// Sentence that names the fault.
    pub message: &'static str,
}

/// A row and the line it begins at.
pub(super) type Row = (usize, Vec<String>);

/// The rows of a text. The separator is the one that the first line has: `,` or `;` or a tabulator.
/// Empty lines are left out.
pub(super) fn read(text: &str) -> Result<Vec<Row>, CsvError> {
    // Spreadsheets begin with a byte order mark.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let separator = separator(text);
    let mut rows = Vec::new();
    let mut row = Vec::new();
    let mut field = String::new();
    let (mut line, mut begun) = (1, 1);
    let mut is_quoted = false;
    let mut chars = text.chars().peekable();
    loop {
        let c = chars.next();
        match c {
            Some('"') if field.is_empty() && !is_quoted => {
                quoted(&mut chars, &mut field, &mut line)?;
                is_quoted = true;
            }
            Some('\r') if chars.peek() == Some(&'\n') => {}
            Some('\n') | None => {
                let is_empty = row.is_empty() && field.is_empty() && !is_quoted;
                row.push(without_mark(std::mem::take(&mut field)));
                let full = std::mem::take(&mut row);
                if !is_empty {
                    rows.push((begun, full));
                }
                if c.is_none() {
                    return Ok(rows);
                }
                line += 1;
                begun = line;
                is_quoted = false;
            }
            Some(c) if c == separator => {
                row.push(without_mark(std::mem::take(&mut field)));
                is_quoted = false;
            }
            Some(_) if is_quoted => {
                return Err(CsvError { line, message: "text follows a closing quote" });
            }
            Some(c) => field.push(c),
        }
    }
}

fn separator(text: &str) -> char {
    let first = text.lines().next().unwrap_or_default();
    [';', '\t'].into_iter().find(|c| first.contains(*c) && !first.contains(',')).unwrap_or(',')
}

fn quoted(
    chars: &mut std::iter::Peekable<std::str::Chars<'_>>,
    field: &mut String,
    line: &mut usize,
) -> Result<(), CsvError> {
    let begun = *line;
    loop {
        match chars.next() {
            Some('"') if chars.next_if_eq(&'"').is_some() => field.push('"'),
            Some('"') => return Ok(()),
            Some(c) => {
                *line += usize::from(c == '\n');
                field.push(c);
            }
            None => return Err(CsvError { line: begun, message: "a quote is not closed" }),
        }
    }
}

/// Returns true for a cell that a spreadsheet would run as a formula, or that has the mark against that.
fn needs_mark(cell: &str) -> bool {
    let begin = cell.trim_start_matches([' ', '\u{a0}']);
    begin.starts_with(['=', '+', '-', '@', '\t', '\r', '\n', '\'', '＝', '＋', '－', '＠'])
        && cell.parse::<f64>().is_err()
}

/// Removes the apostrophe with which a cell is text to a spreadsheet.
fn without_mark(cell: String) -> String {
    match cell.strip_prefix('\'') {
        Some(rest) if needs_mark(rest) => rest.to_owned(),
        _ => cell,
    }
}

/// Writes a row in which no cell is taken for a formula: one that would be begins with an apostrophe, which
/// [`read`] removes again.
pub(super) fn write(to: &mut String, fields: &[&str]) {
    for (index, field) in fields.iter().enumerate() {
        if index > 0 {
            to.push(',');
        }
        let marked = needs_mark(field).then(|| format!("'{field}"));
        let field = &marked.as_deref().unwrap_or(field);
        let is_plain = !field.contains(['"', ',', ';', '\t', '\n', '\r']) && *field == field.trim();
        if is_plain && !(fields.len() == 1 && field.is_empty()) {
            to.push_str(field);
        } else {
            to.push('"');
            to.push_str(&field.replace('"', "\"\""));
            to.push('"');
        }
    }
    to.push_str("\r\n");
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::{collection::vec, prelude::*};

    #[test]
    fn tables_as_spreadsheets_write_them() {
        let fields = |text: &str| {
            read(text)
                .map(|rows| rows.into_iter().map(|(_, row)| row.join("|")).collect::<Vec<_>>())
        };
        assert_eq!(
            fields("\u{feff}a;b\r\n1,5;\"x;y\"\r\n"),
            Ok(vec!["a|b".into(), "1,5|x;y".into()])
        );
        assert_eq!(
            fields("a,b\n\n\"he said \"\"hi\"\"\",\"two\nlines\""),
            Ok(vec!["a|b".into(), "he said \"hi\"|two\nlines".into()])
        );
        assert_eq!(read("a\n\"b").map_err(|e| e.line), Err(2));
        assert_eq!(read("a\n\"b\"c").map_err(|e| e.line), Err(2));
        assert_eq!(
            read("a,b\n\"x\ny\",1\n2,3").expect("a table")[2].0,
            4,
            "lines are counted within quotes"
        );
    }

    #[test]
    fn no_cell_is_a_formula() {
        for (cell, written) in [
            ("=HYPERLINK(1)", "'=HYPERLINK(1)\r\n"),
            ("@SUM", "'@SUM\r\n"),
            (" +1+2", "' +1+2\r\n"),
            ("-1.5", "-1.5\r\n"),
            ("'quoted", "''quoted\r\n"),
        ] {
            let mut text = String::new();
            write(&mut text, &[cell]);
            assert_eq!(text, written);
            assert_eq!(read(&text).expect("a table")[0].1, [cell]);
        }
    }

    proptest! {
        #[test]
        fn rows_come_back(rows in vec(vec("[a-z\",;\\t\\r\\n ü='+@-]{0,8}", 3), 1..6)) {
            let mut text = String::from("h1,h2,h3\r\n");
            for row in &rows {
                write(&mut text, &row.iter().map(String::as_str).collect::<Vec<_>>());
            }
            let back: Vec<Vec<String>> = read(&text).expect("a table").into_iter().skip(1).map(|(_, row)| row).collect();
            prop_assert_eq!(back, rows);
        }

        #[test]
        fn no_text_makes_it_panic(text in "[a\",;\\n\\r]{0,40}") {
            let _ = read(&text);
        }
    }
}
