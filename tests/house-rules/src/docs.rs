//! Documentation: module headers, the word that a doc comment begins with, docs of members and of
//! public items.

use proc_macro2::{TokenStream, TokenTree};
use syn::{
    AttrStyle, Attribute, ImplItem, Item, Visibility,
    spanned::Spanned as _,
    visit::{self, Visit},
};

use crate::{
    finding::{Finding, Rule},
    imports::{ImportGraph, attributes_of},
    module_tree::is_test_only,
    package::{Package, Role, SourceFile},
    words::parts,
};

/// First words of relative clauses without a noun.
const OPENING_WORDS: [&str; 12] = [
    "What", "Who", "Whose", "Whom", "How", "Where", "When", "Which", "Why", "Whether", "That", "If",
];
/// First words that stand for a noun which the reader has to find elsewhere.
const PRONOUNS: [&str; 14] = [
    "It",
    "They",
    "There",
    "So",
    "Those",
    "These",
    "This",
    "Something",
    "Someone",
    "Nobody",
    "Nothing",
    "Not",
    "Only",
    "As",
];
/// Prepositions that no doc begins with, but that of a variant: "In the field" is one of several
/// values of a noun that the type's doc has.
const PREPOSITIONS_OF_VARIANTS: [&str; 6] = ["From", "Of", "For", "In", "To", "With"];
/// Words before a relative clause: "Until when", "After how many".
const PREPOSITIONS: [&str; 13] = [
    "About", "After", "At", "Before", "By", "For", "From", "In", "Of", "Since", "To", "Until",
    "With",
];
/// Words that add nothing to a name.
const FILL_WORDS: [&str; 9] = ["the", "a", "an", "of", "its", "s", "is", "time", "in"];
/// Words that begin with so many equal letters count as the same.
const STEM_CHARS: usize = 5;
/// Docs of a member with at most so many words say no more than its name.
const EMPTY_WORDS_MAX: usize = 2;

/// Reports what the documentation of each file lacks.
pub(crate) fn check(package: &Package, graph: &ImportGraph) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (index, file) in package.files.iter().enumerate() {
        let is_test = file.role == Role::Test || graph.is_test_file(index);
        if !is_test && !file.inner.ends_with("main.rs") && text_of(&file.syntax.attrs).is_none() {
            let text = "the file begins with no //! header".to_owned();
            let rule = Rule::MissingHeader;
            findings.push(Finding { file: file.path.clone(), line: 1, rule, text });
        }
        let mut checker =
            Checker { file, findings, last: None, is_below_heading: false, is_in_variant: false };
        checker.visit_file(&file.syntax);
        findings = checker.findings;
        if file.role == Role::Library && !is_test {
            public_items(file, &file.syntax.items, &mut findings);
            type_docs(file, &file.syntax.items, &mut findings);
        }
    }
    findings
}

struct Checker<'a> {
    file: &'a SourceFile,
    findings: Vec<Finding>,
    /// Line and style of the doc line before: the next line goes on with its comment.
    last: Option<(usize, bool)>,
    /// True after a heading of that comment, until its first text.
    is_below_heading: bool,
    is_in_variant: bool,
}

