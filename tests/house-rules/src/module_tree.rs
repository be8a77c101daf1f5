//! Module trees: the modules of each compiled root, the names they define and the names they
//! import.

use std::collections::{BTreeMap, BTreeSet};

use syn::{Attribute, Item, UseTree, Visibility, spanned::Spanned as _};

use crate::package::{Package, Role};

/// Index of a module in [`ModuleTree::modules`].
pub(crate) type ModuleId = usize;

/// The modules of all roots of a package.
#[derive(Debug, Default)]
pub(crate) struct ModuleTree {
    pub(crate) modules: Vec<Module>,
}

/// One module: a file, or a block inside a file.
#[derive(Debug)]
pub(crate) struct Module {
    /// Path from the root, for instance `link::cursor`; empty for the root.
    pub(crate) path: String,
    pub(crate) root: ModuleId,
    pub(crate) parent: Option<ModuleId>,
    /// Index in [`Package::files`].
    pub(crate) file: usize,
    pub(crate) is_test: bool,
    pub(crate) children: BTreeMap<String, ModuleId>,
    /// Defined names with their module: another one only for exported macros, which live in the
    /// root.
    pub(crate) items: BTreeMap<String, ModuleId>,
    /// Imported names with the path they stand for.
    pub(crate) bindings: BTreeMap<String, Vec<String>>,
    /// Names among the bindings that are passed on (`pub use`).
    pub(crate) reexports: BTreeSet<String>,
    /// Paths imported with `*`.
    pub(crate) globs: Vec<Vec<String>>,
}

/// One name of a `use` item.
#[derive(Debug)]
pub(crate) struct UseLeaf {
    pub(crate) path: Vec<String>,
    /// Name in scope; `None` for `*`.
    pub(crate) name: Option<String>,
    pub(crate) line: usize,
}

impl ModuleTree {
    pub(crate) fn of(package: &Package) -> Self {
        let mut tree = Self::default();
        for (file, source) in package.files.iter().enumerate() {
            if source.is_root() {
                let is_test = source.role == Role::Test;
                let root = tree.add("", None, file, is_test);
                tree.read_items(package, root, &source.syntax.items, &folder_of(&source.inner));
            }
        }
        tree
    }

    /// Returns the module that a file is, not one of the blocks inside.
    pub(crate) fn module_of_file(&self, file: usize) -> Option<ModuleId> {
        self.modules.iter().position(|module| module.file == file)
    }

    fn add(
        &mut self,
        path: &str,
        parent: Option<ModuleId>,
        file: usize,
        is_test: bool,
    ) -> ModuleId {
        let id = self.modules.len();
        self.modules.push(Module {
            path: path.to_owned(),
            root: parent.map_or(id, |parent| self.modules[parent].root),
            parent,
            file,
            is_test,
            children: BTreeMap::new(),
            items: BTreeMap::new(),
            bindings: BTreeMap::new(),
            reexports: BTreeSet::new(),
            globs: Vec::new(),
        });
        id
    }

    /// Reads what a module declares; `folder` is where its child modules have their files.
    fn read_items(&mut self, package: &Package, module: ModuleId, items: &[Item], folder: &str) {
        for item in items {
            match item {
                Item::Mod(child) => self.read_child(package, module, child, folder),
                Item::Use(import) => {
                    let is_reexport = is_passed_on(&import.vis);
                    for leaf in use_leaves(&import.tree) {
                        let scope = &mut self.modules[module];
                        match leaf.name {
                            None => scope.globs.push(leaf.path),
                            Some(name) => {
                                if is_reexport {
                                    scope.reexports.insert(name.clone());
                                }
                                scope.bindings.insert(name, leaf.path);
                            }
                        }
                    }
                }
                Item::Macro(definition) => {
                    let Some(name) = &definition.ident else { continue };
                    self.modules[module].items.insert(name.to_string(), module);
                    if has_attribute(&definition.attrs, "macro_export") {
                        let root = self.modules[module].root;
                        self.modules[root].items.insert(name.to_string(), module);
                    }
                }
                other => {
                    if let Some(name) = item_name(other) {
                        self.modules[module].items.insert(name, module);
                    }
                }
            }
        }
    }

