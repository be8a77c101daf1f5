//! Writers as a viewer may know them: numbers and times of reports that were released to it.

use asi_model::FactoryId;

use super::{
    super::{
        error::StoreError,
        row::{Columns, DatabaseRow, signed},
        scope::Scope,
    },
    GAPS_PER_WRITER_MAX, StoredGap, WriterKey, WriterRow, Writers, read,
};
use crate::sequences::SequenceSet;

/// Part of a factory's writers, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WritersWanted {
    /// Writer and epoch behind which it begins; none for the beginning.
    pub after: Option<(u16, u32)>,
    /// Most of them.
    pub limit: u32,
}

/// A writer as a viewer may know it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SeenWriter {
    /// The writer; of its numbers and times those that the viewer may know.
    pub writer: WriterRow,
    /// Numbers that the factory announced will never come.
    pub gaps: Vec<StoredGap>,
    /// True for the factory's own organisation and for administrators.
    pub is_whole: bool,
}

/// Reports of a writer that were released to a viewer.
#[derive(Debug, Clone, Copy)]
struct SeenRange {
    first: u32,
    through: u32,
    /// True for a recipient in effect, to whom the factory consented.
    is_recipient: bool,
    /// True where some of them were released after they had left for others.
    has_past: bool,
}

impl WritersWanted {
    /// Returns numbers that are less than those of all wanted.
    fn behind(self) -> (i64, i64) {
        self.after.map_or((-1, -1), |(writer, epoch)| (writer.into(), epoch.into()))
    }
}

