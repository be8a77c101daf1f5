use std::{os::unix::fs::PermissionsExt as _, path::Path};

use daemon::sealing::{SealingConfig, is_sealed};

use super::*;

fn sealer(folder: &Path) -> Sealer {
    Sealer::new(&SealingConfig::default(), folder)
}

fn external(file: Option<&Path>, more: &str) -> ExternalBrokerConfig {
    let file = file.map(|file| format!("password_file = {file:?}\n")).unwrap_or_default();
    let text = format!(
        "[broker.external]\nurls = [\"amqps://broker.example\"]\nprofile = \"rabbitmq-3\"\nuser_name = \"p\"\n{file}{more}"
    );
    let config: crate::config::PlatformConfig =
        daemon::configuration::parse(None, &text, "VERBUND", []).expect("valid");
    config.broker.external.expect("configured")
}

fn write(path: &Path, text: &str, mode: u32) {
    std::fs::write(path, text).expect("written");
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(mode)).expect("ours");
}

#[test]
fn passwords_of_the_file_are_read_again_and_go_before_the_configuration() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("passwords");
    let accounts = "[[broker.external.accounts]]\nuser_name = \"factory.F\"\npassword = \"configured-0123456\"\n";
    let external = external(Some(&path), accounts);
    write(&path, "# of the broker\n\np of-the-file-0123456\n", 0o600);
    let sealer = sealer(folder.path());
    let of = |name: &str| external.password_of(name, &sealer).map(|found| found.expose().clone());
    assert_eq!(of("p").expect("in the file"), "of-the-file-0123456");
    assert_eq!(of("factory.F").expect("configured"), "configured-0123456");
    assert!(matches!(of("factory.G"), Err(BrokerPasswordError::Missing { .. })));
    write(&path, "p changed-0123456789\nfactory.F rotated-0123456789\n", 0o600);
    assert_eq!(of("p").expect("changed"), "changed-0123456789");
    assert_eq!(of("factory.F").expect("changed"), "rotated-0123456789");
    assert_eq!(external.password_faults(), Vec::<String>::new());
}

#[test]
fn what_is_wrong_with_the_file_is_said_before_the_start() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("passwords");
    for (text, mode, said) in [
        ("p of-the-file-0123456\n", 0o640, "chmod 600"),
        ("p of-the-file-0123456\n", 0o604, "chmod 600"),
        ("p\n", 0o600, "line 1"),
        ("p short\n", 0o600, "16 characters"),
        ("other of-the-file-0123456\n", 0o600, "no account p"),
    ] {
        write(&path, text, mode);
        let faults = external(Some(&path), "").password_faults();
        assert!(faults.len() == 1 && faults[0].contains(said), "{text}: {faults:?}");
    }
    write(&path, "p of-the-file-0123456\n", 0o600);
    // Root alone gives files away; for all others the owner is a matter of the kernel.
    if std::os::unix::fs::chown(&path, Some(65_534), None).is_ok() {
        let faults = external(Some(&path), "").password_faults();
        assert!(faults.len() == 1 && faults[0].contains("another user"), "{faults:?}");
    }
    let faults = external(Some(&folder.path().join("nowhere")), "").password_faults();
    assert!(faults.len() == 1 && faults[0].contains("cannot read"), "{faults:?}");
    let faults = external(None, "").password_faults();
    assert!(faults.len() == 1 && faults[0].contains("no account p"), "{faults:?}");
}

/// Returns the text after the user name in each line that is no comment.
fn passwords_in(path: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(path).expect("readable");
    let lines = text.lines().filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.filter_map(|line| line.split_once(' ')).map(|(_, password)| password.to_owned()).collect()
}

