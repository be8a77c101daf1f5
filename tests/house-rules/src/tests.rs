//! Tiny packages, each with what a rule must find or must not find.

mod circles;
mod type_names;
mod types;
mod vocabulary;

use crate::{Finding, Package, Rule, Wall, check, check_walls};

fn package(sources: &[(&str, &str)]) -> Package {
    Package::from_sources("demo", sources).unwrap()
}

/// Findings of one rule as `file:line text`.
fn found(rule: Rule, sources: &[(&str, &str)]) -> Vec<String> {
    texts(check(&package(sources)), rule)
}

fn texts(findings: Vec<Finding>, rule: Rule) -> Vec<String> {
    findings
        .into_iter()
        .filter(|finding| finding.rule == rule)
        .map(|finding| format!("{}:{} {}", finding.file, finding.line, finding.text))
        .collect()
}

#[test]
fn walls_hold_for_modules_below_and_for_other_crates() {
    const WALLS: &[Wall] = &[
        Wall { package: "demo", from: "state", to: "store", reason: "state is pure" },
        Wall { package: "demo", from: "state", to: "::std::time::SystemTime", reason: "no clock" },
        Wall { package: "other", from: "x", to: "y", reason: "of another package" },
        Wall { package: "demo", from: "state", to: "gone", reason: "stale" },
    ];
    let package = package(&[
        ("src/lib.rs", "mod state; mod store; mod stores;"),
        ("src/state.rs", "mod field; use crate::stores::X;"),
        (
            "src/state/field.rs",
            "use crate::store::Row;\nuse std::time::{Duration, SystemTime};\npub use crate::store::Row as R;",
        ),
        ("src/store.rs", "use crate::state::S; pub struct Row;"),
        ("src/stores.rs", "pub struct X;"),
    ]);
    assert_eq!(
        texts(check_walls(&package, WALLS), Rule::ModuleWall),
        [
            "src/lib.rs:1 a wall names the module gone, which demo has not",
            "src/state/field.rs:1 state imports crate::store::Row: state is pure",
            "src/state/field.rs:2 state imports std::time::SystemTime: no clock",
            "src/state/field.rs:3 state imports crate::store::Row: state is pure",
        ]
    );
}

#[test]
fn docs_begin_with_a_noun_or_a_verb() {
    let source = "//! What is here.\n\n/// Returns one.\n/// When the line goes on.\nfn a() {}\n\
                  /// Whether it is so.\nfn b() {}\n/// Whatever.\n///\n/// # Errors\n\
                  /// When it fails.\nfn c() {}\n// Why this is a comment of the code.\n\
                  /// what begins small.\nfn d() {}\n/// If\n/// it is.\nfn e() {}\n\
                  /// Until when it holds.\nfn f() {}\n/// Until then.\nfn g() {}\n\
                  /// It fails.\nfn h() {}\n/// Of the first.\nenum E {\n    /// Of the second.\n    \
                  A,\n    /// Only one.\n    B,\n}\n/// Fails.\n///\n/// # Errors\n/// As `h`.\nfn i() {}\n";
    assert_eq!(
        found(Rule::OpeningWord, &[("src/lib.rs", source)]),
        [
            "src/lib.rs:1 begins with \"What\": begin with a noun or a verb of doing",
            "src/lib.rs:6 begins with \"Whether\": begin with a noun or a verb of doing",
            "src/lib.rs:16 begins with \"If\": begin with a noun or a verb of doing",
            "src/lib.rs:19 begins with \"Until\": begin with a noun or a verb of doing",
            "src/lib.rs:23 begins with \"It\": begin with a noun or a verb of doing",
            "src/lib.rs:25 begins with \"Of\": begin with a noun or a verb of doing",
            "src/lib.rs:29 begins with \"Only\": begin with a noun or a verb of doing",
        ]
    );
}

#[test]
fn docs_inside_macros_and_below_headings_are_read() {
    let source = "step! {\n/// How much.\nA = 1,\n/// Part.\n/// Where it goes on.\nB\n}\n\
                  fn f() { g! { [/** Why not. */ c] } }\n/// Runs.\n///\n/// # Errors\n///\n\
                  /// How long to wait.\n/// Which goes on.\nfn h() {}\n";
    assert_eq!(
        found(Rule::OpeningWord, &[("src/lib.rs", source)]),
        [
            "src/lib.rs:2 begins with \"How\": begin with a noun or a verb of doing",
            "src/lib.rs:8 begins with \"Why\": begin with a noun or a verb of doing",
            "src/lib.rs:13 begins with \"How\": begin with a noun or a verb of doing"
        ]
    );
}

#[test]
fn every_file_but_tests_and_main_has_a_header() {
    let sources = [
        ("src/lib.rs", "mod a; mod b; #[cfg(test)] mod samples;"),
        ("src/a.rs", "/// One.\npub struct A;"),
        ("src/b.rs", "//! Second part.\n"),
        ("src/samples.rs", ""),
        ("src/a/tests.rs", ""),
        ("src/main.rs", "fn main() {}"),
        ("tests/it/main.rs", ""),
    ];
    assert_eq!(
        found(Rule::MissingHeader, &sources),
        [
            "src/a.rs:1 the file begins with no //! header",
            "src/lib.rs:1 the file begins with no //! header"
        ]
    );
}

