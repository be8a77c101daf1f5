//! Export of the ledger for people and their tools: JSON lines, CSV, or a page to print.

use std::collections::BTreeMap;

use asi_model::{DateTime, pubsub::unit_member};
use disclosure::{Language, Statement};
use ledger::EventKind;
use serde::Deserialize as _;
use serde_json::Value;

use crate::{
    print::{END, TABLE_END, begin, row, table},
    store::LedgerRow,
};

/// Form of an export.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum ExportFormat {
    /// One JSON object per line: the exact hashed text with its hash, and the values that left.
    Jsonl,
    /// A table for spreadsheets: one line per value, and one per other entry.
    Csv,
    /// A page to print.
    Html,
}

impl ExportFormat {
    /// Returns the media type.
    #[must_use]
    pub const fn media_type(self) -> &'static str {
        match self {
            Self::Jsonl => "application/jsonl; charset=utf-8",
            Self::Csv => "text/csv; charset=utf-8; header=present",
            Self::Html => "text/html; charset=utf-8",
        }
    }

    /// Returns the usual extension of a file's name.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Jsonl => "jsonl",
            Self::Csv => "csv",
            Self::Html => "html",
        }
    }
}

const COLUMNS: [(&str, &str, &str); 20] = [
    ("recipient", "Recipient", "Empfänger"),
    ("number", "No.", "Nr."),
    ("recordedAt", "Recorded (UTC)", "Eingetragen (UTC)"),
    ("event", "Event", "Ereignis"),
    ("operationNetworkId", "Network", "Netz"),
    ("operationId", "Operation", "Operation"),
    ("dynamicDataRequestId", "Request", "Anfrage"),
    ("field", "Field", "Feld"),
    ("value", "Value", "Wert"),
    ("unit", "Unit", "Einheit"),
    ("consent", "Consent", "Einwilligung"),
    ("precision", "Precision", "Genauigkeit"),
    ("dataSetWriterId", "Writer", "Writer"),
    ("epoch", "Epoch", "Epoche"),
    ("firstSequence", "From", "Von"),
    ("lastSequence", "To", "Bis"),
    ("messageId", "Message", "Nachricht"),
    ("sentAt", "Sent (UTC)", "Gesendet (UTC)"),
    ("deliveredAt", "Delivered (UTC)", "Zugestellt (UTC)"),
    ("hash", "Hash", "Hash"),
];

/// Writes entries one after another.
#[derive(Debug, Clone, Copy)]
pub struct Exporter {
    format: ExportFormat,
    language: Language,
}

impl Exporter {
    /// Exports in this form; the language matters for pages to print only.
    #[must_use]
    pub const fn new(format: ExportFormat, language: Language) -> Self {
        Self { format, language }
    }

    /// Writes the head before the first entry.
    #[must_use]
    pub fn begin(&self, factory: &str) -> String {
        match self.format {
            ExportFormat::Jsonl => String::new(),
            ExportFormat::Csv => csv_line(COLUMNS.iter().map(|(name, ..)| (*name).to_owned())),
            ExportFormat::Html => {
                let title =
                    self.language.choose("Ledger of what left", "Verzeichnis des Hinausgegangenen");
                let headings: Vec<&str> = COLUMNS
                    .iter()
                    .map(|(_, english, german)| self.language.choose(english, german))
                    .collect();
                begin(self.language, &format!("{title}: {factory}")) + &table(&headings)
            }
        }
    }

    /// Returns an entry as one line of JSON or CSV, or as one row of the HTML table.
    #[must_use]
    pub fn entry(&self, entry: &LedgerRow) -> String {
        match self.format {
            ExportFormat::Jsonl => json_line(entry),
            ExportFormat::Csv => {
                rows(entry, Language::En, plain).into_iter().map(csv_line).collect()
            }
            ExportFormat::Html => rows(entry, self.language, |event| said(event, self.language))
                .into_iter()
                .map(row)
                .collect(),
        }
    }

    /// Writes the end after the last entry.
    #[must_use]
    pub fn end(&self) -> String {
        match self.format {
            ExportFormat::Jsonl | ExportFormat::Csv => String::new(),
            ExportFormat::Html => format!("{TABLE_END}{END}"),
        }
    }
}

