//! Local users, and configurations that open something to others.

use std::{os::unix::fs::PermissionsExt as _, path::PathBuf, process::Command};

use anyhow::Context as _;

use crate::harness::{binary, write_private};

/// Fails where another user of the machine could read or change a file of a daemon.
pub(super) async fn of_the_user_alone(folder: PathBuf) -> anyhow::Result<String> {
    let mut waiting = vec![folder];
    let mut count = 0;
    while let Some(path) = waiting.pop() {
        let metadata = std::fs::symlink_metadata(&path)
            .with_context(|| format!("looking at {}", path.display()))?;
        let mode = metadata.permissions().mode() & 0o777;
        // Sockets and databases are made below a folder that nobody else enters.
        anyhow::ensure!(mode & 0o077 == 0, "{} has mode {mode:o}", path.display());
        count += 1;
        if metadata.is_dir() {
            for entry in std::fs::read_dir(&path)? {
                waiting.push(entry?.path());
            }
        }
    }
    Ok(format!("{count} files and folders of the user alone"))
}

/// Checks configurations that would speak without encryption to other machines: none is valid.
pub(super) async fn plaintext_addresses(folder: PathBuf) -> anyhow::Result<String> {
    let base = std::fs::read_to_string(folder.join("platform.toml"))?;
    let web = base.lines().find(|line| line.starts_with("listen")).context("a listener")?;
    let remote = "listen = \"0.0.0.0:8080\"\npublic_url = \"http://platform.example\"";
    let changes = [
        ("web", base.replacen(web, remote, 1)),
        (
            "broker",
            base.replacen("[broker]", "[broker]\npublic_url = \"amqp://broker.example:5672\"", 1),
        ),
    ];
    let mut refusals = Vec::new();
    for (name, text) in changes {
        let file = folder.join(format!("plaintext-{name}.toml"));
        write_private(&file, &text)?;
        let checked = Command::new(binary("platform")?)
            .args(["config", "check", "--config", &file.display().to_string()])
            .output()?;
        let said = [checked.stdout, checked.stderr].concat();
        let said = String::from_utf8_lossy(&said).into_owned();
        anyhow::ensure!(!checked.status.success(), "{name} is valid: {said}");
        anyhow::ensure!(said.contains("allow_plaintext"), "{name} says no way out: {said}");
        refusals.push(name);
    }
    Ok(format!("{} refused, unless allowed by name", refusals.join(" and ")))
}
