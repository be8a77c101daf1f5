//! Languages of texts for people in the plant: English and German.

/// The language of a page to print.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Language {
    #[default]
    En,
    De,
}

impl Language {
    /// Returns the text in this language.
    #[must_use]
    pub const fn choose<'a>(self, english: &'a str, german: &'a str) -> &'a str {
        match self {
            Self::En => english,
            Self::De => german,
        }
    }

    /// Returns its ISO 639-1 code.
    #[must_use]
    pub const fn code(self) -> &'static str {
        self.choose("en", "de")
    }
}
