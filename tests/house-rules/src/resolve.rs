//! Name resolution, as far as imports need it: from a path in a module to the module that defines
//! it.

use crate::module_tree::{ModuleId, ModuleTree};

/// Bound on chains of imports and globs, which may be circular.
const DEPTH_MAX: usize = 16;

/// Meaning of a path.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Target {
    /// A module of this package.
    Module(ModuleId),
    /// An item, or something of it; with the module that defines the item.
    Item(ModuleId),
    /// A path of another crate, or a name of a local scope.
    External(Vec<String>),
}

impl ModuleTree {
    /// Resolves `path` as written in `module`, through imports and re-exports to the deepest module
    /// that exists.
    pub(crate) fn resolve(&self, module: ModuleId, path: &[String]) -> Target {
        self.resolve_at(module, path, 0)
    }

    fn resolve_at(&self, module: ModuleId, path: &[String], depth: usize) -> Target {
        let external = || Target::External(path.to_vec());
        if depth > DEPTH_MAX {
            return external();
        }
        let (mut at, mut next) = (module, 0);
        while let Some(segment) = path.get(next) {
            match segment.as_str() {
                "crate" | "$crate" if next == 0 => at = self.modules[at].root,
                "self" if next == 0 => {}
                "super" => match self.modules[at].parent {
                    Some(parent) => at = parent,
                    None => return external(),
                },
                _ => break,
            }
            next += 1;
        }
        let is_anchored = next > 0;
        let rest = &path[next..];
        if rest.is_empty() {
            return Target::Module(at);
        }
        match self.lookup(at, rest, depth) {
            Some(target) => target,
            // Written by a macro: the deepest module that exists.
            None if is_anchored => Target::Item(at),
            None => external(),
        }
    }

    /// Resolves the path inside one module; `None` when the module knows no such name.
    fn lookup(&self, module: ModuleId, path: &[String], depth: usize) -> Option<Target> {
        if depth > DEPTH_MAX {
            return None;
        }
        let (name, rest) = path.split_first()?;
        let scope = &self.modules[module];
        let item = || scope.items.get(name).map(|module| Target::Item(*module));
        let child = || {
            let child = *scope.children.get(name)?;
            if rest.is_empty() {
                return Some(Target::Module(child));
            }
            Some(self.lookup(child, rest, depth + 1).unwrap_or(Target::Item(child)))
        };
        let binding = || {
            let import = scope.bindings.get(name)?;
            // `use rand;` stands for the crate of that name, `pub(crate) use a_macro;` for an item.
            if import.len() == 1 && import[0] == *name {
                return Some(Target::External(path.to_vec()));
            }
            let whole: Vec<String> = import.iter().chain(rest).cloned().collect();
            Some(self.resolve_at(module, &whole, depth + 1))
        };
        let glob = || {
            scope.globs.iter().find_map(|glob| {
                let Target::Module(imported) = self.resolve_at(module, glob, depth + 1) else {
                    return None;
                };
                (imported != module).then(|| self.lookup(imported, path, depth + 1)).flatten()
            })
        };
        // A module and a function may share a name; what follows `::` is in the module.
        if rest.is_empty() {
            item().or_else(binding).or_else(child).or_else(glob)
        } else {
            child().or_else(binding).or_else(item).or_else(glob)
        }
    }
}
