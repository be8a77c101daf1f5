//! Consents that end: what the receipt states about each of them.

use std::collections::BTreeMap;

use asi_model::{DateTime, FieldKey, OrganisationId, RequestKey, messages::GapCause};
use uuid::Uuid;

use super::{Books, ConnectorEvent, DecisionError, Verdict};
use crate::store::WaitingRow;
use ledger::{Event, RevocationReceipt, RevokedField, RevokedWriter, Sequences};

/// Consents that ended together, until their transaction is written.
#[derive(Debug)]
pub(crate) struct EndedConsents {
    pub(crate) revocation_id: Uuid,
    revoked_by: Option<String>,
    reason: Option<String>,
    cause: GapCause,
    fields: Vec<RevokedField>,
    pub(crate) writers: BTreeMap<u16, EndedWriter>,
}

/// A writer as it stood when a consent to its fields ended.
#[derive(Debug, Clone)]
pub(crate) struct EndedWriter {
    pub(crate) epoch: u32,
    next_sequence: u32,
    request: RequestKey,
    recipients: Vec<OrganisationId>,
}

/// How far a writer's reports came, as the store knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Progress {
    /// The last that the broker accepted.
    pub(crate) sent: Option<u32>,
    /// The last that the platform holds.
    pub(crate) receipted: Option<u32>,
}

impl Books {
    /// Ends the consent to fields, all or none. Fields that are not mapped stay as they are.
    ///
    /// # Errors
    /// [`DecisionError`]; then nothing is changed.
    pub fn revoke(
        &mut self,
        fields: &[FieldKey],
        verdict: &Verdict,
        reason: Option<&str>,
        revoked_by: &str,
        now: DateTime,
    ) -> Result<Uuid, DecisionError> {
        let reason = reason.filter(|reason| !reason.trim().is_empty());
        if fields.iter().any(|key| !self.fields.contains_key(key)) {
            return Err(DecisionError::UnknownField);
        }
        let mapped: Vec<&FieldKey> = fields
            .iter()
            .filter(|key| self.fields.get(key).is_some_and(|field| field.decision.is_mapped()))
            .collect();
        if mapped.is_empty() {
            return Err(DecisionError::NothingToRevoke);
        }
        if matches!(verdict, Verdict::Refuse) && reason.is_none() {
            return Err(DecisionError::NoReason);
        }
        let id = self.begin_ending(GapCause::Revoked, reason, Some(revoked_by));
        self.is_ending_together = true;
        for key in mapped {
            self.decide(key, verdict.clone(), reason.map(str::to_owned), revoked_by, now)?;
        }
        self.is_ending_together = false;
        Ok(id)
    }

    fn begin_ending(
        &mut self,
        cause: GapCause,
        reason: Option<&str>,
        revoked_by: Option<&str>,
    ) -> Uuid {
        let revocation_id = Uuid::now_v7();
        self.ended.push(EndedConsents {
            revocation_id,
            revoked_by: revoked_by.map(str::to_owned),
            reason: reason.map(str::to_owned),
            cause,
            fields: Vec::new(),
            writers: BTreeMap::new(),
        });
        revocation_id
    }

    /// Notes that a mapped field's consent ends. To be called while request and writer stand as
    /// they stood.
    pub(super) fn consent_ends(
        &mut self,
        key: &FieldKey,
        consent_version: u32,
        cause: GapCause,
        reason: Option<&str>,
        revoked_by: Option<&str>,
    ) {
        let Some(id) = self.writer_of.get(&key.request).copied() else { return };
        let Some(writer) = self.writers.get(&id) else { return };
        // What ends a second time before it is written ended when it ended first.
        let known = self.ended.iter().find_map(|ended| ended.writers.get(&id)).cloned();
        let ended = known.unwrap_or_else(|| EndedWriter {
            epoch: writer.epoch,
            next_sequence: writer.next_sequence,
            request: key.request.clone(),
            recipients: self.recipients(&key.request),
        });
        let fits = |last: &EndedConsents| {
            last.cause == cause
                && last.revoked_by.as_deref() == revoked_by
                && last.reason.as_deref() == reason
        };
        let goes_on = self.is_ending_together || revoked_by.is_none();
        if !(goes_on && self.ended.last().is_some_and(fits)) {
            self.begin_ending(cause, reason, revoked_by);
        }
        if let Some(last) = self.ended.last_mut() {
            last.fields.push(RevokedField { field: key.clone(), consent_version });
            last.writers.entry(id).or_insert(ended);
        }
    }

    /// The receipt of consents that ended: into the recipients' chains, and to be signed.
    pub(crate) fn receipt_of(
        &mut self,
        ended: EndedConsents,
        standing: &BTreeMap<u16, (Progress, Vec<WaitingRow>)>,
        now: DateTime,
    ) -> RevocationReceipt {
        let mut writers = Vec::with_capacity(ended.writers.len());
        for (id, writer) in ended.writers {
            let (progress, rows) = standing.get(&id).cloned().unwrap_or_default();
            let of_epoch = |is_sent: bool| {
                let rows = rows.iter().filter(|kept| kept.row.epoch == writer.epoch);
                Sequences::of(
                    rows.filter(|kept| kept.row.sent_at.is_some() == is_sent)
                        .map(|k| k.row.sequence)
                        .collect(),
                )
            };
            let revoked = RevokedWriter {
                data_set_writer_id: id,
                epoch: writer.epoch,
                request: writer.request,
                recipient_list: writer.recipients,
                last_queued_sequence: writer.next_sequence.checked_sub(1),
                last_sent_sequence: progress.sent,
                last_delivered_sequence: progress.receipted,
                in_flight: of_epoch(true),
                taken_back: of_epoch(false),
            };
            let event = Event::Revoked {
                revocation_id: ended.revocation_id.to_string(),
                data_set_writer_id: id,
                epoch: writer.epoch,
                last_sent_sequence: progress.sent,
                last_delivered_sequence: progress.receipted,
            };
            self.record(&revoked.recipient_list.clone(), now, None, &event);
            writers.push(revoked);
        }
        self.aftermath.events.push(ConnectorEvent::Revocation(ended.revocation_id.to_string()));
        RevocationReceipt {
            revocation_id: ended.revocation_id.to_string(),
            factory_id: self.config.factory_id.clone(),
            revoked_at: now,
            revoked_by: ended.revoked_by,
            reason: ended.reason,
            cause: ended.cause,
            fields: ended.fields,
            writers,
        }
    }
}