#[test]
fn passwords_of_the_file_are_sealed_where_they_lie_and_change_beside_a_running_platform() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("passwords");
    let (external, sealer) = (external(Some(&path), ""), sealer(folder.path()));
    let of = |name: &str| external.password_of(name, &sealer).map(|found| found.expose().clone());
    write(&path, "# of the broker\n\np of-the-file-0123456\nfactory.F factory-0123456789", 0o600);
    assert_eq!(external.seal_passwords(&sealer).expect("sealed"), 2);
    assert_eq!(passwords_in(&path).iter().filter(|text| is_sealed(text)).count(), 2);
    assert!(std::fs::read_to_string(&path).expect("readable").starts_with("# of the broker\n\np "));
    let mode = std::fs::metadata(&path).expect("there").permissions().mode() & 0o777;
    assert_eq!(mode, 0o600);
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 2, "file and key");
    assert_eq!(of("p").expect("opened"), "of-the-file-0123456");
    assert_eq!(of("factory.F").expect("opened"), "factory-0123456789");
    assert_eq!(external.seal_passwords(&sealer).expect("nothing is left"), 0);

    // A line as `platform seal password` prints it, and one in plain text: each counts at once.
    let line = sealed_line("p", &"rotated-0123456789".into(), &sealer).expect("sealed");
    write(&path, &format!("{line}\nfactory.F again-0123456789\n"), 0o600);
    assert_eq!(of("p").expect("opened"), "rotated-0123456789");
    assert_eq!(of("factory.F").expect("in plain text"), "again-0123456789");
    let mut sealing = PasswordSealing::new(external.clone(), sealer.clone());
    assert_eq!(sealing.look().expect("read"), 0, "an editor may still be writing it");
    write(&path, &format!("{line}\nfactory.F latest-0123456789\n"), 0o600);
    assert_eq!(sealing.look().expect("read"), 0, "it changed since the last look");
    assert_eq!(sealing.look().expect("sealed"), 1);
    assert!(passwords_in(&path).iter().all(|text| is_sealed(text)));
    assert_eq!(of("factory.F").expect("opened"), "latest-0123456789");
    assert_eq!(external.password_faults(), Vec::<String>::new());
}

#[test]
fn passwords_of_the_file_are_sealed_again_with_a_new_key() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("passwords");
    let (external, sealer) = (external(Some(&path), ""), sealer(folder.path()));
    write(&path, "p of-the-file-0123456\nfactory.F factory-0123456789\n", 0o600);
    // Two in a row: a key's file keeps one former key.
    for _ in 0..2 {
        assert_eq!(external.seal_passwords(&sealer).expect("sealed"), 2);
        sealer.renew().expect("a new key");
    }
    assert_eq!(external.seal_passwords(&sealer).expect("sealed"), 2);
    assert!(passwords_in(&path).iter().all(|text| sealer.is_current(text).expect("sealed")));
    let password = external.password_of("factory.F", &sealer).expect("opened");
    assert_eq!(password.expose(), "factory-0123456789");
}

#[test]
fn a_line_that_no_key_opens_is_named_and_keeps_no_other_from_being_sealed() {
    let (folder, elsewhere) =
        (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
    let path = folder.path().join("passwords");
    let (external, own) = (external(Some(&path), ""), sealer(folder.path()));
    let password: Confidential<String> = "of-the-file-0123456".into();
    let strange = sealed_line("p", &password, &sealer(elsewhere.path())).expect("sealed");
    let swapped = sealed_line("factory.G", &password, &own).expect("sealed");
    let swapped = swapped.replace("factory.G", "factory.H");
    write(&path, &format!("{strange}\n{swapped}\nfactory.F factory-0123456789\n"), 0o600);
    let error = external.seal_passwords(&own).expect_err("no key opens the first line");
    assert!(error.to_string().contains("the password of p in"), "{error}");
    assert!(passwords_in(&path).iter().all(|text| is_sealed(text)));
    for user_name in ["p", "factory.H"] {
        let opened = external.password_of(user_name, &own);
        assert!(matches!(opened, Err(BrokerPasswordError::Sealing { .. })), "{user_name}");
    }
    // A command has no credential of the service manager: the form alone is a matter of the configuration.
    assert_eq!(external.password_faults(), Vec::<String>::new());
}

#[test]
fn a_file_that_cannot_be_replaced_is_named_once_and_used() {
    let folder = tempfile::tempdir().expect("a folder");
    let place = folder.path().join("place");
    std::fs::create_dir(&place).expect("made");
    let path = place.join("passwords");
    let (external, sealer) = (external(Some(&path), ""), sealer(folder.path()));
    write(&path, "p of-the-file-0123456\n", 0o600);
    std::fs::set_permissions(&place, std::fs::Permissions::from_mode(0o500)).expect("ours");
    // Root writes everywhere.
    let is_closed = std::fs::write(place.join("probe"), "").is_err();
    let mut sealing = PasswordSealing::new(external.clone(), sealer.clone());
    assert_eq!(sealing.look().expect("read"), 0);
    if is_closed {
        let error = sealing.look().expect_err("the folder is closed");
        assert!(error.to_string().contains("platform seal password"), "{error}");
        assert_eq!(sealing.look().expect("said already"), 0);
        assert_eq!(passwords_in(&path), ["of-the-file-0123456"]);
    }
    let password = external.password_of("p", &sealer).expect("used");
    assert_eq!(password.expose(), "of-the-file-0123456");
    std::fs::set_permissions(&place, std::fs::Permissions::from_mode(0o700)).expect("ours");
}
