//! Selection of entries by their subject, through indexes: a long chain is never read through.

use asi_model::{
    DateTime, DynamicDataRequestId, FieldName, OperationId, OperationNetworkId, OrganisationId,
};
use ledger::EventKind;
use sqlx::{QueryBuilder, Sqlite};

/// Conditions that entries meet; all entries by default.
#[derive(Debug, Clone, Default)]
pub struct LedgerFilter {
    /// Restricts to this recipient's chain.
    pub recipient: Option<OrganisationId>,
    /// Recorded at this time or later.
    pub from: Option<DateTime>,
    /// Recorded before this time.
    pub until: Option<DateTime>,
    /// Restricts to this kind of entry.
    pub kind: Option<EventKind>,
    /// Restricts to entries about this network, operation, request or field.
    pub subject: Option<LedgerSubject>,
}

/// Subject of entries: decisions about fields, the reports that carried them, and the further way
/// of those.
#[derive(Debug, Clone)]
pub struct LedgerSubject {
    pub operation_network_id: OperationNetworkId,
    /// One operation of the network.
    pub operation_id: Option<OperationId>,
    /// One request of the operation.
    pub dynamic_data_request_id: Option<DynamicDataRequestId>,
    /// One field of the request.
    pub field_name: Option<FieldName>,
}

/// Range of numbers and order of the entries.
#[derive(Debug, Clone, Copy)]
pub(super) enum EntryRange {
    /// Newest first, before this number.
    Before(i64),
    /// Oldest first, after this number.
    After(i64),
}

/// Selects the entries of a chain that meet a filter, with their reports.
pub(super) fn selection(
    recipient: &str,
    filter: &LedgerFilter,
    window: EntryRange,
    limit: u32,
) -> QueryBuilder<Sqlite> {
    let mut sql = QueryBuilder::new(
        "SELECT e.number, e.content, e.hash, r.body, r.message_id, r.sent_at, r.receipted_at
         FROM ledger_entry e LEFT JOIN report r ON r.id = e.report_id WHERE e.recipient = ",
    );
    sql.push_bind(recipient.to_owned());
    let chain = ChainSelection { recipient, filter, window, limit };
    match (&filter.subject, filter.kind) {
        (None, None) => chain.push_window(&mut sql, "e"),
        (None, Some(kind)) => {
            sql.push(" AND e.number IN (");
            chain.push_numbers(&mut sql, "ledger_by_kind");
            sql.push(" AND x.event = ").push_bind(kind.name());
            chain.push_end(&mut sql, "x");
            sql.push(")");
        }
        (Some(subject), kind) => {
            sql.push(" AND e.number IN (SELECT number FROM (");
            chain.push_decisions(&mut sql, subject, kind);
            sql.push(" UNION ALL ");
            chain.push_reports(&mut sql, subject, kind);
            sql.push(") AS x");
            chain.push_order(&mut sql, "x");
            sql.push(")");
        }
    }
    chain.push_order(&mut sql, "e");
    sql
}

struct ChainSelection<'c> {
    recipient: &'c str,
    filter: &'c LedgerFilter,
    window: EntryRange,
    limit: u32,
}

