//! Count of refusals, by share and by those who had used theirs up.

/// Owner of a share that is used up. All have an account, and none is a name that a stranger made up: so the metric has
/// as many labels as there are accounts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShareOwner<'n> {
    Person(&'n str),
    Organisation(&'n str),
    Factory(&'n str),
    Tool(&'n str),
    /// All of the daemon together.
    All,
}

impl ShareOwner<'_> {
    /// Returns the values of the metric's labels `of` and `who`.
    fn labels(self) -> (&'static str, String) {
        let (of, who) = match self {
            Self::Person(name) => ("person", name),
            Self::Organisation(id) => ("organisation", id),
            Self::Factory(id) => ("factory", id),
            Self::Tool(id) => ("tool", id),
            Self::All => ("all", ""),
        };
        (of, who.to_owned())
    }
}

/// Counts a refusal on account of whose share was used up.
pub fn count_refusal(share: &'static str, owner: ShareOwner<'_>) {
    let (of, who) = owner.labels();
    metrics::counter!("verbund_share_refusals_total", "of" => of, "share" => share, "who" => who)
        .increment(1);
}
