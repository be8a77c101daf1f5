//! Values into texts and out of them: the templates of `format` and the patterns of `parse`.

mod pattern;
mod template;

pub(crate) use pattern::Pattern;
pub(crate) use template::{Source, Template};
