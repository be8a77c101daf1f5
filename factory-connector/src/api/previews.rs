//! Previews that were shown lately, so that a decision can name the one that it was made on.

use std::{
    collections::VecDeque,
    sync::{Mutex, PoisonError},
};

use asi_model::FieldKey;
use daemon::web::Problem;
use disclosure::DisclosurePolicy;

/// Most previews that are remembered. An open page asks for one each 1.5 s: minutes for several.
const PREVIEWS_MAX: usize = 500;
/// Most bytes of their texts together.
const BYTES_MAX: usize = 16 * 1024 * 1024;

/// A preview as it was shown.
pub(super) struct ShownPreview {
    pub(super) preview_id: String,
    /// Name of the user who saw it.
    pub(super) user: String,
    pub(super) field: FieldKey,
    /// The draft that it shows, as JSON with its members in a fixed order.
    pub(super) draft: String,
    /// The answer that the user saw, as JSON.
    pub(super) text: String,
    /// The precision that it shows.
    pub(super) effective: DisclosurePolicy,
}

/// Owner of the previews of all users, the oldest first.
#[derive(Default)]
pub(super) struct ShownPreviews(Mutex<VecDeque<ShownPreview>>);

impl ShownPreviews {
    /// Remembers a preview, and forgets older ones above the limits.
    pub(super) fn remember(&self, preview: ShownPreview) {
        let mut shown = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        shown.push_back(preview);
        let mut bytes: usize = shown.iter().map(|preview| preview.text.len()).sum();
        while shown.len() > PREVIEWS_MAX || bytes > BYTES_MAX {
            let Some(oldest) = shown.pop_front() else { break };
            bytes -= oldest.text.len();
        }
    }

    /// Returns the text of the preview on which a user decides, and the precision that it shows.
    ///
    /// # Errors
    /// `UNKNOWN_PREVIEW` where the user saw no such preview of the field lately,
    /// `PREVIEW_OF_ANOTHER_DRAFT` where it shows something else than is decided.
    pub(super) fn text_for(
        &self,
        preview_id: &str,
        (user, field, draft): (&str, &FieldKey, &str),
    ) -> Result<(String, DisclosurePolicy), Problem> {
        let shown = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let known = shown.iter().find(|preview| {
            preview.preview_id == preview_id && preview.user == user && preview.field == *field
        });
        let known = known.ok_or_else(|| {
            Problem::conflict(
                "UNKNOWN_PREVIEW",
                "There is no such preview, or it is too old. Look at the preview again.",
            )
        })?;
        if known.draft == draft {
            Ok((known.text.clone(), known.effective.clone()))
        } else {
            Err(Problem::conflict(
                "PREVIEW_OF_ANOTHER_DRAFT",
                "The preview shows something else than is decided. Look at the preview again.",
            ))
        }
    }
}
