//! Assertions whose failure can be read: a comparison shows one thing, or a document's difference.

use proc_macro2::{Delimiter, TokenTree};
use syn::visit::{self, Visit};

use crate::{
    finding::{Finding, Rule},
    package::{Package, SourceFile},
};

/// Most members of a tuple in `assert_eq!`: of more, a failure leaves the reader to count.
const TUPLE_MAX: usize = 2;

/// Reports comparisons of large tuples.
pub(crate) fn check(package: &Package) -> Vec<Finding> {
    let mut findings = Vec::new();
    for file in &package.files {
        let mut checker = Checker { file, findings };
        checker.visit_file(&file.syntax);
        findings = checker.findings;
    }
    findings
}

struct Checker<'a> {
    file: &'a SourceFile,
    findings: Vec<Finding>,
}

impl<'ast> Visit<'ast> for Checker<'_> {
    fn visit_macro(&mut self, invocation: &'ast syn::Macro) {
        if invocation.path.is_ident("assert_eq") || invocation.path.is_ident("assert_ne") {
            let mut tokens = invocation.tokens.clone().into_iter();
            if let Some(TokenTree::Group(group)) = tokens.next()
                && group.delimiter() == Delimiter::Parenthesis
                && is_comma(tokens.next())
            {
                let commas =
                    group.stream().into_iter().filter(|token| is_comma(Some(token.clone())));
                let members = commas.count() + 1;
                if members > TUPLE_MAX {
                    self.findings.push(Finding {
                        file: self.file.path.clone(),
                        line: group.span_open().start().line,
                        rule: Rule::LargeTuple,
                        text: format!("a tuple of {members} is compared: compare its members"),
                    });
                }
            }
        }
        visit::visit_macro(self, invocation);
    }
}

fn is_comma(token: Option<TokenTree>) -> bool {
    matches!(token, Some(TokenTree::Punct(punct)) if punct.as_char() == ',')
}
