//! Names that several types share.

use std::collections::BTreeSet;

use crate::{DeclaredTypes, Package, SharedName, check_type_names};

fn types(name: &str, dependencies: &[&str], source: &str) -> DeclaredTypes {
    let mut package = Package::from_sources(name, &[("src/lib.rs", source)]).unwrap();
    package.dependencies =
        dependencies.iter().map(|name| (*name).to_owned()).collect::<BTreeSet<_>>();
    DeclaredTypes::of(&package)
}

fn found(packages: &[DeclaredTypes], shared: &[SharedName]) -> Vec<String> {
    check_type_names(packages, shared).into_iter().map(|finding| finding.text).collect()
}

#[test]
fn a_name_is_shared_where_one_package_meets_both_types() {
    let model =
        || types("model", &["serde"], "pub struct Node; struct Inner; pub(crate) enum E {}");
    let twin =
        |dependencies| types("twin", dependencies, "pub trait Node {} struct Inner; pub enum E {}");
    assert_eq!(found(&[model(), twin(&[])], &[]), [""; 0]);
    assert_eq!(found(&[model(), twin(&["model"])], &[]).len(), 2);
    let daemon = types("daemon", &["model", "twin"], "");
    assert_eq!(found(&[model(), twin(&[]), daemon], &[]).len(), 2);
    let twice = types(
        "a",
        &[],
        "pub struct A;\n#[cfg(test)] pub struct B;\npub struct B;\npub type A = B;",
    );
    assert_eq!(
        found(&[twice], &[]),
        ["`A` is another type in src/lib.rs:4", "`A` is another type in src/lib.rs:1"]
    );
}

#[test]
fn a_private_type_shares_no_name_with_a_type_that_its_package_meets() {
    let source = "struct Session; mod inner;";
    let private = |dependencies| types("connector", dependencies, source);
    let public = || types("floor", &[], "pub struct Session;");
    assert_eq!(found(&[private(&[]), public()], &[]), [""; 0]);
    assert_eq!(found(&[private(&["floor"]), public()], &[]).len(), 2);
    // A private one of another package is not met.
    let hidden = types("floor", &[], "struct Session;");
    assert_eq!(found(&[private(&["floor"]), hidden], &[]), [""; 0]);
    let twice = types("a", &[], "struct State;\npub(crate) enum State {}");
    assert_eq!(found(&[twice], &[]).len(), 2);
}

#[test]
fn listed_names_may_be_shared_and_must_be() {
    const SHARED: &[SharedName] = &[SharedName { name: "Node", reason: "a test" }];
    let packages = || [types("a", &["b"], "pub struct Node;"), types("b", &[], "pub struct Node;")];
    assert_eq!(found(&packages(), SHARED), [""; 0]);
    assert_eq!(found(&packages()[..1], SHARED), ["`Node` is listed as shared and is not"]);
}

#[test]
fn dependencies_are_those_of_the_build() {
    let package = Package::read(std::path::Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap();
    let names: Vec<&str> = package.dependencies.iter().map(String::as_str).collect();
    assert_eq!(names, ["proc-macro2", "syn", "thiserror"]);
}
