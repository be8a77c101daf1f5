//! From when and until when a request asks for values.

use asi_model::{
    DateTime, FieldKey,
    messages::{MappingState, ValueSource},
};
use disclosure::DecisionBasis;

use super::{Books, Field, MappingWork};

/// What a partner reads when its request has ended.
const ENDED: &str = "The request's validity has ended.";

/// The time in which a request asks for values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Validity {
    /// The first instant; from the beginning without it.
    pub from: Option<DateTime>,
    /// The first instant no more; without end without it.
    pub until: Option<DateTime>,
}

impl Validity {
    /// Whether values are asked for at a time.
    #[must_use]
    pub fn contains(&self, at: DateTime) -> bool {
        self.from.is_none_or(|from| from <= at) && !self.has_ended(at)
    }

    /// Whether no values are asked for any more.
    #[must_use]
    pub fn has_ended(&self, at: DateTime) -> bool {
        self.until.is_some_and(|until| until <= at)
    }
}

impl Books {
    /// The validity of a field's request as it now stands.
    pub(super) fn validity_of(&self, key: &FieldKey) -> Validity {
        self.request(&key.request).map_or_else(Validity::default, |(_, request)| Validity {
            from: request.valid_from,
            until: request.valid_until,
        })
    }

    /// Notes when the next mapped field's request ends.
    pub(super) fn note_expiry(&mut self, field: &FieldKey) {
        let Some(field) = self.fields.get(field).filter(|field| field.decision.is_mapped()) else {
            return;
        };
        if let Some(until) = field.validity.until {
            self.next_expiry = Some(self.next_expiry.map_or(until, |next| next.min(until)));
        }
    }

    /// When the next request begins or ends.
    #[must_use]
    pub fn next_turn(&self) -> Option<DateTime> {
        self.next_expiry.into_iter().chain(self.beginnings.first().map(|(at, _)| *at)).min()
    }

    /// Lets the newest values through to fields whose requests ask for them from now on.
    pub fn begin(&mut self, now: DateTime) {
        while let Some((at, key)) = self.beginnings.first().cloned().filter(|(at, _)| *at <= now) {
            self.beginnings.remove(&(at, key.clone()));
            let Some(field) = self.fields.get_mut(&key) else { continue };
            if let Some((value, source)) = field.newest.take().zip(field.decision.value_source) {
                self.candidate(&key, source, value, None, now);
            }
        }
    }

    /// Ends what requests do not ask for any more: the fields are undecided again and nothing of
    /// them leaves. What was disclosed in time is still delivered.
    pub fn expire(&mut self, now: DateTime) {
        if self.next_expiry.is_none_or(|next| next > now) {
            return;
        }
        let is_over = |field: &Field| field.decision.is_mapped() && field.validity.has_ended(now);
        let mut over: Vec<FieldKey> = self
            .fields
            .iter()
            .filter(|field| is_over(field))
            .map(|field| field.key.clone())
            .collect();
        over.sort();
        let mut writers = std::collections::BTreeSet::new();
        for key in over {
            let Some(field) = self.fields.get_mut(&key) else { continue };
            if field.decision.is_open_for(ValueSource::Mapping) {
                self.aftermath.mappings.push(MappingWork::Remove(field.mapping_id()));
            }
            field.gate.close();
            field.newest = None;
            let decision = &mut field.decision;
            decision.mapping_state = MappingState::Pending;
            decision.value_source = None;
            decision.grounds = DecisionBasis::default();
            decision.reason = Some(ENDED.to_owned());
            decision.decided_by = None;
            decision.decided_at = Some(now);
            decision.version += 1;
            writers.insert(field.writer);
            self.tell_watchers(&key, now);
            self.told_and_kept(&key, now);
            tracing::info!(field = %key, "The request's validity has ended; nothing of the field leaves any more.");
        }
        for writer in writers {
            self.refresh_writer(writer, now);
        }
        let ends = self
            .fields
            .iter()
            .filter(|field| field.decision.is_mapped())
            .filter_map(|field| field.validity.until);
        self.next_expiry = ends.min();
    }
}
