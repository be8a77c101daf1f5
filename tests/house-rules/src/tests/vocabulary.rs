//! Vocabulary in Rust and in all other sources.

use super::found;
use crate::{Rule, texts::check_text, words::banned_in};

#[test]
fn banned_words_are_found_as_parts_of_names() {
    for (text, words) in [
        ("struct Books;", vec!["books"]),
        ("let desk_handle = DeskHandle::new();", vec!["desk"]),
        ("fn keep_house() {}", vec!["house", "keep_house"]),
        ("KeepHouse", vec!["house", "keep_house"]),
        ("FAREWELL_BUDGET", vec!["farewell"]),
        ("bookshelf, desktop, notebooks, warehouse, renew, newsletter", vec![]),
        ("keep_the_house", vec!["house"]),
    ] {
        let found: Vec<&str> = banned_in(text).into_iter().map(|word| word.word).collect();
        assert_eq!(found, words, "{text}");
    }
}

#[test]
fn banned_words_are_found_in_code_comments_and_literals() {
    let source = "//! The desk.\nlet a = \"a remark\"; // Aftermath.\nlet b = r#\"the \"books\" of\n\
                  the desk\"#;\nlet c = '\"'; /* the /* inner */ shelf */ let d = 'd';\n\
                  fn f<'desk>() { \"\\\"desk\"; let ripe = b\"desk\"; }\n";
    let source = source.replacen("let", "fn x() { let", 1) + "}";
    assert_eq!(
        found(Rule::BannedWord, &[("src/lib.rs", &source), ("src/knocks.rs", "")]),
        [
            "src/knocks.rs:1 \"knocks\": say rejected clients",
            "src/lib.rs:1 \"desk\": say coordinator",
            "src/lib.rs:2 \"aftermath\": say effects",
            "src/lib.rs:2 \"remark\": say comment",
            "src/lib.rs:3 \"books\": say state",
            "src/lib.rs:4 \"desk\": say coordinator",
            "src/lib.rs:5 \"shelf\": say mapping versions",
            "src/lib.rs:6 \"desk\": say coordinator",
            "src/lib.rs:6 \"ripe\": say due, releasable",
        ]
    );
}

#[test]
fn words_that_are_no_names_are_found_in_code_alone() {
    let source = "/// Says what it was told.\nfn a(told: u8) -> bool {\n    is_told(\"told\")\n}\n";
    assert_eq!(
        found(Rule::BannedWord, &[("src/lib.rs", source)]),
        [
            "src/lib.rs:2 \"told\": say what it is: sent, shown, answered, reported",
            "src/lib.rs:3 \"told\": say what it is: sent, shown, answered, reported",
        ]
    );
}

#[test]
fn a_name_may_have_a_word_that_is_none_alone() {
    let source = "fn a(standing_rules: &StandingRules, standing: u8) {}\n";
    assert_eq!(
        found(Rule::BannedWord, &[("src/lib.rs", source)]),
        ["src/lib.rs:1 \"standing\": say status"]
    );
}

#[test]
fn names_that_others_rely_on_stay_in_literals_of_their_files() {
    let source = "fn f() { \"SELECT outbox_id FROM outbox WHERE o.grounds\"; \"/x/trial\"; }";
    let in_store = ("platform/src/store/a.rs", source);
    assert_eq!(
        found(Rule::BannedWord, &[in_store]),
        ["platform/src/store/a.rs:1 \"grounds\": say basis"]
    );
    let in_code = ("platform/src/store/b.rs", "fn outbox() { \"the outbox is full\" }");
    assert_eq!(found(Rule::BannedWord, &[in_code]).len(), 1);
}

#[test]
fn banned_words_are_found_in_texts_by_their_kind() {
    for (path, text, words) in [
        ("web/a.svelte", "<p>{remarks.value}</p>\n", vec!["remarks"]),
        ("web/a.ts", "// The desk.\nconst isTrial = true", vec!["desk", "trial"]),
        ("web/a.ts", "post(`${FIELD}/trial`, field.grounds)", vec![]),
        ("web/a.ts", "// What it was told.\nconst told = 'told' /* tell */", vec!["told"]),
        (
            "web/a.svelte",
            "{texts.tell}<!-- told --> {`told`} it's told\n{a.standing}",
            vec!["tell"],
        ),
        ("web/a.js", "const label = 'Somebody changed it.'", vec!["somebody"]),
        ("docs/a.md", "Three rooms, an outbox.", vec!["outbox", "rooms"]),
        ("docs/a.md", "There are grounds for it.", vec!["grounds"]),
        ("a/a.sql", "-- The books.\nCREATE TABLE desk (at INTEGER);", vec!["books", "desk"]),
        ("platform/migrations/sqlite/0001_house.sql", "CREATE TABLE outbox", vec![]),
        ("a/a.py", "def knock():  # Somebody.", vec!["knock", "somebody"]),
        ("a/a.css", ".shelf { color: red }", vec!["shelf"]),
        ("a/Cargo.toml", "# Our own rooms.\nhouse-rules = 1", vec!["rooms"]),
        ("run.sh", "verdict=survived # tests/it/house.rs", vec!["verdict"]),
        ("Makefile", "# The books.", vec!["books"]),
    ] {
        let findings = check_text(path, text);
        let found: Vec<&str> =
            findings.iter().map(|finding| finding.text.split('"').nth(1).unwrap()).collect();
        assert_eq!(found, words, "{path}: {text}");
    }
}

#[test]
fn programs_have_so_many_lines_at_most() {
    let length = |path: &str, lines: usize| check_text(path, &"x\n".repeat(lines)).len();
    for path in ["web/a.ts", "web/a.svelte", "a.js", "a.py", "a.sh"] {
        let found = [length(path, 400), length(path, 401)];
        assert_eq!(found, [0, 1], "{path}");
    }
    assert_eq!(length("docs/a.md", 401), 0);
    assert_eq!(check_text("a.ts", &format!("// @generated\n{}", "x\n".repeat(500))), []);
}

#[test]
fn history_lock_files_snapshots_and_generated_texts_are_left_out() {
    for (path, text) in [
        ("CHANGELOG.md", "The desk keeps its books."),
        ("Cargo.lock", "name = \"desk\""),
        ("web/package-lock.json", "\"desk\""),
        ("a/snapshots/a.snap", "desk"),
        ("web/api/generated.ts", "// Generated from openapi.json.\n\nconst desk = 1"),
        ("web/made.js", "/* @generated by a build */\nconst desk = 1"),
    ] {
        assert_eq!(check_text(path, text), [], "{path}");
    }
}
