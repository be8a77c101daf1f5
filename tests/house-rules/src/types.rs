//! Size of types: fields, methods, and over how many files the methods are spread.

use std::collections::{BTreeMap, BTreeSet};

use syn::{Attribute, Field, Ident, ImplItem, Item, ReceiverKind, Type, visit::Visit};

use crate::{
    finding::{Finding, Rule},
    imports::ImportGraph,
    module_tree::{ModuleId, is_test_only},
    package::Package,
    resolve::Target,
};

/// Files that may hold inherent methods of one type.
const IMPL_FILES_MAX: usize = 3;
const FIELDS_MAX: usize = 12;
const METHODS_MAX: usize = 40;
/// Derives of types that copy a document, a row or a command line: their size is not ours to choose
/// as long as they are nothing but data.
const WIRE_DERIVES: [&str; 6] =
    ["Serialize", "Deserialize", "ToSchema", "JsonSchema", "Parser", "Args"];

/// Types of fields by which a value holds state that others change, or talks to others; the atomic
/// types are found by their prefix.
const HOLDERS: [&str; 15] = [
    "Mutex",
    "RwLock",
    "Cell",
    "RefCell",
    "OnceCell",
    "OnceLock",
    "LazyLock",
    "UnsafeCell",
    "Sender",
    "Receiver",
    "UnboundedSender",
    "UnboundedReceiver",
    "JoinHandle",
    "Notify",
    "Semaphore",
];

/// A type that may be larger, with the reason.
#[derive(Debug, Clone, Copy)]
pub struct Exemption {
    pub package: &'static str,
    pub type_name: &'static str,
    pub reason: &'static str,
}

/// Type by the file that defines it and its name.
type TypeKey = (usize, String);

/// Inherent methods of one type, and whether any method changes it.
#[derive(Default)]
struct Methods {
    count: usize,
    files: BTreeSet<usize>,
    /// True where one of them, or one of a trait, takes the type as `&mut self`.
    has_change: bool,
}

/// Reports types whose methods are spread over too many files.
pub(crate) fn check_spread(package: &Package, graph: &ImportGraph) -> Vec<Finding> {
    let mut findings = Vec::new();
    for ((file, name), methods) in methods_of_types(package, graph) {
        if methods.files.len() > IMPL_FILES_MAX {
            let files: Vec<&str> =
                methods.files.iter().map(|file| graph.files[*file].as_str()).collect();
            findings.push(Finding {
                file: graph.files[file].clone(),
                line: 1,
                rule: Rule::ImplSpread,
                text: format!(
                    "methods of `{name}` are in {} files, at most {IMPL_FILES_MAX} are allowed: {}",
                    files.len(),
                    files.join(", ")
                ),
            });
        }
    }
    findings
}

/// Reports types with too many fields or methods, and exemptions that no type needs. Types of the
/// wire and of configuration may have as many fields as their document: those that derive it, hold
/// no state by a field, and that no method changes.
#[must_use]
pub fn check_type_sizes(package: &Package, exemptions: &[Exemption]) -> Vec<Finding> {
    let graph = ImportGraph::of(package);
    let methods = methods_of_types(package, &graph);
    let mut large: BTreeMap<TypeKey, Vec<Finding>> = BTreeMap::new();
    let mut report = |key: &TypeKey, line: usize, what: &str, count: usize, max: usize| {
        if count > max {
            large.entry(key.clone()).or_default().push(Finding {
                file: graph.files[key.0].clone(),
                line,
                rule: Rule::TypeSize,
                text: format!("`{}` has {count} {what}, at most {max} are allowed", key.1),
            });
        }
    };
    for (index, file) in package.files.iter().enumerate() {
        if graph.is_test_file(index) {
            continue;
        }
        for item in &file.syntax.items {
            let Item::Struct(item) = item else { continue };
            let key = (index, item.ident.to_string());
            let has_change = methods.get(&key).is_some_and(|methods| methods.has_change);
            if !is_wire(&item.attrs) || has_change || item.fields.iter().any(holds_state) {
                let line = item.ident.span().start().line;
                report(&key, line, "fields", item.fields.len(), FIELDS_MAX);
            }
        }
    }
    for (key, methods) in &methods {
        report(key, 1, "methods", methods.count, METHODS_MAX);
    }
    let mut exempted: Vec<&Exemption> =
        exemptions.iter().filter(|exemption| exemption.package == package.name).collect();
    let mut findings = Vec::new();
    for ((_, name), reports) in large {
        let before = exempted.len();
        exempted.retain(|exemption| exemption.type_name != name);
        if exempted.len() == before {
            findings.extend(reports);
        }
    }
    findings.extend(exempted.into_iter().map(|exemption| Finding {
        file: graph.files.first().cloned().unwrap_or_default(),
        line: 1,
        rule: Rule::TypeSize,
        text: format!("`{}` needs no exemption", exemption.type_name),
    }));
    findings
}

fn is_wire(attributes: &[Attribute]) -> bool {
    attributes.iter().filter(|attribute| attribute.path().is_ident("derive")).any(|derive| {
        let mut is_wire = false;
        // A derive is a list of paths, or the compiler has reported it.
        let _ = derive.parse_nested_meta(|meta| {
            let name = meta.path.segments.last().map(|last| last.ident.to_string());
            is_wire |= name.is_some_and(|name| WIRE_DERIVES.contains(&name.as_str()));
            Ok(())
        });
        is_wire
    })
}

/// True for a field of a type that is, or contains, a lock, a cell or an end of a channel.
fn holds_state(field: &Field) -> bool {
    struct Finder(bool);
    impl<'ast> Visit<'ast> for Finder {
        fn visit_ident(&mut self, ident: &'ast Ident) {
            let name = ident.to_string();
            self.0 |= HOLDERS.contains(&name.as_str()) || name.starts_with("Atomic");
        }
    }
    let mut finder = Finder(false);
    finder.visit_type(&field.ty);
    finder.0
}

fn methods_of_types(package: &Package, graph: &ImportGraph) -> BTreeMap<TypeKey, Methods> {
    let mut methods = BTreeMap::new();
    for (id, module) in graph.tree.modules.iter().enumerate() {
        let is_file = module.parent.is_none_or(|up| graph.tree.modules[up].file != module.file);
        if is_file && !module.is_test {
            collect(graph, id, &package.files[module.file].syntax.items, &mut methods);
        }
    }
    methods
}

fn collect(
    graph: &ImportGraph,
    module: ModuleId,
    items: &[Item],
    methods: &mut BTreeMap<TypeKey, Methods>,
) {
    for item in items {
        let Item::Impl(block) = item else { continue };
        let Type::Path(of) = &*block.self_ty else { continue };
        if is_test_only(&block.attrs) {
            continue;
        }
        let path: Vec<String> =
            of.path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        let (Target::Item(definer), Some(name)) = (graph.tree.resolve(module, &path), path.last())
        else {
            continue;
        };
        let file = graph.tree.modules[module].file;
        let of = methods.entry((graph.tree.modules[definer].file, name.clone())).or_default();
        of.has_change |= block.items.iter().any(is_change);
        if block.trait_.is_none() {
            of.files.insert(file);
            of.count += block.items.iter().filter(|item| matches!(item, ImplItem::Fn(_))).count();
        }
    }
}

/// True for a method that takes `&mut self`.
fn is_change(item: &ImplItem) -> bool {
    let ImplItem::Fn(function) = item else { return false };
    let receiver = function.sig.receiver();
    // `mut self` is a value that its owner gave away.
    receiver.is_some_and(|receiver| matches!(receiver.kind, ReceiverKind::Reference(_, _, Some(_))))
}
