//! Local users, and configurations that open something to others.

use std::{
    os::unix::fs::PermissionsExt as _,
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::Context as _;
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};

use crate::{
    frame_order::MUNICH,
    harness::{binary, write_private},
};

/// Time in which a connector asks the platform that it is to enrol at.
const PATIENCE: std::time::Duration = std::time::Duration::from_secs(30);

/// A token that no platform made.
const TOKEN: &str = "a-token-that-nobody-made";

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
    let external = "[broker.external]\nurls = [\"amqp://broker.example:5672\"]\nprofile = \"rabbitmq-3\"\n\
                    user_name = \"platform\"\npassword = \"a password of some length\"\n";
    let connector = std::fs::read_to_string(folder.join(format!("connector-{MUNICH}.toml")))?;
    let broker = "[broker]\nurl = \"amqp://broker.example:5672\"\n";
    let changes = [
        ("web", "platform", base.replacen(web, remote, 1)),
        (
            "broker",
            "platform",
            base.replacen("[broker]", "[broker]\npublic_url = \"amqp://broker.example:5672\"", 1),
        ),
        ("external broker", "platform", with_external(&base, external)?),
        ("broker of a connector", "factory-connector", format!("{connector}\n{broker}")),
    ];
    let mut refusals = Vec::new();
    for (name, program, text) in changes {
        let file = folder.join(format!("plaintext-{}.toml", name.replace(' ', "-")));
        write_private(&file, &text)?;
        refused(name, program, &["config", "check", "--config", &file.display().to_string()])?;
        refusals.push(name);
    }
    Ok(format!("{} refused, unless allowed by name", refusals.join(", ")))
}

/// Returns a configuration with another broker in the place of the platform's own.
fn with_external(base: &str, external: &str) -> anyhow::Result<String> {
    let (before, rest) = base.split_once("[broker]").context("a broker")?;
    let (_, after) = rest.split_once("[admin]").context("an administrator")?;
    Ok(format!("{before}{external}\n[admin]{after}"))
}

/// Enrols at an address without encryption, and at a platform that names a broker without it: the token stays here, and
/// the credential is not taken. Nor is a token on the command line, where each local user reads it.
pub(super) async fn plaintext_enrolment(folder: PathBuf) -> anyhow::Result<String> {
    let token = write_token(&folder)?;
    let config = folder.join("connector-of-probes.toml");
    let data = folder.join("connector-of-probes");
    std::fs::write(&config, format!("data_directory = \"{}\"\n", data.display()))?;
    let config = config.display().to_string();
    let listener = tokio::net::TcpListener::bind(("127.0.0.1", 0)).await?;
    let here = format!("http://{}", listener.local_addr()?);
    let answering =
        tokio::spawn(answer_enrolment(listener, "amqp://broker.example:5672".to_owned()));
    for platform in ["http://platform.example", &here] {
        let enrol = ["enrol", "--token-file", &token, "--platform", platform, "--config", &config]
            .map(str::to_owned);
        tokio::task::spawn_blocking(move || {
            refused("enrolment", "factory-connector", &enrol.each_ref().map(String::as_str))
        })
        .await??;
    }
    answering.await.context("the platform was not asked")??;
    let open = ["enrol", "--token", TOKEN, "--platform", &here, "--config", &config];
    let checked = Command::new(binary("factory-connector")?).args(open).output()?;
    anyhow::ensure!(!checked.status.success(), "a token in the list of processes is taken");
    Ok("refused, and so are a broker that a platform names and a token in the list of processes"
        .to_owned())
}

fn write_token(folder: &Path) -> anyhow::Result<String> {
    let file = folder.join("token-of-probes");
    write_private(&file, TOKEN)?;
    Ok(file.display().to_string())
}

/// Enrols a connector at a platform that is nothing but one answer, and that names a broker.
pub(super) async fn enrol_at_scripted_platform(
    folder: &Path,
    config: &str,
    broker: &str,
) -> anyhow::Result<()> {
    let token = write_token(folder)?;
    let listener = tokio::net::TcpListener::bind(("127.0.0.1", 0)).await?;
    let here = format!("http://{}", listener.local_addr()?);
    let answering = tokio::spawn(answer_enrolment(listener, broker.to_owned()));
    let enrol = ["enrol", "--token-file", &token, "--platform", &here, "--config", config];
    let mut command = tokio::process::Command::new(binary("factory-connector")?);
    let checked = command.args(enrol).output().await?;
    answering.await.context("the platform was not asked")??;
    let said = String::from_utf8_lossy(&checked.stderr);
    anyhow::ensure!(checked.status.success(), "no enrolment: {said}");
    Ok(())
}

/// Answers one enrolment as a platform whose broker speaks in the clear.
async fn answer_enrolment(listener: tokio::net::TcpListener, broker: String) -> anyhow::Result<()> {
    let (mut stream, _) = tokio::time::timeout(PATIENCE, listener.accept()).await??;
    anyhow::ensure!(stream.read(&mut [0; 8192]).await? > 0, "no request");
    let body = serde_json::json!({ "factoryId": "PROBE", "brokerUrl": broker,
        "profile": "embedded", "userName": "factory.PROBE", "password": "a password of some length",
        "rootCertificatePem": null })
    .to_string();
    let head =
        "HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nConnection: close\r\nContent-Length:";
    stream.write_all(format!("{head} {}\r\n\r\n{body}", body.len()).as_bytes()).await?;
    Ok(())
}

/// Fails where a program takes what it has to refuse, or says no way out.
fn refused(name: &str, program: &str, arguments: &[&str]) -> anyhow::Result<()> {
    let checked = Command::new(binary(program)?).args(arguments).output()?;
    let said = [checked.stdout, checked.stderr].concat();
    let said = String::from_utf8_lossy(&said).into_owned();
    anyhow::ensure!(!checked.status.success(), "{name} is valid: {said}");
    anyhow::ensure!(said.contains("allow_plaintext"), "{name} says no way out: {said}");
    Ok(())
}
