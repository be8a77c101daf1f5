//! Export of the ledger for people and their tools: JSON lines, CSV, or a page to print.

use std::collections::BTreeMap;

use asi_model::pubsub::unit_member;
use serde::Deserialize as _;
use serde_json::Value;

use disclosure::{Language, Statement};
use ledger::EventKind;

use crate::print::{END, TABLE_END, begin, row, table};

/// In which form.
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
    /// The media type.
    #[must_use]
    pub const fn media_type(self) -> &'static str {
        match self {
            Self::Jsonl => "application/jsonl; charset=utf-8",
            Self::Csv => "text/csv; charset=utf-8; header=present",
            Self::Html => "text/html; charset=utf-8",
        }
    }

    /// The usual ending of a file's name.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Jsonl => "jsonl",
            Self::Csv => "csv",
            Self::Html => "html",
        }
    }
}

/// An entry with everything around it that explains it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ExportedEntry {
    /// The hashed text.
    pub content: String,
    /// Its hash, hexadecimal.
    pub hash: String,
    /// The DataSetMessage that left, while it is kept.
    pub report: Option<String>,
    /// The message it left in.
    pub message_id: Option<String>,
    /// When the broker accepted it.
    pub sent_at: Option<String>,
    /// When the platform said that it holds it.
    pub delivered_at: Option<String>,
    /// How each consent named by the entry coarsens, by field: what the partner is told.
    pub precision: BTreeMap<String, Statement>,
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
    /// In this form; the language matters for pages to print.
    #[must_use]
    pub const fn new(format: ExportFormat, language: Language) -> Self {
        Self { format, language }
    }

    /// What stands before the first entry.
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

    /// One entry.
    #[must_use]
    pub fn entry(&self, entry: &ExportedEntry) -> String {
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

    /// What stands after the last entry.
    #[must_use]
    pub fn end(&self) -> String {
        match self.format {
            ExportFormat::Jsonl | ExportFormat::Csv => String::new(),
            ExportFormat::Html => format!("{TABLE_END}{END}"),
        }
    }
}

fn json_line(entry: &ExportedEntry) -> String {
    let report =
        entry.report.as_deref().and_then(|report| serde_json::from_str::<Value>(report).ok());
    let line = serde_json::json!({
        "entry": entry.content,
        "hash": entry.hash,
        "report": report,
        "messageId": entry.message_id,
        "sentAt": entry.sent_at,
        "deliveredAt": entry.delivered_at,
        "precision": entry.precision.iter().map(|(field, told)| (field, &told.statement)).collect::<BTreeMap<_, _>>(),
    });
    format!("{line}\n")
}

/// One row per value of a report, one for any other entry.
fn rows(
    exported: &ExportedEntry,
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
    let precision =
        |told: Option<&Statement>| told.map(|told| told.in_language(language)).unwrap_or_default();
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
                ("sentAt", _) => exported.sent_at.clone().unwrap_or_default(),
                ("deliveredAt", _) => exported.delivered_at.clone().unwrap_or_default(),
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

/// An event in words; one of a later version by its code.
fn said(event: &Value, language: Language) -> String {
    EventKind::deserialize(event)
        .map_or_else(|_| plain(event), |kind| kind.in_language(language).to_owned())
}

/// A JSON value as a person reads it: the body of a variant, texts without quotes.
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

/// A line of CSV after RFC 4180, in which no cell is taken for a formula.
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
    use super::*;
    use disclosure::DisclosurePolicy;

    fn queued(value: Value) -> ExportedEntry {
        let report = serde_json::json!({ "SequenceNumber": 4, "Payload": { "operationNetworkId": { "Type": 12, "Body": "n" },
            "operationId": { "Type": 12, "Body": "op" }, "dynamicDataRequestId": { "Type": 12, "Body": "R1" },
            "note": { "Type": 12, "Body": value }, "noteUnit": { "Type": 12, "Body": "PIECE" } } });
        ExportedEntry {
            content: r#"{"recipient":"acme","number":7,"recordedAt":"2026-11-21T10:00:00Z","event":"QUEUED","dataSetWriterId":1,"epoch":9,"firstSequence":4,"lastSequence":4,"values":"00ff","consents":{"note":2}}"#.to_owned(),
            hash: "ab".to_owned(),
            report: Some(report.to_string()),
            message_id: Some("m1".to_owned()),
            sent_at: Some("2026-11-21T10:00:01Z".to_owned()),
            delivered_at: None,
            precision: [("note".to_owned(), Statement::of(&DisclosurePolicy::default(), None))].into(),
        }
    }

    #[test]
    fn a_table_says_what_left_when_and_under_which_consent() {
        let csv = Exporter::new(ExportFormat::Csv, Language::En);
        let text = csv.begin("F") + &csv.entry(&queued("fine".into()));
        let lines: Vec<&str> = text.split("\r\n").collect();
        assert_eq!(
            lines,
            [
                "recipient,number,recordedAt,event,operationNetworkId,operationId,dynamicDataRequestId,field,value,unit,\
                 consent,precision,dataSetWriterId,epoch,firstSequence,lastSequence,messageId,sentAt,deliveredAt,hash",
                "acme,7,2026-11-21T10:00:00Z,QUEUED,n,op,R1,note,fine,PIECE,2,\"Every change, as it is.\",1,9,4,4,m1,\
                 2026-11-21T10:00:01Z,,ab",
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