impl Checker<'_> {
    fn report(&mut self, line: usize, rule: Rule, text: String) {
        self.findings.push(Finding { file: self.file.path.clone(), line, rule, text });
    }

    /// Checks the word that a doc comment or the text below one of its headings begins with.
    fn doc_line(&mut self, line: usize, is_inner: bool, text: &str) {
        let text = text.trim_start();
        let goes_on = self.last.is_some_and(|last| last == (line.saturating_sub(1), is_inner));
        let is_below_heading = goes_on && self.is_below_heading;
        self.last = Some((line, is_inner));
        self.is_below_heading = text.starts_with("# ") || is_below_heading && text.is_empty();
        if goes_on && !is_below_heading {
            return;
        }
        let mut words = text.split(|c: char| !c.is_alphabetic());
        let (first, second) = (words.next(), words.next().unwrap_or_default());
        // "# Errors: When ..." is the convention of the standard library.
        let is_condition = |word: &str| is_below_heading && matches!(word, "When" | "If");
        let is_relative = OPENING_WORDS.iter().any(|word| word.to_lowercase() == second);
        // "# Errors: Those of the writer", "As `start`": the heading is the noun.
        let is_reference = |word: &str| is_below_heading && matches!(word, "As" | "Those");
        let is_opening = |word: &&str| {
            OPENING_WORDS.contains(word) && !is_condition(word)
                || PRONOUNS.contains(word) && !is_reference(word)
                || PREPOSITIONS_OF_VARIANTS.contains(word)
                    && !self.is_in_variant
                    && !is_below_heading
                || PREPOSITIONS.contains(word) && is_relative
        };
        if let Some(word) = first.filter(is_opening) {
            self.report(
                line,
                Rule::OpeningWord,
                format!("begins with \"{word}\": begin with a noun or a verb of doing"),
            );
        }
    }

    /// Checks the docs among the tokens of a macro, which syn does not take for attributes.
    fn macro_docs(&mut self, tokens: TokenStream) {
        let mut is_inner = false;
        for token in tokens {
            match token {
                TokenTree::Punct(punct) => is_inner = punct.as_char() == '!',
                TokenTree::Group(group) => {
                    let line = group.span().start().line;
                    match syn::parse2::<syn::MetaNameValue>(group.stream()) {
                        Ok(doc) if doc.path.is_ident("doc") => {
                            self.doc_line(line, is_inner, &text_in(&doc.value));
                        }
                        _ => self.macro_docs(group.stream()),
                    }
                }
                TokenTree::Ident(_) | TokenTree::Literal(_) => {}
            }
        }
    }

    /// Checks the doc of a field or a variant, given its name and the names in its types.
    fn member(&mut self, attributes: &[Attribute], names: &str) {
        let Some((line, text)) = text_of(attributes) else { return };
        let words = text.split_whitespace().count();
        if words <= EMPTY_WORDS_MAX || repeats(&text, names) {
            self.report(
                line,
                Rule::ShortMemberDoc,
                format!("\"{}\" says no more than the member's name", text.trim()),
            );
        }
    }
}

impl<'ast> Visit<'ast> for Checker<'_> {
    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        let Some(text) = doc_line(attribute) else { return };
        let is_inner = matches!(attribute.style, AttrStyle::Inner(_));
        self.doc_line(attribute.span().start().line, is_inner, &text);
    }

    fn visit_macro(&mut self, invocation: &'ast syn::Macro) {
        self.macro_docs(invocation.tokens.clone());
        visit::visit_macro(self, invocation);
    }

    fn visit_field(&mut self, field: &'ast syn::Field) {
        let mut names = Names::default();
        names.visit_type(&field.ty);
        field.ident.iter().for_each(|name| names.visit_ident(name));
        self.member(&field.attrs, &names.0);
        visit::visit_field(self, field);
    }

    fn visit_variant(&mut self, variant: &'ast syn::Variant) {
        let mut names = Names::default();
        variant.fields.iter().for_each(|field| names.visit_type(&field.ty));
        names.visit_ident(&variant.ident);
        self.member(&variant.attrs, &names.0);
        // Members of a variant have docs of their own.
        self.is_in_variant = true;
        variant.attrs.iter().for_each(|attribute| self.visit_attribute(attribute));
        self.is_in_variant = false;
        self.visit_fields(&variant.fields);
    }
}

