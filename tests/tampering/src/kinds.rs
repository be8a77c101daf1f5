//! Kinds of tampering that were tried.

use std::collections::BTreeSet;

/// Number of faults that an audit of these lines finds against this checkpoint. What an audit does not
/// begin with is a fault, too.
pub type Audit<'a> = &'a dyn Fn(&[String], &str) -> u64;

/// Kinds that were tried, each as often as there are places for it, and those that were missed.
pub struct Kinds<'a> {
    audit: Audit<'a>,
    names: BTreeSet<String>,
    attempts: usize,
    missed: BTreeSet<String>,
}

impl<'a> Kinds<'a> {
    pub(crate) fn new(audit: Audit<'a>) -> Self {
        let names = BTreeSet::new();
        Self { audit, names, attempts: 0, missed: BTreeSet::new() }
    }

    /// Audits a file that was tampered with. The name says what was done to what, not where.
    pub fn attempt(&mut self, name: &str, lines: &[String], checkpoint: &str) {
        let faults = (self.audit)(lines, checkpoint);
        self.note(name, faults);
    }

    /// Notes an attempt with the number of faults that were found.
    pub fn note(&mut self, name: &str, faults: u64) {
        self.attempts += 1;
        self.names.insert(name.to_owned());
        if faults == 0 {
            self.missed.insert(name.to_owned());
        }
    }

    /// Asserts that at least so many kinds were tried, and that each attempt was found.
    ///
    /// # Panics
    /// Otherwise.
    pub fn assert_all_found(&self, least: usize) {
        assert!(self.missed.is_empty(), "not found: {:#?}", self.missed);
        let (kinds, attempts) = (self.names.len(), self.attempts);
        assert!(kinds >= least, "only {kinds} kinds were tried, in {attempts} attempts");
    }
}
