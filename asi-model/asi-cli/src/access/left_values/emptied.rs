//! Reports whose values retention has emptied: the request that they answered, and the times that
//! their values may have had.

use std::collections::{HashMap, HashSet};

use asi_model::DateTime;

use crate::left::ReportId;

/// A report without its values. Names are numbers.
pub(super) struct EmptiedReport {
    pub(super) id: ReportId,
    pub(super) viewer: u32,
    pub(super) recorded_at: DateTime,
    /// The consent of each field, by its number.
    pub(super) consents: Vec<(u32, u32)>,
}

impl EmptiedReport {
    /// Returns the requests that it may have answered: the one of its writer where another report says
    /// so, else those that have all consents of its fields.
    pub(super) fn requests(
        &self,
        writers: &HashMap<u16, u32>,
        consents: &HashMap<u32, HashSet<(u32, u32)>>,
    ) -> Vec<u32> {
        if let Some(request) = writers.get(&self.id.data_set_writer_id) {
            return vec![*request];
        }
        let has_all = |of: &HashSet<(u32, u32)>| self.consents.iter().all(|one| of.contains(one));
        consents.iter().filter(|(_, of)| has_all(of)).map(|(request, _)| *request).collect()
    }
}
