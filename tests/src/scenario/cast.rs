//! APIs of a running story.

use crate::harness::Api;

/// The three APIs of a running story.
pub struct Cast {
    /// The platform's, as administrator.
    pub platform: Api,
    /// Munich's connector's, as engineer.
    pub munich: Api,
    /// Hamburg's connector's, as engineer.
    pub hamburg: Api,
}