#[test]
fn docs_of_members_say_more_than_their_names() {
    let source = "/// Of two.\nstruct A {\n/// When.\nat: u8,\n/// In milliseconds since 1970.\n\
                  b: u8,\nc: u8 }\nenum E {\n/// The repository.\nA,\n/// Of a time, in seconds.\nB,\n\
                  /// The store of networks.\nC(NetworkStore),\n/// Its store, in bytes.\nD(Store),\n}\n\
                  struct S {\n/// Time of its creation.\ncreated_at: u8 }";
    assert_eq!(
        found(Rule::ShortMemberDoc, &[("src/lib.rs", source)]),
        [
            "src/lib.rs:3 \"When.\" says no more than the member's name",
            "src/lib.rs:9 \"The repository.\" says no more than the member's name",
            "src/lib.rs:13 \"The store of networks.\" says no more than the member's name",
            "src/lib.rs:19 \"Time of its creation.\" says no more than the member's name"
        ]
    );
}

#[test]
fn public_items_of_libraries_have_docs() {
    let source = "//! Library.\npub mod b { pub fn inner() {} }\npub fn a() {}\npub(crate) fn c() {}\n\
                  /// Documented.\npub struct S { pub at: u8 }\nimpl S {\npub fn new() {} }\n\
                  impl Clone for S { fn clone(&self) {} }\n#[doc(hidden)]\npub fn hidden() {}\n\
                  mod p { pub fn unseen() {} }\n#[cfg(test)]\npub fn for_tests() {}";
    assert_eq!(
        found(Rule::MissingDoc, &[("src/lib.rs", source), ("src/main.rs", "pub fn free() {}")]),
        [
            "src/lib.rs:2 `inner` is public and has no docs",
            "src/lib.rs:3 `a` is public and has no docs",
            "src/lib.rs:8 `new` is public and has no docs"
        ]
    );
}

#[test]
fn files_and_functions_have_bounds() {
    let (fits, long) =
        (format!("fn f() {{{}}}", "\n".repeat(79)), format!("fn g() {{{}}}", "\n".repeat(80)));
    let source = format!("{fits}\n{long}\n");
    assert_eq!(
        found(Rule::FunctionLength, &[("src/lib.rs", &source)]),
        ["src/lib.rs:81 `g` has 81 lines, at most 80 are allowed"]
    );
    let (fits, long) = ("\n".repeat(400), "\n".repeat(401));
    assert_eq!(
        found(Rule::FileLength, &[("src/a.rs", &fits), ("tests/b.rs", &long)]),
        ["tests/b.rs:401 the file has 401 lines, at most 400 are allowed"]
    );
    let generated = format!("// @generated by a program\n{long}");
    assert_eq!(found(Rule::FileLength, &[("src/a.rs", &generated)]), [""; 0]);
}

#[test]
fn methods_of_a_type_stay_in_three_files() {
    let part = "use super::A; impl A { fn f() {} }";
    let mut sources = vec![
        ("src/lib.rs", "mod a;"),
        ("src/a.rs", "mod b; mod c; mod d; pub struct A; impl A { fn f() {} }"),
        ("src/a/b.rs", part),
        ("src/a/c.rs", "use super::A; impl A { fn f() {} } impl Clone for A {}"),
        ("src/a/d.rs", "use super::A; impl Drop for A {} #[cfg(test)] impl A { fn f() {} }"),
    ];
    assert_eq!(found(Rule::ImplSpread, &sources), [""; 0]);
    sources[4] = ("src/a/d.rs", part);
    assert_eq!(
        found(Rule::ImplSpread, &sources),
        ["src/a.rs:1 methods of `A` are in 4 files, at most 3 are allowed: \
          src/a.rs, src/a/b.rs, src/a/c.rs, src/a/d.rs"]
    );
}

#[test]
fn stores_read_columns_by_name() {
    let source = "fn f() {\nlet a = row.try_get::<i64, _>(1)?;\nlet b: u8 = row.get(0);\n\
                  let c: u8 = row.get(\"c\");\nlist.get(at);\n}";
    let sources = [
        ("src/cache.rs", source),
        ("src/store.rs", source),
        ("src/store/rows.rs", "fn f() { |row| row.get(2) }"),
    ];
    let text = "a column is read by its place: read it by its name";
    assert_eq!(
        found(Rule::ColumnByPlace, &sources),
        ["src/store.rs:2", "src/store.rs:3", "src/store/rows.rs:1"]
            .map(|at| format!("{at} {text}"))
    );
}

#[test]
fn docs_of_types_say_more_than_their_name() {
    let source = "/// A broker's settings.\npub struct BrokerSettings;\n/// A broker.\n\
                  pub struct BrokerView;\n/// Where messages wait.\nstruct Waits;\n";
    assert_eq!(
        found(Rule::ShortMemberDoc, &[("src/lib.rs", source)]),
        [
            "src/lib.rs:1 \"A broker's settings.\" says no more than `BrokerSettings`",
            "src/lib.rs:3 \"A broker.\" says no more than `BrokerView`",
        ]
    );
}

#[test]
fn large_tuples_are_not_compared() {
    let source = "fn f() {\nassert_eq!((a, b), (1, 2));\nassert_eq!((a, f(b, c), d), x);\n\
                  assert_eq!((a, b, c).1, 2);\n}";
    assert_eq!(
        found(Rule::LargeTuple, &[("src/lib.rs", source)]),
        ["src/lib.rs:3 a tuple of 3 is compared: compare its members"]
    );
}
