//! Brokers with which nothing was tried: all programs that are configured for one say so.

use std::{
    path::{Path, PathBuf},
    process::{Command, Output},
    time::Duration,
};

use verbund_tests::{
    harness::{Daemon, DaemonCommand, binary, until, write_private},
    world::{ADMIN, PASSWORD},
};

/// Profiles of brokers that no test has played with.
const UNTESTED: [&str; 2] = ["rabbitmq-4", "activemq"];

/// Writes a configuration for a broker with a profile, at which none listens.
fn config(folder: &Path, profile: &str) -> PathBuf {
    let file = folder.join("platform.toml");
    let text = format!(
        "data_directory = {data:?}\n[web]\nlisten = \"127.0.0.1:0\"\n[admin]\nuser_name = \"{ADMIN}\"\n\
         password = \"{PASSWORD}\"\n[broker.external]\nurls = [\"amqp://127.0.0.1:1\"]\nprofile = \"{profile}\"\n\
         user_name = \"platform\"\npassword = \"sixteen characters\"\n",
        data = folder.join("platform")
    );
    write_private(&file, &text).unwrap();
    file
}

fn run(config: &Path, arguments: &[&str]) -> Output {
    let output = Command::new(binary("platform").unwrap())
        .args(arguments)
        .arg("--config")
        .arg(config)
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?} failed: {errors}");
    output
}

fn says_untested(output: &[u8]) -> bool {
    String::from_utf8_lossy(output).to_lowercase().contains("untested")
}

#[test]
fn the_check_of_a_configuration_says_that_its_broker_is_untested() {
    let folder = tempfile::tempdir().unwrap();
    let check = |profile| run(&config(folder.path(), profile), &["config", "check"]).stdout;
    for profile in UNTESTED {
        assert!(says_untested(&check(profile)), "{profile}");
    }
    assert!(!says_untested(&check("rabbitmq-3")));
}

#[test]
fn definitions_for_a_broker_say_that_it_is_untested() {
    let folder = tempfile::tempdir().unwrap();
    // With its data directory.
    run(&config(folder.path(), "rabbitmq-3"), &["organisation", "add", "ORG"]);
    let print = |profile, kind| run(&config(folder.path(), profile), &["definitions", kind]);
    for profile in UNTESTED {
        let printed = print(profile, "rabbitmq");
        assert!(says_untested(&printed.stderr), "{profile}");
        let definitions: serde_json::Value = serde_json::from_slice(&printed.stdout).unwrap();
        assert!(definitions["queues"].is_array(), "{profile}: what is imported is whole");
    }
    let tested = print("rabbitmq-3", "rabbitmq");
    assert!(!says_untested(&tested.stderr) && !says_untested(&tested.stdout));
    // In the file itself, which is copied from here to there.
    assert!(says_untested(&print("activemq", "activemq").stdout));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_platform_that_starts_says_that_its_broker_is_untested() {
    for profile in UNTESTED {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("platform.log");
        let config = config(folder.path(), profile).display().to_string();
        let mut platform = Daemon::start(DaemonCommand {
            name: "platform".to_owned(),
            program: binary("platform").unwrap(),
            arguments: ["serve", "--config", config.as_str()].map(str::to_owned).into(),
            environment: Vec::new(),
            log: log.clone(),
        })
        .unwrap();
        let says = || says_untested(&std::fs::read(&log).unwrap_or_default());
        until(profile, Duration::from_secs(30), says).await.unwrap();
        platform.stop(Duration::from_secs(20)).unwrap();
    }
}
