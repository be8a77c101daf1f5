//! The journeys in ARCHITECTURE.md name modules and functions that are there.

use std::{collections::BTreeMap, fs};

use super::{committed, root};

/// Headings of the journeys.
const JOURNEYS: [&str; 2] = ["The journey of a value", "The journey of a request"];

/// A module that stands in a drawing more than once, with the reason.
struct Repeated {
    journey: &'static str,
    module: &'static str,
    times: usize,
    reason: &'static str,
}

const fn repeated(
    journey: &'static str,
    module: &'static str,
    times: usize,
    reason: &'static str,
) -> Repeated {
    Repeated { journey, module, times, reason }
}

/// Modules that stand in a drawing more than once; ARCHITECTURE.md names the same ones.
const REPEATED: [Repeated; 5] = [
    repeated(JOURNEYS[0], "engine::core", 2, "it calls the transform and takes its candidates"),
    repeated(JOURNEYS[0], "coordinator", 2, "it takes candidates at once and commits them later"),
    repeated(JOURNEYS[0], "transaction", 2, "the store is asked between its steps"),
    repeated(JOURNEYS[0], "in_flight", 3, "before and after the commit, and when a report leaves"),
    repeated(JOURNEYS[0], "apply", 2, "messages one by one, then the rows of all of them"),
];

/// A module with functions in brackets, as a journey names them.
#[derive(Debug)]
struct Step {
    module: String,
    functions: Vec<String>,
}

/// Returns the drawing below a heading.
fn drawing(document: &str, heading: &str) -> String {
    let part = document.split("\n## ").find(|part| part.starts_with(heading)).unwrap();
    part.split("```").nth(1).unwrap().to_owned()
}

/// Returns each `module (function, function)` of a drawing; several functions stand with commas or
/// arrows between them, and a star refers to the text below.
fn steps(drawing: &str) -> Vec<Step> {
    let mut steps = Vec::new();
    for (before, after) in drawing.match_indices(" (").map(|(at, _)| drawing.split_at(at)) {
        let module = before.rsplit([' ', '\n']).next().unwrap().to_owned();
        let inside = after.trim_start_matches(" (").split(')').next().unwrap();
        let names = inside.split([',', '─', '►']).map(|name| name.trim().trim_end_matches(" *"));
        let functions = names.filter(|name| !name.is_empty()).map(str::to_owned).collect();
        steps.push(Step { module, functions });
    }
    steps
}

/// Returns the sources of the modules whose path ends like this one, by package folder.
fn modules(path: &str) -> BTreeMap<String, String> {
    let path = path.replace("::", "/");
    let mut sources = BTreeMap::<String, String>::new();
    for file in committed("*.rs") {
        let Some((package, inner)) = file.split_once("/src/") else { continue };
        let inner = format!("/{inner}");
        let is_within =
            inner.ends_with(&format!("/{path}.rs")) || inner.contains(&format!("/{path}/"));
        let is_test = inner.contains("/tests/") || inner.ends_with("tests.rs");
        if is_within
            && !is_test
            && let Ok(source) = fs::read_to_string(root().join(&file))
        {
            sources.entry(package.to_owned()).or_default().push_str(&source);
        }
    }
    sources
}

/// Returns true where the source has the function: `name`, or `Type::name` beside an `impl` of it.
fn has_function(source: &str, function: &str) -> bool {
    let (of, name) =
        function.rsplit_once("::").map_or((None, function), |(of, name)| (Some(of), name));
    let is_there =
        [format!("fn {name}("), format!("fn {name}<")].iter().any(|start| source.contains(start));
    let is_of = |of: &str| {
        let mut blocks = source.lines().filter(|line| line.starts_with("impl"));
        blocks.any(|line| line.split(|c: char| !c.is_alphanumeric()).any(|word| word == of))
    };
    is_there && of.is_none_or(is_of)
}

#[test]
fn journeys_name_functions_where_they_are() {
    let document = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    for heading in JOURNEYS {
        let steps = steps(&drawing(&document, heading));
        assert!(steps.len() >= 9, "{heading}: {} steps were read", steps.len());
        for step in &steps {
            let modules = modules(&step.module);
            assert!(!modules.is_empty(), "{heading}: no module {}", step.module);
            let is_true = modules
                .values()
                .any(|source| step.functions.iter().all(|function| has_function(source, function)));
            assert!(is_true, "{heading}: {} has not all of {:?}", step.module, step.functions);
        }
    }
}

#[test]
fn a_module_stands_once_in_a_journey() {
    let document = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let mut unknown = Vec::new();
    let mut known: Vec<&Repeated> = REPEATED.iter().collect();
    for heading in JOURNEYS {
        let mut times = BTreeMap::<String, usize>::new();
        for step in steps(&drawing(&document, heading)) {
            *times.entry(step.module).or_default() += 1;
        }
        for (module, times) in times.into_iter().filter(|(_, times)| *times > 1) {
            let is_one = |one: &&Repeated| {
                one.journey == heading && one.module == module && one.times == times
            };
            match known.iter().position(is_one) {
                Some(at) => _ = known.remove(at),
                None => unknown.push(format!("{heading}: {module} stands {times} times")),
            }
        }
    }
    assert!(unknown.is_empty(), "{}", unknown.join("\n"));
    let unneeded =
        known.iter().map(|one| format!("{} in {}: {}", one.module, one.journey, one.reason));
    assert_eq!(unneeded.collect::<Vec<_>>(), [""; 0], "exceptions that nothing needs");
}

#[test]
fn a_function_in_another_module_is_found() {
    let drawing = "plant ─► gate (Gate::on ─► release *) ─► values (receive)";
    let named: Vec<(String, usize)> =
        steps(drawing).into_iter().map(|step| (step.module, step.functions.len())).collect();
    assert_eq!(named, [("gate".to_owned(), 2), ("values".to_owned(), 1)]);
    let source = "impl Gate {\n    pub fn on(&mut self) {}\n}\nfn release<T>() {}\n";
    assert!(has_function(source, "Gate::on") && has_function(source, "release"));
    assert!(!has_function(source, "Writer::on") && !has_function(source, "rel"));
}
