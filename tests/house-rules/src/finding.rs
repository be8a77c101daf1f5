//! Findings: one place in a source file that breaks one rule.

use std::fmt;

/// One place that breaks a rule; displayed as `file:line: rule: text`.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Finding {
    /// Path as the package was read, for instance `messaging/src/link.rs`.
    pub file: String,
    /// Line number from 1.
    pub line: usize,
    pub rule: Rule,
    /// Explanation, with what to do instead where one remedy is right.
    pub text: String,
}

/// The rules, by the names under which findings are printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Rule {
    ImportCircle,
    ModuleCircle,
    ModuleWall,
    MissingHeader,
    OpeningWord,
    ShortMemberDoc,
    MissingDoc,
    FileLength,
    FunctionLength,
    ImplSpread,
    TypeSize,
    ColumnByPlace,
    LargeTuple,
    BannedWord,
    SharedTypeName,
}

impl fmt::Display for Rule {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::ImportCircle => "import-circle",
            Self::ModuleCircle => "module-circle",
            Self::ModuleWall => "module-wall",
            Self::MissingHeader => "missing-header",
            Self::OpeningWord => "opening-word",
            Self::ShortMemberDoc => "short-member-doc",
            Self::MissingDoc => "missing-doc",
            Self::FileLength => "file-length",
            Self::FunctionLength => "function-length",
            Self::ImplSpread => "impl-spread",
            Self::TypeSize => "type-size",
            Self::LargeTuple => "large-tuple",
            Self::ColumnByPlace => "column-by-place",
            Self::BannedWord => "banned-word",
            Self::SharedTypeName => "shared-type-name",
        })
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}:{}: {}: {}", self.file, self.line, self.rule, self.text)
    }
}
