//! Statements on the history of reports: each is answered from indexes, however much others keep.

/// Restrictions that a statement on the history has; what they compare with are its parameters.
#[derive(Debug, Clone, Copy)]
pub(super) struct Restrictions {
    /// Leaves reports that were released to the viewer `$1`.
    pub(super) has_viewer: bool,
    /// Leaves reports about the network `$3`.
    pub(super) has_network: bool,
    /// Leaves reports about the request `$4`.
    pub(super) has_request: bool,
    /// The last `$5` reports instead of the first.
    pub(super) is_newest: bool,
}

impl Restrictions {
    /// Makes the statement that lists at most `$5` reports after the one of id `$2`.
    ///
    /// Reports of one set of recipients about one request are neighbours in an index. Of each such pair that
    /// the restrictions admit, the statement reads no more than the limit, and merges what it found. A filter
    /// over all reports would read those of everybody where few match.
    pub(super) fn statement(self) -> String {
        let order = if self.is_newest { " DESC" } else { "" };
        let (sources, wanted) = self.pairs();
        if sources.is_empty() {
            return format!(
                "SELECT q.* FROM report q WHERE {wanted} ORDER BY q.report_id{order} LIMIT $5"
            );
        }
        format!(
            "SELECT r.* FROM report r WHERE r.report_id IN (
                 SELECT p.report_id FROM {} CROSS JOIN report p WHERE p.report_id IN (
                     SELECT q.report_id FROM report q WHERE {wanted} ORDER BY q.report_id{order} LIMIT $5)
                 ORDER BY p.report_id{order} LIMIT $5)
             ORDER BY r.report_id{order}",
            sources.join(" CROSS JOIN ")
        )
    }

    /// Returns the tables of the pairs, and the condition on a report `q` of one pair.
    fn pairs(self) -> (Vec<&'static str>, String) {
        let (mut sources, mut wanted) = (Vec::new(), vec!["q.report_id > $2"]);
        if self.has_viewer {
            sources.push(
                "(SELECT recipient_set_id FROM recipient_set_member WHERE organisation_id = $1) m",
            );
            wanted.push("q.recipient_set_id = m.recipient_set_id");
        }
        let requests = match (self.has_network, self.has_request) {
            (false, false) => None,
            (true, true) => {
                wanted.push("q.operation_network_id = $3 AND q.dynamic_data_request_id = $4");
                None
            }
            (true, false) => Some(
                "(SELECT DISTINCT operation_network_id, dynamic_data_request_id FROM asked_request
                  WHERE operation_network_id = $3) a",
            ),
            (false, true) => Some(
                "(SELECT DISTINCT operation_network_id, dynamic_data_request_id FROM asked_request
                  WHERE dynamic_data_request_id = $4) a",
            ),
        };
        if let Some(requests) = requests {
            sources.push(requests);
            wanted.push(
                "q.operation_network_id = a.operation_network_id
                 AND q.dynamic_data_request_id = a.dynamic_data_request_id",
            );
        }
        (sources, wanted.join(" AND "))
    }
}

#[cfg(test)]
mod tests {
    use sqlx::Row as _;

    use super::*;
    use crate::store::Store;

    fn all() -> impl Iterator<Item = Restrictions> {
        (0..16_u8).map(|bits| Restrictions {
            has_viewer: bits & 1 != 0,
            has_network: bits & 2 != 0,
            has_request: bits & 4 != 0,
            is_newest: bits & 8 != 0,
        })
    }

    #[tokio::test]
    async fn every_filter_of_the_history_uses_an_index() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = Store::open(&folder.path().join("store.sqlite")).await.expect("it opens");
        let mut work = store.read().await.expect("begun");
        for one in all() {
            let sql = format!("EXPLAIN QUERY PLAN {}", one.statement());
            let rows = sqlx::query(sqlx::AssertSqlSafe(sql))
                .bind("a")
                .bind(0)
                .bind("n")
                .bind("r")
                .bind(10)
                .fetch_all(&mut *work.reports().0)
                .await
                .expect("a plan");
            let plan: Vec<String> = rows.iter().map(|row| row.get("detail")).collect();
            for step in &plan {
                assert!(
                    !["SCAN q", "SCAN p", "SCAN r"].contains(&step.as_str()),
                    "{one:?}: {plan:?}"
                );
                let is_restricted = one.has_viewer || one.has_network || one.has_request;
                assert!(
                    !(is_restricted && step.contains("rowid>?")),
                    "it reads the reports of everybody: {one:?}: {plan:?}"
                );
                let sorts_all = step.contains("TEMP B-TREE") && !is_restricted;
                assert!(!sorts_all, "{one:?}: {plan:?}");
            }
        }
    }
}
