//! Commands that set a platform up without a page, as its program runs them.

use std::{
    io::Write as _,
    path::PathBuf,
    process::{Command, Output, Stdio},
};

use platform::{
    audit::MachineUser,
    store::{AuditAgent, AuditAgentKind, AuditEntry, Scope, Store},
};

/// A platform that no one has set up, in a folder of its own.
struct Bare {
    folder: tempfile::TempDir,
}

impl Bare {
    fn new() -> Self {
        let bare = Self { folder: tempfile::tempdir().expect("a folder") };
        let data = bare.folder.path().join("data");
        let text = format!("data_directory = {data:?}\n");
        std::fs::write(bare.config(), text).expect("written");
        bare
    }

    fn config(&self) -> PathBuf {
        self.folder.path().join("platform.toml")
    }

    /// Runs a command of words, with this standard input.
    fn run(&self, words: &str, input: &str) -> Output {
        let mut child = Command::new(env!("CARGO_BIN_EXE_platform"))
            .args(words.split(' '))
            .arg("--config")
            .arg(self.config())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("started");
        let mut stdin = child.stdin.take().expect("piped");
        // A command that reads nothing may have ended.
        let _ = stdin.write_all(input.as_bytes());
        drop(stdin);
        child.wait_with_output().expect("ended")
    }

    /// Returns what a command that succeeds prints.
    fn said(&self, words: &str) -> String {
        let output = self.run(words, "a password of sixteen");
        assert!(output.status.success(), "{words}: {output:?}");
        String::from_utf8(output.stdout).expect("text").trim_end_matches('\n').to_owned()
    }

    /// Returns the reason for which a command fails.
    fn refusal(&self, words: &str) -> String {
        let output = self.run(words, "");
        assert!(!output.status.success(), "{words}: {output:?}");
        String::from_utf8(output.stderr).expect("text")
    }

    /// Returns the record of who changed what, oldest first.
    async fn entries(&self) -> Vec<AuditEntry> {
        let store = self.folder.path().join("data/platform.sqlite");
        let store = Store::open(&store).await.expect("open");
        let mut work = store.read().await.expect("begun");
        work.audit().list_after(&Scope::Platform, 0, 1_000).await.expect("listed")
    }

    /// Returns the words of a command's subcommands that change something.
    fn changing(&self, command: &str) -> Vec<String> {
        let help = self.said(&format!("{command} --help"));
        let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1);
        let names = listed.take_while(|line| !line.is_empty()).filter_map(|line| {
            // What goes on in a further line stands further to the right.
            let rest = line.strip_prefix("  ").filter(|rest| !rest.starts_with(' '))?;
            rest.split(' ').next()
        });
        let changing = names.filter(|name| !["list", "help"].contains(name));
        changing.map(|name| format!("{command} {name}")).collect()
    }
}

/// Commands that change something, in an order in which none is refused, with the operations that are put on record and
/// what they are about.
const CHANGES: [(&str, &[&str]); 18] = [
    ("organisation add acme", &["addOrganisation organisations/acme"]),
    ("organisation add hull", &["addOrganisation organisations/hull"]),
    ("person set anna --role PLANNER --organisation acme", &["putUser users/anna"]),
    ("user set root --role ADMINISTRATOR", &["putUser users/root"]),
    (
        "factory add HULL_1 --organisation hull",
        &["addFactory factories/HULL_1", "makeEnrolmentToken factories/HULL_1"],
    ),
    ("factory token HULL_1", &["makeEnrolmentToken factories/HULL_1"]),
    ("collaboration add frames", &["addCollaboration collaborations/frames"]),
    ("collaboration add-member frames hull", &["addMember collaborations/frames/members/hull"]),
    (
        "collaboration add-factory frames HULL_1",
        &["addCollaborationFactory collaborations/frames/factories/HULL_1"],
    ),
    (
        "tool add Planning --organisation acme",
        &["addTool tools/Planning", "makeToolCredential tools/Planning"],
    ),
    ("tool credential Planning", &["makeToolCredential tools/Planning"]),
    ("tool remove Planning", &["removeTool tools/Planning"]),
    (
        "collaboration remove-factory frames HULL_1",
        &["removeCollaborationFactory collaborations/frames/factories/HULL_1"],
    ),
    (
        "collaboration remove-member frames hull",
        &["removeMember collaborations/frames/members/hull"],
    ),
    ("collaboration remove frames", &["removeCollaboration collaborations/frames"]),
    ("factory remove HULL_1", &["removeFactory factories/HULL_1"]),
    ("user remove anna", &["removeUser users/anna"]),
    ("organisation remove acme", &["removeOrganisation organisations/acme"]),
];