impl ChainSelection<'_> {
    /// Selects numbers by an index, which is named: without statistics SQLite would rather read the
    /// whole chain.
    fn push_numbers(&self, sql: &mut QueryBuilder<Sqlite>, index: &'static str) {
        sql.push("SELECT x.number FROM ledger_entry x INDEXED BY ")
            .push(index)
            .push(" WHERE x.recipient = ");
        sql.push_bind(self.recipient.to_owned());
    }

    /// Selects decisions about the subject.
    fn push_decisions(
        &self,
        sql: &mut QueryBuilder<Sqlite>,
        subject: &LedgerSubject,
        kind: Option<EventKind>,
    ) {
        self.push_numbers(sql, "ledger_by_field");
        sql.push(" AND ");
        push_subject(sql, subject);
        if kind.is_some_and(|kind| kind != EventKind::Consent) {
            sql.push(" AND false");
        }
        self.push_window(sql, "x");
    }

    /// Selects reports that carried the subject: as many of each writer, epoch and kind as the
    /// whole selection has at most.
    fn push_reports(
        &self,
        sql: &mut QueryBuilder<Sqlite>,
        subject: &LedgerSubject,
        kind: Option<EventKind>,
    ) {
        let kinds: Vec<&str> = EventKind::OF_REPORTS
            .into_iter()
            .filter(|known| kind.is_none_or(|kind| kind == *known))
            .map(EventKind::name)
            .collect();
        sql.push(
            "SELECT y.number FROM (SELECT writer_id, epoch, min(first_sequence) AS first_sequence
                 FROM carried_field WHERE ",
        );
        push_subject(sql, subject);
        sql.push(" GROUP BY writer_id, epoch) AS carried CROSS JOIN json_each(");
        sql.push_bind(serde_json::to_string(&kinds).expect("names serialise"));
        sql.push(") AS kind CROSS JOIN ledger_entry y ON y.recipient = ")
            .push_bind(self.recipient.to_owned());
        sql.push(" AND y.number IN (");
        self.push_numbers(sql, "ledger_by_writer");
        // The sign makes them values without a declared type, as those of the index are.
        sql.push(
            " AND x.writer_id = +carried.writer_id AND x.epoch = +carried.epoch
              AND x.event = kind.value",
        );
        if let Some(name) = &subject.field_name {
            sql.push(
                " AND (x.last_sequence IS NULL OR x.last_sequence >= +carried.first_sequence)",
            );
            sql.push(
                " AND (x.event <> 'QUEUED'
                      OR EXISTS (SELECT 1 FROM json_each(x.content, '$.consents') WHERE key = ",
            );
            sql.push_bind(name.to_string()).push("))");
        }
        self.push_end(sql, "x");
        sql.push(")");
    }

    fn push_window(&self, sql: &mut QueryBuilder<Sqlite>, of: &'static str) {
        let (sign, number) = match self.window {
            EntryRange::Before(number) => (".number < ", number),
            EntryRange::After(number) => (".number > ", number),
        };
        sql.push(" AND ").push(of).push(sign).push_bind(number);
        let bounds =
            [(".recorded_at >= ", self.filter.from), (".recorded_at < ", self.filter.until)];
        for (sign, at) in bounds.into_iter().filter_map(|(sign, at)| Some((sign, at?))) {
            sql.push(" AND ").push(of).push(sign).push_bind(at.unix_micros());
        }
    }

    fn push_order(&self, sql: &mut QueryBuilder<Sqlite>, of: &'static str) {
        let order =
            if matches!(self.window, EntryRange::Before(_)) { ".number DESC" } else { ".number" };
        sql.push(" ORDER BY ")
            .push(of)
            .push(order)
            .push(" LIMIT ")
            .push_bind(i64::from(self.limit));
    }

    fn push_end(&self, sql: &mut QueryBuilder<Sqlite>, of: &'static str) {
        self.push_window(sql, of);
        self.push_order(sql, of);
    }
}

fn push_subject(sql: &mut QueryBuilder<Sqlite>, subject: &LedgerSubject) {
    sql.push("operation_network_id = ").push_bind(subject.operation_network_id.to_string());
    let parts = [
        ("operation_id", subject.operation_id.as_ref().map(ToString::to_string)),
        (
            "dynamic_data_request_id",
            subject.dynamic_data_request_id.as_ref().map(ToString::to_string),
        ),
        ("field_name", subject.field_name.as_ref().map(ToString::to_string)),
    ];
    for (column, value) in parts.into_iter().filter_map(|(column, value)| Some((column, value?))) {
        sql.push(" AND ").push(column).push(" = ").push_bind(value);
    }
}

#[cfg(test)]
mod tests {
    use sqlx::Row as _;

    use super::*;
    use crate::store::Store;

    #[tokio::test]
    async fn selections_use_indexes() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut session = Store::connect(folder.path()).await.expect("a store");
        let subject = LedgerSubject {
            operation_network_id: "n".parse().expect("an id"),
            operation_id: Some("op".parse().expect("an id")),
            dynamic_data_request_id: Some("R1".parse().expect("an id")),
            field_name: Some("made".parse().expect("a name")),
        };
        let sent = Some(EventKind::Sent);
        let by_kind = "ledger_by_kind (recipient=? AND event=? AND number<?)";
        let by_field = "ledger_by_field (recipient=? AND operation_network_id=? AND operation_id=? AND \
                        dynamic_data_request_id=? AND field_name=? AND number<?)";
        let by_writer =
            "ledger_by_writer (recipient=? AND writer_id=? AND epoch=? AND event=? AND number<?)";
        for (kind, subject, expected) in [
            (sent, None, vec![by_kind]),
            (None, Some(subject.clone()), vec![by_field, by_writer]),
            (sent, Some(subject), vec![by_field, by_writer]),
        ] {
            let filter = LedgerFilter { kind, subject, ..LedgerFilter::default() };
            let sql =
                selection("acme", &filter, EntryRange::Before(9), 5).sql().as_str().to_owned();
            let explained = sqlx::query(sqlx::AssertSqlSafe(format!("EXPLAIN QUERY PLAN {sql}")))
                .fetch_all(session.connection())
                .await
                .expect("a plan");
            let plan: Vec<String> =
                explained.iter().map(|row| row.get::<String, _>("detail")).collect();
            for expected in expected {
                assert!(plan.iter().any(|step| step.contains(expected)), "{expected}: {plan:#?}");
            }
            let reads_through = |step: &String| step.starts_with("SCAN") && step.contains("ledger");
            assert!(!plan.iter().any(reads_through), "{plan:#?}");
        }
    }
}
