//! Decisions about the past at a plant: a recipient sees what had left for others.

use connector_state::{
    past::PastOffer,
    queries::past_offer,
    use_cases::decide_past::{PastDecisionRequest, decide_past},
};

use super::{
    fields::{FIELDS, PARTNERS},
    knower::Knower,
    plant::Plant,
    *,
};

impl Plant {
    /// Decides about the past of the first request, and returns the number of reports that the
    /// partner is shown.
    pub(super) async fn decide_past(
        &mut self,
        partner: usize,
        is_released: bool,
        knower: &Knower,
    ) -> usize {
        let (partner, request) = (PARTNERS[partner], FIELDS[0].key().request);
        let recipient: asi_model::OrganisationId = partner.parse().expect("an id");
        let after = self.work.state.past().decided_through(&request, &recipient);
        let mut session = Store::connect(self.folder.path()).await.expect("a connection");
        let mut reports = session.past_reports();
        let past = reports.of(&request, &recipient, after.unwrap_or_default()).await;
        let past = past.expect("the store is read");
        let Some(PastOffer { root, ranges, .. }) = past_offer(&self.work.state, &past) else {
            return 0;
        };
        let (reason, decided_by) = (None, "eve".to_owned());
        let decision = PastDecisionRequest { past, is_released, root, reason, decided_by };
        let decided = decide_past(&mut self.work.state, decision, self.now);
        let Ok((_, changes)) = decided else { return 0 };
        self.work.pending.merge(changes);
        let mut count = 0;
        for (range, _) in ranges.iter().filter(|_| is_released) {
            for sequence in range.first_sequence..=range.last_sequence {
                let place = (range.data_set_writer_id.into(), range.epoch.into(), sequence.into());
                knower.check_past(&self.left[&place], partner);
                count += 1;
            }
        }
        count
    }
}
