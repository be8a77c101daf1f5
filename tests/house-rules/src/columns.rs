//! Columns by name: stores read the columns of a row by their names, never by their places.

use syn::{
    Expr, ExprMethodCall, Lit,
    visit::{self, Visit},
};

use crate::{
    finding::{Finding, Rule},
    package::{Package, SourceFile},
};

/// Methods that read a column of a row.
const READERS: [&str; 5] = ["get", "try_get", "get_unchecked", "try_get_unchecked", "get_ref"];

/// Reports columns that a store, tests included, reads by their place: a column that is added to the
/// statement would shift all after it.
pub(crate) fn check(package: &Package) -> Vec<Finding> {
    let mut checker = Checker { file: None, findings: Vec::new() };
    for file in package.files.iter().filter(|file| is_store(&file.inner)) {
        checker.file = Some(file);
        checker.visit_file(&file.syntax);
    }
    checker.findings
}

/// True for `store.rs`, `stores.rs` and what lies in a folder of these names.
fn is_store(inner: &str) -> bool {
    inner.trim_end_matches(".rs").split('/').any(|part| matches!(part, "store" | "stores"))
}

struct Checker<'a> {
    file: Option<&'a SourceFile>,
    findings: Vec<Finding>,
}

impl<'ast> Visit<'ast> for Checker<'_> {
    fn visit_expr_method_call(&mut self, call: &'ast ExprMethodCall) {
        let is_reader = READERS.iter().any(|reader| call.method == reader);
        let is_by_place =
            matches!(call.args.first(), Some(Expr::Lit(place)) if matches!(place.lit, Lit::Int(_)));
        if let (Some(file), true) = (self.file, is_reader && is_by_place) {
            self.findings.push(Finding {
                file: file.path.clone(),
                line: call.method.span().start().line,
                rule: Rule::ColumnByPlace,
                text: "a column is read by its place: read it by its name".to_owned(),
            });
        }
        visit::visit_expr_method_call(self, call);
    }
}