#[tokio::test]
async fn each_command_that_changes_something_is_on_record_with_the_user_of_the_machine() {
    let bare = Bare::new();
    for command in ["organisation", "user", "factory", "collaboration", "tool"] {
        let changing = bare.changing(command);
        assert!(changing.len() >= 2, "{changing:?}");
        for words in changing {
            let is_this = |played: &str| {
                played.strip_prefix(words.as_str()).is_some_and(|rest| rest.starts_with(' '))
            };
            let is_played = CHANGES.iter().any(|(played, _)| is_this(played));
            assert!(is_played, "{words} is not played here");
        }
    }
    for (words, _) in CHANGES {
        bare.said(words);
    }
    let entries = bare.entries().await;
    let lines: Vec<String> =
        entries.iter().map(|entry| format!("{} {}", entry.operation, entry.subject)).collect();
    let expected: Vec<&str> = CHANGES.iter().flat_map(|(_, lines)| *lines).copied().collect();
    assert_eq!(lines, expected);
    // The program has the user and the variables of this one.
    let user = AuditAgent::from(MachineUser::of_process()).name;
    for entry in entries {
        assert_eq!(entry.agent_kind, AuditAgentKind::Command, "{}", entry.operation);
        assert_eq!(entry.agent_name.as_deref(), Some(&*user), "{}", entry.operation);
    }
}

#[test]
fn a_platform_is_set_up_by_commands_alone() {
    let bare = Bare::new();
    bare.said("organisation add acme --name Acme");
    bare.said("organisation add hull");
    assert_eq!(bare.said("organisation list"), "acme\tAcme\nhull\thull");
    bare.said("person set anna --role PLANNER --organisation acme");
    bare.said("user set root --role ADMINISTRATOR");
    assert_eq!(bare.said("user list"), "anna\tPLANNER\tacme\nroot\tADMINISTRATOR\t-");
    let token = bare.said("factory add HULL_1 --organisation hull --name Hull");
    assert_eq!(token.split('.').count(), 2, "an address and a secret: {token}");
    assert_eq!(bare.said("factory list"), "HULL_1\thull\tHull\tnot enrolled");
    bare.said("collaboration add frames --name Frames --member acme --factory HULL_1");
    bare.said("collaboration add-member frames hull");
    assert_eq!(bare.said("collaboration list"), "frames\tFrames\tacme,hull\tHULL_1");
    let first = bare.said("tool add Planning --organisation acme");
    let second = bare.said("tool credential Planning");
    assert!(!first.is_empty() && first != second, "each password is new");
    assert_eq!(bare.said("tool list"), "Planning\tacme\tPlanning");
}

#[test]
fn commands_name_what_is_missing_or_there_already() {
    let bare = Bare::new();
    for (words, reason) in [
        ("tool add T --organisation nobody", "there is no organisation nobody"),
        ("tool credential T", "there is no tool T"),
        ("collaboration add c --factory F", "there is no factory F"),
        ("collaboration add-member c acme", "there is no collaboration c"),
        ("tool remove T", "there is no tools/T"),
        ("tool add bad/id --organisation acme", "must match"),
    ] {
        let refusal = bare.refusal(words);
        assert!(refusal.contains(reason), "{words}: {refusal}");
    }
    bare.said("collaboration add c");
    let refusal = bare.refusal("collaboration add c");
    assert!(refusal.contains("the id c is in use, or was"), "{refusal}");
    bare.said("collaboration remove c");
    assert_eq!(bare.said("collaboration list"), "");
    let refusal = bare.refusal("collaboration add c");
    assert!(refusal.contains("the id c is in use, or was"), "never given again: {refusal}");
}

