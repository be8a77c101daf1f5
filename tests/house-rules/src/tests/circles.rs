//! Imports that are a circle, and those that are none.

use super::*;

fn circles(sources: &[(&str, &str)]) -> Vec<String> {
    found(Rule::ImportCircle, sources)
}

#[test]
fn imports_there_and_back_are_a_circle() {
    let circles = circles(&[
        ("src/lib.rs", "mod a; mod b;"),
        ("src/a.rs", "use crate::b::B;\npub struct A(B);"),
        ("src/b.rs", "pub struct B;\nfn f() { super::a::A::new(); }"),
    ]);
    assert_eq!(
        circles,
        ["src/a.rs:1 circle of 2 files:\n    \
          src/a.rs:1: crate::b::B -> src/b.rs\n    \
          src/b.rs:2: super::a::A::new -> src/a.rs"]
    );
}

#[test]
fn a_circle_over_three_files_is_one_finding() {
    let circles = circles(&[
        ("src/lib.rs", "mod a; mod b; mod c; mod d;"),
        ("src/a.rs", "use crate::b::B; pub struct A;"),
        ("src/b.rs", "use crate::c::C; pub struct B;"),
        ("src/c.rs", "use crate::a::A; pub struct C;"),
        ("src/d.rs", "use crate::a::A; use crate::c::C;"),
    ]);
    assert_eq!(circles.len(), 1);
    assert!(circles[0].starts_with("src/a.rs:1 circle of 3 files"), "{}", circles[0]);
}

#[test]
fn a_parent_that_uses_its_child_and_is_used_by_it_is_a_circle() {
    let child = ("src/a/child.rs", "use super::A;\npub struct Child(A);");
    for parent in [
        "mod child; use child::Child; pub struct A; fn f(_: Child) {}",
        "mod child; pub use child::Child; pub struct A; fn f(_: Child) {}",
        "mod child; pub struct A; fn f() { child::Child::new() }",
        "mod child; pub struct A; fn f() { log!(child::Child::new(1)) }",
    ] {
        let sources = [("src/lib.rs", "mod a;"), ("src/a.rs", parent), child];
        assert_eq!(circles(&sources).len(), 1, "{parent}");
    }
}

#[test]
fn reexports_declarations_and_tests_are_no_imports() {
    let child = ("src/a/child.rs", "use super::A;\npub struct Child(A);");
    for parent in [
        "mod child; pub struct A;",
        "mod child; pub use child::Child; pub struct A;",
        "pub mod child; pub(crate) use self::child::*; pub struct A;",
        "mod child; pub struct A; #[cfg(test)] mod tests { use super::child::Child; }",
        "mod child; pub struct A; #[cfg(all(test, unix))] fn f() { child::f() }",
        "mod child; pub struct A; impl A { #[cfg(test)] fn f() { child::f() } }",
    ] {
        let sources = [("src/lib.rs", "mod a; pub use a::A;"), ("src/a.rs", parent), child];
        assert_eq!(circles(&sources), [""; 0], "{parent}");
    }
}

#[test]
fn modules_that_import_each_other_through_different_files_are_a_circle() {
    let circles = found(
        Rule::ModuleCircle,
        &[
            ("src/lib.rs", "mod a; mod b;"),
            ("src/a.rs", "mod one; mod two;"),
            ("src/a/one.rs", "use crate::b::B; use super::two::Two; pub struct One(B, Two);"),
            ("src/a/two.rs", "pub struct Two;"),
            ("src/b.rs", "mod deep; pub struct B;"),
            ("src/b/deep.rs", "use crate::a::two::Two;\npub struct Deep(Two);"),
        ],
    );
    assert_eq!(
        circles,
        ["src/a/one.rs:1 circle of 2 modules:\n    \
          src/a/one.rs:1: crate::b::B -> src/b.rs\n    \
          src/b/deep.rs:1: crate::a::two::Two -> src/a/two.rs"]
    );
}

#[test]
fn imports_one_way_from_above_and_by_tests_are_no_circle_of_modules() {
    let circles = found(
        Rule::ModuleCircle,
        &[
            ("src/lib.rs", "mod a; mod b; use a::two::Two; use b::B;"),
            ("src/a.rs", "mod one; pub mod two; use crate::b::B; pub struct A(B);"),
            ("src/a/one.rs", "use crate::b::B; use super::{A, two::Two}; pub struct One(B, Two);"),
            ("src/a/two.rs", "pub struct Two;"),
            ("src/b.rs", "pub struct B; #[cfg(test)] mod tests { use crate::a::two::Two; }"),
        ],
    );
    assert_eq!(circles, [""; 0]);
}

#[test]
fn files_of_tests_make_no_circle() {
    let sources = [
        ("src/lib.rs", "mod a;"),
        ("src/a.rs", "#[cfg(test)] mod samples; #[cfg(test)] mod tests; pub struct A;"),
        ("src/a/samples.rs", "use super::{A, tests::T};"),
        ("src/a/tests.rs", "use super::{A, samples::S};"),
    ];
    assert_eq!(circles(&sources), [""; 0]);
}

#[test]
fn an_import_through_a_reexport_leads_to_the_file_that_defines() {
    // `a` takes B from the facade, which imports nothing of `a`.
    let sources = [
        ("src/lib.rs", "mod facade; mod a;"),
        ("src/facade.rs", "mod b; mod c; pub use b::B; pub use c::C;"),
        ("src/facade/b.rs", "pub struct B;"),
        ("src/facade/c.rs", "use crate::a::A; pub struct C(A);"),
        ("src/a.rs", "use crate::facade::B; pub struct A(B);"),
    ];
    assert_eq!(circles(&sources), [""; 0]);
    let sources = [
        sources[0],
        sources[1],
        sources[2],
        sources[3],
        ("src/a.rs", "use crate::facade; pub struct A(facade::C);"),
    ];
    let circles = circles(&sources);
    assert_eq!(circles.len(), 1);
    assert!(circles[0].contains("src/a.rs:1: facade::C -> src/facade/c.rs"), "{}", circles[0]);
}

#[test]
fn renames_globs_and_attributes_are_followed() {
    for b in [
        "use crate::a::A as Other; pub struct B;",
        "use crate::a::*; pub struct B;",
        "#[derive(Serialize)] pub struct B { #[serde(with = \"crate::a::millis\")] at: u64 }",
        "pub struct B; fn f() { use crate::a; a::f() }",
    ] {
        let sources = [
            ("src/lib.rs", "mod a; mod b;"),
            ("src/a.rs", "use crate::b::B; pub struct A;"),
            ("src/b.rs", b),
        ];
        assert_eq!(circles(&sources).len(), 1, "{b}");
    }
}

#[test]
fn a_function_may_bear_the_name_of_a_module() {
    let sources = [
        ("src/lib.rs", "mod a; mod b;"),
        ("src/a.rs", "mod run; use crate::b::B; pub fn run() { run::all() }"),
        ("src/a/run.rs", "pub fn all() {}"),
        ("src/b.rs", "use crate::a::run::all; pub struct B;"),
    ];
    assert_eq!(circles(&sources), [""; 0]);
}
