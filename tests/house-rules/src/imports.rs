//! Import graph: which file of a package uses items of which other file, and which external paths.

use proc_macro2::{TokenStream, TokenTree};
use syn::{
    Attribute, ImplItem, Item,
    spanned::Spanned as _,
    visit::{self, Visit},
};

use crate::{
    module_tree::{ModuleId, ModuleTree, is_passed_on, is_test_only, use_leaves},
    package::Package,
    resolve::Target,
};

/// The import graph of a package, without its tests.
#[derive(Debug)]
pub(crate) struct ImportGraph {
    pub(crate) tree: ModuleTree,
    /// Paths of the files, by index.
    pub(crate) files: Vec<String>,
    pub(crate) imports: Vec<Import>,
    pub(crate) external: Vec<ExternalUse>,
}

/// Use of another module's item.
#[derive(Debug)]
pub(crate) struct Import {
    pub(crate) from: ModuleId,
    pub(crate) to: ModuleId,
    pub(crate) line: usize,
    /// The path as written.
    pub(crate) path: String,
    /// True for `pub use`.
    pub(crate) is_reexport: bool,
}

/// Use of a path of another crate.
#[derive(Debug)]
pub(crate) struct ExternalUse {
    pub(crate) from: ModuleId,
    /// Whole path after imports are resolved, for instance `std::time::SystemTime::now`.
    pub(crate) path: String,
    pub(crate) line: usize,
}

impl ImportGraph {
    pub(crate) fn of(package: &Package) -> Self {
        let tree = ModuleTree::of(package);
        let mut collector =
            Collector { tree: &tree, imports: Vec::new(), external: Vec::new(), at: 0, blocks: 0 };
        for (id, module) in tree.modules.iter().enumerate() {
            // Blocks inside a file are visited with the file.
            let is_file =
                module.parent.is_none_or(|parent| tree.modules[parent].file != module.file);
            if is_file && !module.is_test {
                collector.at = id;
                collector.visit_file(&package.files[module.file].syntax);
            }
        }
        let Collector { imports, external, .. } = collector;
        let files = package.files.iter().map(|file| file.path.clone()).collect();
        Self { tree, files, imports, external }
    }

    /// True for files that hold tests only.
    pub(crate) fn is_test_file(&self, file: usize) -> bool {
        self.tree.module_of_file(file).is_some_and(|module| self.tree.modules[module].is_test)
    }
}

struct Collector<'a> {
    tree: &'a ModuleTree,
    imports: Vec<Import>,
    external: Vec<ExternalUse>,
    /// Module whose items are being visited.
    at: ModuleId,
    /// Depth of nested function bodies.
    blocks: usize,
}

impl Collector<'_> {
    fn note(&mut self, path: &[String], line: usize, is_reexport: bool) {
        match self.tree.resolve(self.at, path) {
            Target::Item(to) => self.import(to, path, line, is_reexport),
            Target::External(whole) => {
                let path = whole.join("::");
                self.external.push(ExternalUse { from: self.at, path, line });
            }
            // Only what is used of the module counts.
            Target::Module(_) => {}
        }
    }

    fn import(&mut self, to: ModuleId, path: &[String], line: usize, is_reexport: bool) {
        if !self.tree.modules[to].is_test {
            self.imports.push(Import {
                from: self.at,
                to,
                line,
                path: path.join("::"),
                is_reexport,
            });
        }
    }

    /// Notes a path of code. A single name counts when the module re-exports it: the `pub use` alone
    /// is no import.
    fn note_code(&mut self, path: &[String], line: usize) {
        let [name] = path else { return self.note(path, line, false) };
        if self.tree.modules[self.at].reexports.contains(name) {
            self.note(path, line, false);
        }
    }

    /// Notes the paths in the tokens of a macro call or an attribute.
    fn note_tokens(&mut self, tokens: TokenStream) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let is_punct = |at: usize, sign: char| matches!(tokens.get(at), Some(TokenTree::Punct(punct)) if punct.as_char() == sign);
        let mut at = 0;
        while at < tokens.len() {
            match &tokens[at] {
                TokenTree::Group(group) => self.note_tokens(group.stream()),
                TokenTree::Ident(first) => {
                    let is_member = at > 0 && (is_punct(at - 1, '.') || is_punct(at - 1, '\''));
                    let line = first.span().start().line;
                    let mut path = vec![first.to_string()];
                    while is_punct(at + 1, ':')
                        && is_punct(at + 2, ':')
                        && let Some(TokenTree::Ident(next)) = tokens.get(at + 3)
                    {
                        path.push(next.to_string());
                        at += 3;
                    }
                    if !is_member {
                        self.note_code(&path, line);
                    }
                }
                TokenTree::Literal(literal) => {
                    if let Some(path) = path_in_text(&literal.to_string()) {
                        self.note_code(&path, literal.span().start().line);
                    }
                }
                TokenTree::Punct(_) => {}
            }
            at += 1;
        }
    }
}

impl<'ast> Visit<'ast> for Collector<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        if !is_test_only(attributes_of(item)) {
            visit::visit_item(self, item);
        }
    }

    fn visit_impl_item(&mut self, item: &'ast ImplItem) {
        let attributes = match item {
            ImplItem::Const(item) => &item.attrs[..],
            ImplItem::Fn(item) => &item.attrs,
            ImplItem::Type(item) => &item.attrs,
            ImplItem::Macro(item) => &item.attrs,
            _ => &[],
        };
        if !is_test_only(attributes) {
            visit::visit_impl_item(self, item);
        }
    }

    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        let child = self.tree.modules[self.at].children.get(&item.ident.to_string()).copied();
        if let (Some((_, items)), Some(child)) = (&item.content, child)
            && !self.tree.modules[child].is_test
        {
            let parent = std::mem::replace(&mut self.at, child);
            for item in items {
                self.visit_item(item);
            }
            self.at = parent;
        }
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        let is_reexport = is_passed_on(&item.vis);
        for leaf in use_leaves(&item.tree) {
            match self.tree.resolve(self.at, &leaf.path) {
                // Which names a glob imports is not known: all of the module counts.
                // Names imported inside a function are not resolved further.
                Target::Module(to) if leaf.name.is_none() || self.blocks > 0 => {
                    self.import(to, &leaf.path, leaf.line, is_reexport);
                }
                _ => self.note(&leaf.path, leaf.line, is_reexport),
            }
        }
    }

    fn visit_block(&mut self, block: &'ast syn::Block) {
        self.blocks += 1;
        visit::visit_block(self, block);
        self.blocks -= 1;
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let segments: Vec<String> =
            path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        if path.leading_colon.is_none() {
            self.note_code(&segments, path.span().start().line);
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast syn::Macro) {
        self.note_tokens(call.tokens.clone());
        visit::visit_macro(self, call);
    }

    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        if let syn::Meta::List(list) = &attribute.meta {
            self.note_tokens(list.tokens.clone());
        }
    }
}

/// Returns the path in a string of an attribute, as in `#[serde(with = "crate::time::millis")]`.
fn path_in_text(literal: &str) -> Option<Vec<String>> {
    let text = literal.strip_prefix('"')?.strip_suffix('"')?;
    let path: Vec<String> = text.split("::").map(str::to_owned).collect();
    let is_name =
        |part: &String| !part.is_empty() && part.chars().all(|c| c.is_alphanumeric() || c == '_');
    (path.len() > 1 && path.iter().all(is_name)).then_some(path)
}

/// Returns the attributes of an item.
pub(crate) fn attributes_of(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::ExternCrate(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::ForeignMod(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::TraitAlias(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Union(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}
