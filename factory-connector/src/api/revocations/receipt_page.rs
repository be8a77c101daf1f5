//! Receipt of a revocation as a page to print.

use disclosure::Language;
use ledger::Sequences;

use crate::{
    print::{END, TABLE_END, begin, escaped, row, table},
    store::StoredRevocation,
};

/// Returns a receipt as HTML, with signature and signed text.
#[must_use]
pub fn receipt_page(found: &StoredRevocation, language: Language) -> String {
    let say = |english, german| language.choose(english, german);
    let receipt = &found.receipt;
    let mut html = begin(language, say("Receipt of a revocation", "Beleg über einen Widerruf"));
    html.push_str(&table(&["", ""]));
    let nobody = say("the partner", "der Partner").to_owned();
    for (name, value) in [
        (say("Factory", "Fabrik"), receipt.factory_id.to_string()),
        (say("Revoked at (UTC)", "Widerrufen am (UTC)"), receipt.revoked_at.to_string()),
        (say("Revoked by", "Widerrufen von"), receipt.revoked_by.clone().unwrap_or(nobody)),
        (say("Reason", "Grund"), receipt.reason.clone().unwrap_or_default()),
        (say("Receipt", "Beleg"), receipt.revocation_id.clone()),
    ] {
        html.push_str(&row([name, &value]));
    }
    html.push_str(TABLE_END);
    html.push_str(&format!(
        "<h2>{}</h2>",
        say("Fields that no longer leave", "Felder, die nicht mehr hinausgehen")
    ));
    html.push_str(&table(&[
        say("Field", "Feld"),
        say("Consent that ended", "Beendete Einwilligung"),
    ]));
    for field in &receipt.fields {
        html.push_str(&row([field.field.to_string(), field.consent_version.to_string()]));
    }
    html.push_str(TABLE_END);
    html.push_str(&format!("<h2>{}</h2>", say("What had left", "Was hinausgegangen war")));
    html.push_str(&table(&[
        say("Request", "Anfrage"),
        say("Recipients", "Empfänger"),
        say("Writer, epoch", "Writer, Epoche"),
        say("Last delivered", "Zuletzt zugestellt"),
        say("Last sent", "Zuletzt gesendet"),
        say("On its way", "Unterwegs"),
        say("Taken back", "Zurückgenommen"),
    ]));
    let number =
        |number: Option<u32>| number.map_or_else(|| "–".to_owned(), |number| number.to_string());
    for writer in &receipt.writers {
        let recipients: Vec<&str> =
            writer.recipient_list.iter().map(asi_model::OrganisationId::as_str).collect();
        html.push_str(&row([
            writer.request.to_string(),
            recipients.join(", "),
            format!("{}, {}", writer.data_set_writer_id, writer.epoch),
            number(writer.last_delivered_sequence),
            number(writer.last_sent_sequence),
            ranges(&writer.in_flight),
            ranges(&writer.taken_back),
        ]));
    }
    html.push_str(TABLE_END);
    html.push_str(&format!(
        "<h2>{}</h2><p>Ed25519</p><p><code>{}</code></p><p>{}: <code>{}</code></p><p>{}: <code>{}</code></p>",
        say("Signature", "Signatur"),
        found.signature,
        say("Public key", "Öffentlicher Schlüssel"),
        found.public_key,
        say("Signed text", "Signierter Text"),
        escaped(&found.signed_text),
    ));
    html.push_str(END);
    html
}

fn ranges(ranges: &[Sequences]) -> String {
    if ranges.is_empty() {
        return "–".to_owned();
    }
    let texts: Vec<String> = ranges
        .iter()
        .map(|range| match range.first_sequence == range.last_sequence {
            true => range.first_sequence.to_string(),
            false => format!("{}–{}", range.first_sequence, range.last_sequence),
        })
        .collect();
    texts.join(", ")
}
