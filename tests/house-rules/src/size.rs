//! Size of files and functions.

use syn::{
    spanned::Spanned as _,
    visit::{self, Visit},
};

use crate::{
    finding::{Finding, Rule},
    package::{Package, SourceFile},
};

/// Lines of a file, tests and comments included.
pub(crate) const FILE_LINES_MAX: usize = 400;
/// Lines of a function from its signature to its last brace.
const FUNCTION_LINES_MAX: usize = 80;

/// Reports files and functions that are too long.
pub(crate) fn check(package: &Package) -> Vec<Finding> {
    let mut findings = Vec::new();
    for file in &package.files {
        let lines = file.text.lines().count();
        if lines > FILE_LINES_MAX {
            findings.push(too_long(&file.path, lines));
        }
        let mut checker = Checker { file, findings };
        checker.visit_file(&file.syntax);
        findings = checker.findings;
    }
    findings
}

/// Makes the finding of a file with so many lines.
pub(crate) fn too_long(file: &str, lines: usize) -> Finding {
    Finding {
        file: file.to_owned(),
        line: FILE_LINES_MAX + 1,
        rule: Rule::FileLength,
        text: format!("the file has {lines} lines, at most {FILE_LINES_MAX} are allowed"),
    }
}

struct Checker<'a> {
    file: &'a SourceFile,
    findings: Vec<Finding>,
}

impl Checker<'_> {
    fn function(&mut self, signature: &syn::Signature, body: &syn::Block) {
        let first = signature.span().start().line;
        let lines = body.span().end().line - first + 1;
        if lines > FUNCTION_LINES_MAX {
            self.findings.push(Finding {
                file: self.file.path.clone(),
                line: first,
                rule: Rule::FunctionLength,
                text: format!(
                    "`{}` has {lines} lines, at most {FUNCTION_LINES_MAX} are allowed",
                    signature.ident
                ),
            });
        }
    }
}

impl<'ast> Visit<'ast> for Checker<'_> {
    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        self.function(&item.sig, &item.block);
        visit::visit_item_fn(self, item);
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        self.function(&item.sig, &item.block);
        visit::visit_impl_item_fn(self, item);
    }

    fn visit_trait_item_fn(&mut self, item: &'ast syn::TraitItemFn) {
        if let Some(body) = &item.default {
            self.function(&item.sig, body);
        }
        visit::visit_trait_item_fn(self, item);
    }
}