/// Reports public items without docs, below public modules as well.
fn public_items(file: &SourceFile, items: &[Item], findings: &mut Vec<Finding>) {
    let mut require = |visibility: &Visibility, attributes: &[Attribute], name: &syn::Ident| {
        let is_public = matches!(visibility, Visibility::Public(_));
        if is_public && text_of(attributes).is_none() && !is_hidden(attributes) {
            findings.push(Finding {
                file: file.path.clone(),
                line: name.span().start().line,
                rule: Rule::MissingDoc,
                text: format!("`{name}` is public and has no docs"),
            });
        }
    };
    for item in items.iter().filter(|item| !is_test_only(attributes_of(item))) {
        match item {
            Item::Const(item) => require(&item.vis, &item.attrs, &item.ident),
            Item::Enum(item) => require(&item.vis, &item.attrs, &item.ident),
            Item::Fn(item) => require(&item.vis, &item.attrs, &item.sig.ident),
            Item::Static(item) => require(&item.vis, &item.attrs, &item.ident),
            Item::Struct(item) => require(&item.vis, &item.attrs, &item.ident),
            Item::Trait(item) => require(&item.vis, &item.attrs, &item.ident),
            Item::Type(item) => require(&item.vis, &item.attrs, &item.ident),
            Item::Impl(block) if block.trait_.is_none() => {
                for item in &block.items {
                    if let ImplItem::Fn(method) = item {
                        require(&method.vis, &method.attrs, &method.sig.ident);
                    }
                }
            }
            _ => {}
        }
    }
    for item in items {
        if let Item::Mod(child) = item
            && let Some((_, items)) = &child.content
            && matches!(child.vis, Visibility::Public(_))
            && !is_test_only(&child.attrs)
        {
            public_items(file, items, findings);
        }
    }
}

/// Reports docs of public types that repeat their name.
fn type_docs(file: &SourceFile, items: &[Item], findings: &mut Vec<Finding>) {
    for item in items.iter().filter(|item| !is_test_only(attributes_of(item))) {
        let (visibility, attributes, name) = match item {
            Item::Enum(item) => (&item.vis, &item.attrs, &item.ident),
            Item::Struct(item) => (&item.vis, &item.attrs, &item.ident),
            Item::Trait(item) => (&item.vis, &item.attrs, &item.ident),
            Item::Type(item) => (&item.vis, &item.attrs, &item.ident),
            _ => continue,
        };
        let Some((line, text)) = text_of(attributes) else { continue };
        if matches!(visibility, Visibility::Public(_)) && repeats(&text, &name.to_string()) {
            let text = format!("\"{}\" says no more than `{name}`", text.trim());
            let rule = Rule::ShortMemberDoc;
            findings.push(Finding { file: file.path.clone(), line, rule, text });
        }
    }
}

/// Names of a member and of its types, with spaces between.
#[derive(Default)]
struct Names(String);

impl<'ast> Visit<'ast> for Names {
    fn visit_ident(&mut self, name: &'ast proc_macro2::Ident) {
        self.0.push_str(&name.to_string());
        self.0.push(' ');
    }
}

/// True where each word of a doc is one of the names, or the same word in another form.
fn repeats(text: &str, names: &str) -> bool {
    let names = parts(names);
    parts(text).iter().filter(|word| !FILL_WORDS.contains(&word.as_str())).all(|word| {
        // "created" and "creation", "name" and "names".
        let stem = |word: &str| word.chars().take(STEM_CHARS).collect::<String>();
        names.iter().any(|name| stem(name) == stem(word))
    })
}

fn is_hidden(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        syn::Meta::List(list) => list.path.is_ident("doc") && list.tokens.to_string() == "hidden",
        _ => false,
    })
}

/// Returns the whole doc comment with the line of its beginning.
fn text_of(attributes: &[Attribute]) -> Option<(usize, String)> {
    let mut lines = attributes
        .iter()
        .filter_map(|attribute| Some((attribute.span().start().line, doc_line(attribute)?)));
    let (line, mut text) = lines.next()?;
    for (_, next) in lines {
        text.push('\n');
        text.push_str(&next);
    }
    Some((line, text))
}

/// Returns one line of docs; empty for docs that are included from a file.
fn doc_line(attribute: &Attribute) -> Option<String> {
    let syn::Meta::NameValue(doc) = &attribute.meta else { return None };
    if !doc.path.is_ident("doc") {
        return None;
    }
    Some(text_in(&doc.value))
}

fn text_in(value: &syn::Expr) -> String {
    match value {
        syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }) => text.value(),
        _ => String::new(),
    }
}