#[tokio::test]
async fn what_is_in_force_is_in_the_way_of_a_removal_by_command() {
    let bare = Bare::new();
    bare.said("factory add HULL_1 --organisation hull");
    bare.said("collaboration add frames --member hull --factory HULL_1");
    bare.said("user set root --role ADMINISTRATOR");
    let refusal = bare.refusal("organisation remove hull");
    assert!(refusal.contains("organisations/hull stays"), "{refusal}");
    let refusal = bare.refusal("user remove root");
    assert!(refusal.contains("users/root stays"), "the last administrator: {refusal}");
    let preview = bare.said("factory remove HULL_1 --dry-run");
    assert!(preview.contains("collaborations/frames/factories/HULL_1"), "{preview}");
    bare.said("collaboration remove-factory frames HULL_1");
    bare.said("collaboration remove-member frames hull --dry-run");
    assert_eq!(bare.said("collaboration list"), "frames\tframes\thull\t");
    bare.said("collaboration remove-member frames hull");
    bare.said("factory remove HULL_1");
    bare.said("organisation remove hull");
    for list in ["factory list", "organisation list"] {
        assert_eq!(bare.said(list), "", "{list}");
    }
    assert_eq!(bare.said("user list"), "root\tADMINISTRATOR\t-");
    let entries = bare.entries().await;
    let removals: Vec<&str> = entries
        .iter()
        .filter(|entry| entry.operation.starts_with("remove"))
        .map(|entry| entry.subject.as_str())
        .collect();
    let left = [
        "collaborations/frames/factories/HULL_1",
        "collaborations/frames/members/hull",
        "factories/HULL_1",
        "organisations/hull",
    ];
    assert_eq!(removals, left, "each removal is on record");
}

/// Commands of the platform that the README lists, without the one that runs it.
fn commands_of_the_readme() -> Vec<&'static str> {
    include_str!("../../../README.md")
        .lines()
        .filter_map(|line| line.strip_prefix("platform "))
        .filter(|words| *words != "serve")
        .collect()
}

#[test]
fn the_commands_of_the_readme_set_a_platform_up() {
    let bare = Bare::new();
    let commands = commands_of_the_readme();
    assert!(commands.len() > 5, "{commands:?}");
    let said: Vec<String> = commands.iter().map(|words| bare.said(words)).collect();
    assert_eq!(
        said.last().map(String::as_str),
        Some("frames\tframes\tacme,munich\tMUC_1"),
        "the last one lists what the others made"
    );
}

#[test]
fn a_password_at_another_broker_is_sealed_without_being_in_a_file_and_again_with_a_new_key() {
    let bare = Bare::new();
    let file = bare.folder.path().join("passwords");
    let more = format!(
        "[broker.external]\nurls = [\"amqps://broker.example\"]\nprofile = \"rabbitmq-3\"\nuser_name = \"verbund\"\n\
         password_file = {file:?}\n"
    );
    let text = std::fs::read_to_string(bare.config()).expect("readable");
    std::fs::write(bare.config(), text + &more).expect("written");
    let write = |text: &str| {
        std::fs::write(&file, text).expect("written");
        let mode = std::os::unix::fs::PermissionsExt::from_mode(0o600);
        std::fs::set_permissions(&file, mode).expect("ours");
    };
    write("verbund a plain password\n");
    assert!(bare.refusal("seal password verbund").contains("no sealing key"), "none is made here");
    assert!(bare.said("seal rotate").starts_with("1 secret(s)"));
    assert!(bare.said("definitions mosquitto").contains("user verbund"));
    let refusal = bare.refusal("seal password #verbund");
    assert!(refusal.contains("does not begin with #"), "it would be a comment: {refusal}");
    let line = bare.said("seal password verbund");
    assert!(line.starts_with("verbund v1.") && !line.contains("sixteen"), "{line}");
    write(&format!("{line}\n"));
    assert!(bare.said("seal rotate").starts_with("1 secret(s)"));
    let sealed = std::fs::read_to_string(&file).expect("readable");
    assert!(sealed.starts_with("verbund v1.") && sealed.trim() != line, "{sealed}");
    assert!(bare.said("definitions mosquitto").contains("user verbund"), "it opens");
    std::fs::remove_file(bare.folder.path().join("data/sealing-key")).expect("lost");
    let refusal = bare.refusal("definitions mosquitto");
    assert!(refusal.contains("write the line again"), "{refusal}");
}