fn json_line(entry: &LedgerRow) -> String {
    let report =
        entry.report.as_deref().and_then(|report| serde_json::from_str::<Value>(report).ok());
    let precision: BTreeMap<&String, &String> =
        entry.precision.iter().map(|(field, precision)| (field, &precision.statement)).collect();
    let line = serde_json::json!({
        "entry": entry.content,
        "hash": entry.hash,
        "report": report,
        "messageId": entry.message_id,
        "sentAt": entry.sent_at.map(|at| at.to_string()),
        "deliveredAt": entry.delivered_at.map(|at| at.to_string()),
        "precision": precision,
    });
    format!("{line}\n")
}

/// Returns one row per value of a report, one for any other entry.
fn rows(
    exported: &LedgerRow,
    language: Language,
    event: impl Fn(&Value) -> String,
) -> Vec<Vec<String>> {
    let entry: Value = serde_json::from_str(&exported.content).unwrap_or_default();
    let report: Value = exported
        .report
        .as_deref()
        .and_then(|report| serde_json::from_str(report).ok())
        .unwrap_or_default();
    let payload = &report["Payload"];
    let precision = |statement: Option<&Statement>| {
        statement.map(|statement| statement.in_language(language)).unwrap_or_default()
    };
    let time = |at: Option<DateTime>| at.map(|at| at.to_string()).unwrap_or_default();
    let of_row = |field: Option<&str>| -> Vec<String> {
        COLUMNS
            .iter()
            .map(|(name, ..)| match (*name, field) {
                ("field", Some(field)) => field.to_owned(),
                ("value", Some(field)) => plain(&payload[field]),
                ("unit", Some(field)) => plain(&payload[unit_member(field)]),
                ("consent", Some(field)) => plain(&entry["consents"][field]),
                ("precision", Some(field)) => precision(exported.precision.get(field)),
                ("operationNetworkId" | "operationId" | "dynamicDataRequestId", Some(_)) => {
                    plain(&payload[*name])
                }
                ("operationNetworkId" | "operationId" | "dynamicDataRequestId", None) => {
                    plain(&entry["field"][*name])
                }
                ("field", None) => plain(&entry["field"]["fieldName"]),
                ("value", None) => plain(&entry["mappingState"]),
                ("consent", None) => plain(&entry["version"]),
                ("precision", None) => precision(exported.precision.values().next()),
                ("messageId", _) => {
                    exported.message_id.clone().unwrap_or_else(|| plain(&entry["messageId"]))
                }
                ("sentAt", _) => time(exported.sent_at),
                ("deliveredAt", _) => time(exported.delivered_at),
                ("hash", _) => exported.hash.clone(),
                ("event", _) => event(&entry["event"]),
                (name, _) => plain(&entry[name]),
            })
            .collect()
    };
    let fields: Vec<&String> =
        entry["consents"].as_object().map(|fields| fields.keys().collect()).unwrap_or_default();
    if fields.is_empty() {
        vec![of_row(None)]
    } else {
        fields.into_iter().map(|field| of_row(Some(field))).collect()
    }
}

/// Names an event in words; one of a later version by its code.
fn said(event: &Value, language: Language) -> String {
    EventKind::deserialize(event)
        .map_or_else(|_| plain(event), |kind| kind.in_language(language).to_owned())
}

/// Writes a JSON value as a person reads it: the body of a variant, texts without quotes.
fn plain(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Object(members) => match members.get("Body").or_else(|| members.get("Value")) {
            Some(body) => plain(body),
            None => value.to_string(),
        },
        other => other.to_string(),
    }
}

/// Writes a line of CSV after RFC 4180, in which no cell is taken for a formula.
fn csv_line(cells: impl IntoIterator<Item = String>) -> String {
    let cells: Vec<String> = cells.into_iter().map(|cell| quoted(&harmless(cell))).collect();
    cells.join(",") + "\r\n"
}

/// Spreadsheets run what begins like a formula; a leading apostrophe makes it text. Numbers stay
/// numbers.
fn harmless(cell: String) -> String {
    let is_formula = cell
        .trim_start_matches([' ', '\u{a0}'])
        .starts_with(['=', '+', '-', '@', '\t', '\r', '\n', '＝', '＋', '－', '＠']);
    if is_formula && cell.parse::<f64>().is_err() { format!("'{cell}") } else { cell }
}

fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\r', '\n', '\t', ';', '\'']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use disclosure::DisclosurePolicy;

    use super::*;

    fn queued(value: Value) -> LedgerRow {
        let report = serde_json::json!({
            "SequenceNumber": 4,
            "Payload": {
                "operationNetworkId": { "Type": 12, "Body": "n" },
                "operationId": { "Type": 12, "Body": "op" },
                "dynamicDataRequestId": { "Type": 12, "Body": "R1" },
                "note": { "Type": 12, "Body": value },
                "noteUnit": { "Type": 12, "Body": "PIECE" },
            },
        });
        LedgerRow {
            number: 7,
            content: [
                r#"{"recipient":"acme","number":7,"recordedAt":"2026-11-21T10:00:00Z","#,
                r#""event":"QUEUED","dataSetWriterId":1,"epoch":9,"firstSequence":4,"#,
                r#""lastSequence":4,"values":"00ff","consents":{"note":2}}"#,
            ]
            .concat(),
            hash: "ab".to_owned(),
            report: Some(report.to_string()),
            message_id: Some("m1".to_owned()),
            sent_at: Some("2026-11-21T10:00:01Z".parse().expect("a time")),
            delivered_at: None,
            precision: [("note".to_owned(), Statement::of(&DisclosurePolicy::default(), None))]
                .into(),
            basis: None,
        }
    }

    #[test]
    fn a_table_has_value_time_and_consent_of_each_report() {
        let csv = Exporter::new(ExportFormat::Csv, Language::En);
        let text = csv.begin("F") + &csv.entry(&queued("fine".into()));
        let lines: Vec<&str> = text.split("\r\n").collect();
        assert_eq!(
            lines,
            [
                "recipient,number,recordedAt,event,operationNetworkId,operationId,\
                 dynamicDataRequestId,field,value,unit,consent,precision,dataSetWriterId,epoch,\
                 firstSequence,lastSequence,messageId,sentAt,deliveredAt,hash",
                "acme,7,2026-11-21T10:00:00Z,QUEUED,n,op,R1,note,fine,PIECE,2,\
                 \"Every change, as it is.\",1,9,4,4,m1,2026-11-21T10:00:01Z,,ab",
                "",
            ]
        );
    }

    #[test]
    fn no_cell_is_a_formula() {
        let check =
            |value: &str, expected: &str| assert_eq!(quoted(&harmless(value.to_owned())), expected);
        check("=HYPERLINK(\"http://evil\")", "\"'=HYPERLINK(\"\"http://evil\"\")\"");
        check("+1+cmd|' /C calc'!A0", "\"'+1+cmd|' /C calc'!A0\"");
        check("@SUM(1)", "\"'@SUM(1)\"");
        check("  =1+1", "\"'  =1+1\"");
        check("\t=1", "\"'\t=1\"");
        check("-5", "-5");
        check("-5.25e3", "-5.25e3");
        check("-5+2", "\"'-5+2\"");
        check("a=b", "a=b");
    }

    #[test]
    fn pages_show_markup_as_text() {
        let html = Exporter::new(ExportFormat::Html, Language::De);
        let page = html.begin("F")
            + &html.entry(&queued("<script>alert(1)</script>".into()))
            + &html.end();
        assert!(page.contains("&lt;script&gt;") && !page.contains("<script"), "{page}");
        assert!(
            page.contains("Empfänger")
                && page.contains("Eingereiht")
                && !page.contains("QUEUED")
                && page.contains("Jede Änderung, wie sie ist.")
                && page.ends_with("</html>\n")
        );
    }

    #[test]
    fn a_line_carries_the_exact_hashed_text() {
        let entry = queued("fine".into());
        let line: Value =
            serde_json::from_str(&Exporter::new(ExportFormat::Jsonl, Language::En).entry(&entry))
                .expect("JSON");
        assert_eq!(line["entry"], Value::from(entry.content));
        assert_eq!(line["report"]["Payload"]["note"]["Body"], "fine");
    }
}