impl Writers<'_> {
    /// Lists writers of a factory, by writer and epoch: all to the factory's own organisation and
    /// to administrators, to others those of whose reports at least one was released to them, with
    /// the numbers of these reports.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of_factory(
        &mut self,
        scope: &Scope,
        factory: &FactoryId,
        wanted: WritersWanted,
    ) -> Result<Vec<SeenWriter>, StoreError> {
        let writers = if self.is_own(scope, factory).await? {
            self.whole(factory, wanted).await?
        } else {
            self.released(scope, factory, wanted).await?
        };
        let mut seen = Vec::with_capacity(writers.len());
        for (writer, released) in writers {
            let announced = self.gaps(&writer.key).await?;
            let is_whole = released.is_none();
            let gaps = match released {
                Some(released) => released.gaps(announced),
                None => announced,
            };
            seen.push(SeenWriter { writer, gaps, is_whole });
        }
        Ok(seen)
    }

    /// Returns true for the factory's own organisation and for administrators.
    async fn is_own(&mut self, scope: &Scope, factory: &FactoryId) -> Result<bool, StoreError> {
        let sql = "SELECT 1 FROM factory WHERE factory_id = $2
                   AND (CAST($1 AS TEXT) IS NULL OR organisation_id = $1)";
        let found = sqlx::query(sql)
            .bind(scope.member())
            .bind(factory.as_str())
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("ask whose a factory is"))?;
        Ok(found.is_some())
    }

    async fn whole(
        &mut self,
        factory: &FactoryId,
        wanted: WritersWanted,
    ) -> Result<Vec<(WriterRow, Option<SeenRange>)>, StoreError> {
        let sql = "SELECT * FROM data_set_writer
                   WHERE factory_id = $1 AND (data_set_writer_id, epoch) > ($2, $3)
                   ORDER BY data_set_writer_id, epoch LIMIT $4";
        let (writer, epoch) = wanted.behind();
        let rows = sqlx::query(sql)
            .bind(factory.as_str())
            .bind(writer)
            .bind(epoch)
            .bind(i64::from(wanted.limit))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list writers"))?;
        rows.iter().map(|row| Ok((read(row)?, None))).collect()
    }

    /// Reads the newest gaps that a factory announced of a writer, in the order of their arrival.
    async fn gaps(&mut self, key: &WriterKey) -> Result<Vec<StoredGap>, StoreError> {
        let sql = "SELECT * FROM sequence_gap WHERE factory_id = $1 AND data_set_writer_id = $2 AND epoch = $3
                   ORDER BY sequence_gap_id DESC LIMIT $4";
        let rows = sqlx::query(sql)
            .bind(key.factory_id.as_str())
            .bind(i64::from(key.data_set_writer_id))
            .bind(i64::from(key.epoch))
            .bind(signed(GAPS_PER_WRITER_MAX))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list gaps"))?;
        let gap = |row: &DatabaseRow| {
            Ok(StoredGap {
                first_sequence: row.unsigned("first_sequence")?,
                last_sequence: row.unsigned("last_sequence")?,
                cause: row.json("cause")?,
                is_coarse: row.unsigned::<u8>("is_coarse")? != 0,
            })
        };
        rows.iter().rev().map(gap).collect()
    }

    /// Lists the writers of which reports were released to the viewer, with the numbers of these.
    async fn released(
        &mut self,
        scope: &Scope,
        factory: &FactoryId,
        wanted: WritersWanted,
    ) -> Result<Vec<(WriterRow, Option<SeenRange>)>, StoreError> {
        let sql = "SELECT w.factory_id, w.data_set_writer_id, w.epoch, w.through_sequence, w.missing, w.duplicates,
                       w.last_keep_alive_at, w.needs_receipt, w.coarse_through, s.first_sequence AS released_first,
                       s.through_sequence AS released_through, s.received, s.last_report_at,
                       s.operation_network_id, s.dynamic_data_request_id,
                       EXISTS (SELECT 1 FROM request_recipient r
                           WHERE r.operation_network_id = s.operation_network_id
                             AND r.dynamic_data_request_id = s.dynamic_data_request_id
                             AND r.organisation_id = $1 AND r.consented_at IS NOT NULL) AS is_recipient,
                       EXISTS (SELECT 1 FROM past_release p
                           WHERE p.factory_id = w.factory_id AND p.data_set_writer_id = w.data_set_writer_id
                             AND p.epoch = w.epoch AND p.organisation_id = $1) AS has_past
                   FROM data_set_writer w
                   JOIN writer_recipient_set s ON s.factory_id = w.factory_id
                       AND s.data_set_writer_id = w.data_set_writer_id AND s.epoch = w.epoch
                   JOIN recipient_set_member m ON m.recipient_set_id = s.recipient_set_id
                   WHERE m.organisation_id = $1 AND w.factory_id = $2 AND s.through_sequence IS NOT NULL
                     AND (w.data_set_writer_id, w.epoch) IN (
                         SELECT DISTINCT s.data_set_writer_id, s.epoch FROM writer_recipient_set s
                         JOIN recipient_set_member m ON m.recipient_set_id = s.recipient_set_id
                         WHERE m.organisation_id = $1 AND s.factory_id = $2 AND s.through_sequence IS NOT NULL
                           AND (s.data_set_writer_id, s.epoch) > ($3, $4)
                         ORDER BY s.data_set_writer_id, s.epoch LIMIT $5)
                   ORDER BY w.data_set_writer_id, w.epoch, s.through_sequence";
        let (after_writer, after_epoch) = wanted.behind();
        let rows = sqlx::query(sql)
            .bind(scope.member())
            .bind(factory.as_str())
            .bind(after_writer)
            .bind(after_epoch)
            .bind(i64::from(wanted.limit))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list writers of recipients"))?;
        let mut writers: Vec<(WriterRow, Option<SeenRange>)> = Vec::with_capacity(rows.len());
        for row in &rows {
            let mut writer = read(row)?;
            let mut released = SeenRange {
                first: row.unsigned("released_first")?,
                through: row.unsigned("released_through")?,
                is_recipient: row.unsigned::<u8>("is_recipient")? != 0,
                has_past: row.unsigned::<u8>("has_past")? != 0,
            };
            // A writer comes once for each set with the viewer, the highest number last.
            if let Some((known, Some(of_other_set))) =
                writers.pop_if(|(known, _)| known.key == writer.key)
            {
                released.first = released.first.min(of_other_set.first);
                writer.received += known.received;
                writer.last_report_at = writer.last_report_at.max(known.last_report_at);
            }
            writers.push((writer, Some(released)));
        }
        for (writer, released) in &mut writers {
            if let Some(released) = released {
                released.restrict(writer);
            }
        }
        Ok(writers)
    }
}

impl SeenRange {
    /// Returns the lowest number that the viewer may know of.
    const fn floor(&self) -> u32 {
        if self.is_recipient && !self.has_past { 0 } else { self.first }
    }

    /// Restricts a writer to what the viewer may know. Who is no recipient any more learns nothing
    /// that could still change.
    fn restrict(&self, writer: &mut WriterRow) {
        if self.is_recipient {
            writer.sequences = writer.sequences.between(self.floor(), self.through);
        } else {
            writer.sequences = SequenceSet::complete(self.through);
            writer.last_keep_alive_at = None;
        }
    }

    /// Returns the gaps among the numbers that the viewer may know, and, for a recipient in effect,
    /// those that directly follow its last report: a gap behind a report to others is not its own.
    fn gaps(&self, announced: Vec<StoredGap>) -> Vec<StoredGap> {
        let mut end = u64::from(self.through);
        if self.is_recipient {
            let mut ordered: Vec<&StoredGap> = announced.iter().collect();
            ordered.sort_by_key(|gap| gap.first_sequence);
            for gap in ordered {
                if u64::from(gap.first_sequence) == end + 1 {
                    end = gap.last_sequence.into();
                }
            }
        }
        let is_known = |gap: &StoredGap| {
            gap.first_sequence >= self.floor() && u64::from(gap.last_sequence) <= end
        };
        announced.into_iter().filter(is_known).collect()
    }
}
