//! Data directories of both daemons, as their programs make and use them: for their own user alone.

use std::{
    fs::Permissions,
    io::Write as _,
    os::unix::fs::PermissionsExt as _,
    path::Path,
    process::{Command, Output, Stdio},
};

use verbund_tests::harness::binary;

/// Runs a command of a daemon that ends by itself, with this standard input, as a service manager with
/// the usual mask would.
fn run(program: &str, config: &Path, arguments: &[&str], input: &str) -> Output {
    let mut child = Command::new("sh")
        .args(["-c", "umask 022; exec \"$0\" \"$@\""])
        .arg(binary(program).unwrap())
        .args(arguments)
        .arg("--config")
        .arg(config)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
    child.wait_with_output().unwrap()
}

fn mode(path: &Path) -> u32 {
    std::fs::metadata(path).unwrap().permissions().mode() & 0o777
}

fn set_mode(path: &Path, mode: u32) {
    std::fs::set_permissions(path, Permissions::from_mode(mode)).unwrap();
}

fn config(folder: &Path, data: &Path) -> std::path::PathBuf {
    let file = folder.join("daemon.toml");
    std::fs::write(&file, format!("data_directory = {data:?}\n")).unwrap();
    file
}

#[test]
fn commands_that_make_a_store_make_it_for_their_user_alone() {
    let password = "a password of sixteen";
    let commands: [(&str, &[&str], &str, bool); 4] = [
        ("platform", &["organisation", "add", "ORG"], "platform.sqlite", false),
        ("platform", &["factory", "add", "F1", "--organisation", "ORG"], "platform.sqlite", false),
        ("platform", &["user", "set", "eve", "--role", "ADMINISTRATOR"], "platform.sqlite", false),
        (
            "factory-connector",
            &["users", "set", "eve", "--role", "viewer"],
            "connector.sqlite",
            true,
        ),
    ];
    for (program, arguments, store, is_folder_made_before) in commands {
        let folder = tempfile::tempdir().unwrap();
        let data = folder.path().join("data");
        if is_folder_made_before {
            std::fs::create_dir(&data).unwrap();
            set_mode(&data, 0o700);
        }
        let config = config(folder.path(), &data);
        let output = run(program, &config, arguments, password);
        assert!(output.status.success(), "{arguments:?}: {output:?}");
        let modes = (mode(&data), mode(&data.join(store)));
        assert_eq!(modes, (0o700, 0o600), "{program} {arguments:?}");
    }
}

#[test]
fn no_command_uses_a_folder_that_others_may_enter_unless_that_is_allowed() {
    let commands: [(&str, &[&str]); 5] = [
        ("platform", &["serve"]),
        ("platform", &["organisation", "add", "ORG"]),
        ("factory-connector", &["run"]),
        ("factory-connector", &["ledger", "verify"]),
        ("factory-connector", &["users", "list"]),
    ];
    for (program, arguments) in commands {
        let folder = tempfile::tempdir().unwrap();
        let data = folder.path().join("data");
        std::fs::create_dir(&data).unwrap();
        set_mode(&data, 0o755);
        let config = config(folder.path(), &data);
        let refused = run(program, &config, arguments, "");
        let errors = String::from_utf8(refused.stderr).unwrap();
        assert!(!refused.status.success(), "{program} {arguments:?}");
        assert!(errors.contains("chmod 700"), "{program} {arguments:?}: {errors}");
        assert_eq!(std::fs::read_dir(&data).unwrap().count(), 0, "nothing was made in it");
    }
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    std::fs::create_dir(&data).unwrap();
    set_mode(&data, 0o755);
    let config = config(folder.path(), &data);
    let allowed =
        std::fs::read_to_string(&config).unwrap() + "allow_shared_data_directory = true\n";
    std::fs::write(&config, allowed).unwrap();
    let used = run("platform", &config, &["organisation", "add", "ORG"], "");
    assert!(used.status.success(), "{used:?}");
    assert_eq!(mode(&data.join("platform.sqlite")), 0o600, "its files are closed all the same");
}
