//! Pages to print: self-contained HTML in English or German, black on white.

use std::fmt::Write as _;

use disclosure::Language;

const STYLE: &str = "body{font:10pt/1.4 sans-serif;color:#000;background:#fff;margin:2cm auto;max-width:27cm}\
    h1{font-size:16pt}h2{font-size:12pt}table{border-collapse:collapse;width:100%}\
    th,td{border-bottom:1px solid #999;padding:2px 6px;text-align:left;vertical-align:top}\
    thead{display:table-header-group}tr{break-inside:avoid}code{font-size:8pt;word-break:break-all}\
    @page{size:A4 landscape;margin:1.5cm}@media print{body{margin:0;max-width:none}}";

/// Returns the beginning of a page.
#[must_use]
pub fn begin(language: Language, title: &str) -> String {
    let title = escaped(title);
    format!(
        "<!doctype html>\n<html lang=\"{}\"><head><meta charset=\"utf-8\"><title>{title}</title><style>{STYLE}</style>\
         </head><body><h1>{title}</h1>\n",
        language.code()
    )
}

/// The end of a page.
pub const END: &str = "</body></html>\n";

/// Returns the beginning of a table with these headings.
#[must_use]
pub fn table(headings: &[&str]) -> String {
    let mut html = "<table><thead><tr>".to_owned();
    for heading in headings {
        html.push_str("<th>");
        html.push_str(&escaped(heading));
        html.push_str("</th>");
    }
    html.push_str("</tr></thead><tbody>\n");
    html
}

/// Returns a row of a table.
#[must_use]
pub fn row<S: AsRef<str>>(cells: impl IntoIterator<Item = S>) -> String {
    let mut html = "<tr>".to_owned();
    for cell in cells {
        // A String takes everything that is written to it.
        let _ = write!(html, "<td>{}</td>", escaped(cell.as_ref()));
    }
    html.push_str("</tr>\n");
    html
}

/// A table's end.
pub const TABLE_END: &str = "</tbody></table>\n";

/// Text as it stands in HTML.
#[must_use]
pub fn escaped(text: &str) -> String {
    let mut html = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => html.push_str("&amp;"),
            '<' => html.push_str("&lt;"),
            '>' => html.push_str("&gt;"),
            '"' => html.push_str("&quot;"),
            '\'' => html.push_str("&#39;"),
            other => html.push(other),
        }
    }
    html
}
