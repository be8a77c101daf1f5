//! The guide to hardening names settings, commands, metrics and files that are there, and the units
//! of the service manager take away what they say.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use verbund_tests::harness::binary;

const GUIDE: &str = "docs/hardening.md";
const UNITS: [&str; 2] = ["verbund-platform.service", "verbund-connector.service"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Returns the texts between backticks of the guide.
fn quoted() -> Vec<String> {
    let guide = fs::read_to_string(root().join(GUIDE)).unwrap();
    guide.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

/// Returns the keys of an example, those that are absent by default as well, with their sections:
/// `web.tls` and `web.tls.key`.
fn keys_of(example: &str) -> BTreeSet<String> {
    let mut keys = BTreeSet::new();
    let mut section = String::new();
    for line in example.lines() {
        let line = line.strip_prefix("#: ").unwrap_or(line);
        if let Some(name) = line.strip_prefix('[') {
            name.trim_matches(['[', ']']).clone_into(&mut section);
            keys.insert(section.clone());
        } else if let Some((name, _)) = line.split_once(" = ").filter(|_| !line.starts_with('#')) {
            let is_at_top = section.is_empty();
            keys.insert(if is_at_top { name.to_owned() } else { format!("{section}.{name}") });
        }
    }
    keys
}

/// Returns the keys of both daemons.
fn keys() -> BTreeSet<String> {
    let mut keys = keys_of(platform::config::EXAMPLE);
    keys.extend(keys_of(factory_connector::config::EXAMPLE));
    keys
}

/// Returns true for a text that looks like a setting: words with dots between, none of which is the
/// ending of a file.
fn is_setting(text: &str) -> bool {
    const ENDINGS: [&str; 5] = [".rs", ".md", ".txt", ".toml", ".service"];
    let is_word = |part: &str| {
        !part.is_empty() && part.chars().all(|letter| letter.is_ascii_alphabetic() || letter == '_')
    };
    text.contains('.') && text.split('.').all(is_word) && !ENDINGS.iter().any(|e| text.ends_with(e))
}

#[test]
fn each_setting_that_the_guide_names_exists() {
    let keys = keys();
    assert!(keys.contains("web.tls.certificate") && keys.contains("data_directory"));
    let quoted = quoted();
    let settings: Vec<&String> = quoted.iter().filter(|text| is_setting(text)).collect();
    assert!(settings.len() > 40, "{} settings were read", settings.len());
    let missing: Vec<&&String> = settings.iter().filter(|key| !keys.contains(**key)).collect();
    assert!(missing.is_empty(), "named in {GUIDE} and not in an example: {missing:?}");
    for variable in quoted.iter().filter_map(|text| text.strip_prefix("VERBUND_")) {
        let key = variable.to_lowercase().replace("__", ".");
        assert!(keys.contains(&key), "{variable} sets nothing");
    }
}

#[test]
fn each_command_that_the_guide_names_exists() {
    let mut count = 0;
    for text in quoted() {
        let mut words = text.split(' ');
        let program = words.next().unwrap_or_default();
        if !["platform", "factory-connector", "asi"].contains(&program) {
            continue;
        }
        let out =
            Command::new(binary(program).unwrap()).args(words).arg("--help").output().unwrap();
        assert!(out.status.success(), "{text}: {}", String::from_utf8_lossy(&out.stderr));
        count += 1;
    }
    assert!(count > 8, "{count} commands were read");
}

#[test]
fn each_metric_and_file_that_the_guide_names_exists() {
    let listed =
        Command::new("git").args(["ls-files", "*.rs"]).current_dir(root()).output().unwrap();
    let files = String::from_utf8(listed.stdout).unwrap();
    let sources: String = files
        .lines()
        .filter(|file| !file.starts_with("vendor/"))
        .filter_map(|file| fs::read_to_string(root().join(file)).ok())
        .collect();
    let makefile = fs::read_to_string(root().join("Makefile")).unwrap();
    for text in quoted() {
        if text.starts_with("verbund_") {
            assert!(sources.contains(&format!("!(\"{text}\"")), "no metric is called {text}");
        } else if let Some(target) = text.strip_prefix("make ") {
            assert!(makefile.contains(&format!("\n{target}:")), "no target is called {target}");
        } else if text.starts_with("packaging/") || text.starts_with("tests/") {
            assert!(root().join(&text).exists(), "{text} is not there");
        }
    }
}

/// Lines of a unit without which a daemon could do more than it needs.
const WALLS: [&str; 13] = [
    "DynamicUser=yes",
    "StateDirectoryMode=0700",
    "UMask=0077",
    "ProtectSystem=strict",
    "ProtectHome=yes",
    "NoNewPrivileges=yes",
    "CapabilityBoundingSet=",
    "RestrictNamespaces=yes",
    "MemoryDenyWriteExecute=yes",
    "SystemCallFilter=@system-service",
    "SystemCallFilter=~@privileged @resources",
    "LimitCORE=0",
    // One process of a daemon that is killed for memory ends that process alone.
    "OOMPolicy=continue",
];

/// Exposure by `systemd-analyze security`, in tenths: 0 is the least, 100 that of a unit with a command
/// alone.
const EXPOSURE_MAX: &str = "20";

#[test]
fn the_units_take_away_what_the_daemons_do_not_need() {
    let folder = tempfile::tempdir().unwrap();
    for unit in UNITS {
        let path = root().join("packaging/systemd").join(unit);
        let text = fs::read_to_string(&path).unwrap();
        for line in WALLS {
            assert!(text.lines().any(|found| found == line), "{unit} has no {line}");
        }
        for bound in ["MemoryMax=", "TasksMax=", "LimitNOFILE=", "RestrictAddressFamilies="] {
            assert!(text.contains(&format!("\n{bound}")), "{unit} has no {bound}");
        }
        // The command of the unit is one that the program has; installed it is elsewhere.
        let command = text.lines().find_map(|line| line.strip_prefix("ExecStart=")).unwrap();
        let mut words = command.split(' ');
        let program = Path::new(words.next().unwrap()).file_name().unwrap().to_str().unwrap();
        let built = binary(program).unwrap();
        let help = Command::new(&built).args(words).arg("--help").output().unwrap();
        assert!(help.status.success(), "{command}");

        let installed = folder.path().join(unit);
        let place = format!("/usr/local/bin/{program}");
        fs::write(&installed, text.replace(&place, built.to_str().unwrap())).unwrap();
        let verified = analyze(&["verify"], &installed);
        assert_eq!((verified.0, verified.1.trim()), (true, ""), "{unit}");
        let threshold = format!("--threshold={EXPOSURE_MAX}");
        let (is_safe, said) = analyze(&["security", "--offline=yes", &threshold], &installed);
        assert!(is_safe, "{unit}: {said}");
    }
}

/// Runs `systemd-analyze`, which needs no running service manager for this.
fn analyze(arguments: &[&str], unit: &Path) -> (bool, String) {
    let out = Command::new("systemd-analyze").args(arguments).arg(unit).output();
    let out = out.expect("systemd-analyze is there: tools/prerequisites.sh test");
    let said = [out.stdout, out.stderr].concat();
    (out.status.success(), String::from_utf8_lossy(&said).into_owned())
}
