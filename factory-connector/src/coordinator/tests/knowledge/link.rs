//! Link of a plant: what leaves, and what the platform answers.

use super::{knower::Knower, plant::Plant, *};
use crate::coordinator::{incoming, outcomes};

impl Plant {
    /// Lets everything leave that waits, and returns the number of reports.
    pub(super) async fn send(&mut self, is_receipted: bool, knower: &Knower) -> usize {
        let mut count = 0;
        let mut last: std::collections::BTreeMap<(u64, u64), u64> = Default::default();
        for lane in [Lane::Control, Lane::Reports] {
            let fetch = Fetch { lane, after: RowId(0), through: None, limit: 100_000 };
            let rows = self.spool.fetch(fetch).await.expect("the spool is read");
            let rows: Vec<_> = rows.iter().filter(|row| self.spool.may_leave(row)).collect();
            for row in rows.iter().filter(|row| row.envelope.subject == "ua-data") {
                let message: Value = serde_json::from_slice(&row.envelope.body).expect("JSON");
                let messages = message["Messages"].as_array().expect("reports");
                let created_at = json!(row.envelope.creation_time.map(DateTime::from));
                assert!(
                    messages.iter().any(|report| report["Timestamp"] == created_at),
                    "{message}"
                );
                for report in messages {
                    knower.check(report, self.now);
                    count += 1;
                }
                for (Report { writer, epoch, sequence }, report) in
                    reports(row).into_iter().zip(messages)
                {
                    last.insert((writer, epoch), sequence);
                    self.left.insert((writer, epoch, sequence), report.clone());
                }
            }
            self.seen.extend(rows.iter().map(|row| {
                let body = String::from_utf8_lossy(&row.envelope.body);
                format!("sent {:?} {} {body}", row.id, json!(format!("{:?}", row.envelope)))
            }));
            let accepted: Vec<RowOutcome> = rows
                .iter()
                .map(|row| RowOutcome {
                    id: row.id,
                    outcome: SendOutcome::Accepted,
                    at: self.now.into(),
                })
                .collect();
            let in_flight = Arc::clone(&self.work.outputs.in_flight);
            let sent: Vec<_> = rows.iter().filter_map(|row| in_flight.accepted(row.id.0)).collect();
            outcomes::record(&mut self.work, &accepted, sent.clone(), self.now)
                .await
                .expect("recorded");
            self.commit().await;
            in_flight.recorded(&sent);
        }
        if is_receipted {
            for ((writer, epoch), through) in last {
                self.receipt(writer, epoch, through).await;
            }
        }
        count
    }

    async fn receipt(&mut self, writer: u64, epoch: u64, through: u64) {
        self.received += 1;
        let id = asi_model::MessageId::from(uuid::Uuid::from_u128(self.received));
        let body = json!({ "messageType": "receipt", "messageId": id, "factoryId": "F",
            "receiptList": [ { "dataSetWriterId": writer, "epoch": epoch,
            "throughSequence": through, "missingList": [] } ] });
        let delivery = Delivery {
            envelope: Envelope::new(id, "receipt", body.to_string()),
            is_redelivered: false,
            delivery_count: 0,
            received_at: self.now.into(),
        };
        incoming::deliver(&mut self.work, vec![delivery], self.now).await.expect("delivered");
    }
}