    fn read_child(
        &mut self,
        package: &Package,
        parent: ModuleId,
        child: &syn::ItemMod,
        folder: &str,
    ) {
        let name = child.ident.to_string();
        let Module { path: parent_path, file: parent_file, is_test, .. } = &self.modules[parent];
        let path =
            if parent_path.is_empty() { name.clone() } else { format!("{parent_path}::{name}") };
        let is_test = *is_test || is_test_only(&child.attrs) || name == "tests";
        let parent_file = *parent_file;
        let below = format!("{folder}/{name}");
        let (file, items) = if let Some((_, items)) = &child.content {
            (parent_file, items)
        } else {
            let inner = |inner: String| {
                package.files.iter().position(|file| file.inner == inner.trim_start_matches('/'))
            };
            let found = match path_attribute(&child.attrs) {
                Some(path) => inner(joined(&folder_of(&package.files[parent_file].inner), &path)),
                None => inner(format!("{below}.rs")).or_else(|| inner(format!("{below}/mod.rs"))),
            };
            // Absent: generated, or for another platform.
            let Some(file) = found else { return };
            (file, &package.files[file].syntax.items)
        };
        let id = self.add(&path, Some(parent), file, is_test);
        self.modules[parent].children.insert(name, id);
        self.read_items(package, id, items, &below);
    }
}

/// Lists the names that a `use` tree imports.
pub(crate) fn use_leaves(tree: &UseTree) -> Vec<UseLeaf> {
    let mut leaves = Vec::new();
    collect_leaves(tree, &mut Vec::new(), &mut leaves);
    leaves
}

fn collect_leaves(tree: &UseTree, prefix: &mut Vec<String>, leaves: &mut Vec<UseLeaf>) {
    let line = tree.span().start().line;
    let mut leaf = |path: &[String], name: Option<String>| {
        leaves.push(UseLeaf { path: path.to_vec(), name, line });
    };
    match tree {
        UseTree::Path(path) => {
            prefix.push(path.ident.to_string());
            collect_leaves(&path.tree, prefix, leaves);
            prefix.pop();
        }
        UseTree::Name(name) if name.ident == "self" => leaf(prefix, prefix.last().cloned()),
        UseTree::Name(name) => {
            let name = name.ident.to_string();
            leaf(&[prefix.as_slice(), std::slice::from_ref(&name)].concat(), Some(name));
        }
        UseTree::Rename(rename) if rename.ident == "self" => {
            leaf(prefix, Some(rename.rename.to_string()));
        }
        UseTree::Rename(rename) => {
            let path = [prefix.as_slice(), &[rename.ident.to_string()]].concat();
            leaf(&path, Some(rename.rename.to_string()));
        }
        UseTree::Glob(_) => leaf(prefix, None),
        UseTree::Group(group) => {
            for tree in &group.items {
                collect_leaves(tree, prefix, leaves);
            }
        }
    }
}

/// True for `#[cfg(test)]`, `#[cfg(all(test, ...))]`, `#[test]` and `#[tokio::test]`.
pub(crate) fn is_test_only(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let path = attribute.path();
        if path.is_ident("cfg") {
            let mut is_test = false;
            // Conditions that are no lists of paths are those of other features: not for tests.
            let _ = attribute.parse_nested_meta(|meta| {
                if meta.path.is_ident("test") {
                    is_test = true;
                } else if meta.path.is_ident("all") {
                    meta.parse_nested_meta(|meta| {
                        is_test |= meta.path.is_ident("test");
                        let _ = meta.value().and_then(|value| value.parse::<syn::Lit>());
                        Ok(())
                    })?;
                }
                Ok(())
            });
            return is_test;
        }
        path.segments.last().is_some_and(|segment| segment.ident == "test")
    })
}

/// True for `pub use`, however far it is visible.
pub(crate) fn is_passed_on(visibility: &Visibility) -> bool {
    !matches!(visibility, Visibility::Inherited)
}

fn has_attribute(attributes: &[Attribute], name: &str) -> bool {
    attributes.iter().any(|attribute| attribute.path().is_ident(name))
}

fn path_attribute(attributes: &[Attribute]) -> Option<String> {
    let attribute = attributes.iter().find(|attribute| attribute.path().is_ident("path"))?;
    let syn::Meta::NameValue(value) = &attribute.meta else { return None };
    let syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }) = &value.value else {
        return None;
    };
    Some(text.value())
}

fn item_name(item: &Item) -> Option<String> {
    Some(match item {
        Item::Const(item) => item.ident.to_string(),
        Item::Enum(item) => item.ident.to_string(),
        Item::Fn(item) => item.sig.ident.to_string(),
        Item::Static(item) => item.ident.to_string(),
        Item::Struct(item) => item.ident.to_string(),
        Item::Trait(item) => item.ident.to_string(),
        Item::Type(item) => item.ident.to_string(),
        Item::Union(item) => item.ident.to_string(),
        _ => return None,
    })
}

fn folder_of(inner: &str) -> String {
    inner.rsplit_once('/').map_or_else(String::new, |(folder, _)| folder.to_owned())
}

/// Joins a folder and a relative path, going up for each `..`.
fn joined(folder: &str, path: &str) -> String {
    let mut parts: Vec<&str> = folder.split('/').collect();
    for part in path.split('/') {
        match part {
            ".." => _ = parts.pop(),
            "." => {}
            part => parts.push(part),
        }
    }
    parts.join("/")
}
