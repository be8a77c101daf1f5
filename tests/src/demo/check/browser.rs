//! The pages in a real browser.

use std::{process::Stdio, time::Duration};

use anyhow::Context as _;
use tokio::process::Command;

use crate::{
    harness::repository,
    world::{ADMIN, ENGINEER, PASSWORD, Places, World},
};

/// Time that a browser may take: pictures of everything are several hundred, drawn without a
/// graphics card.
const PATIENCE: Duration = Duration::from_secs(1800);

/// Beginnings of the lines in which specs say what they measured.
const MEASURED: [&str; 3] = ["first paint: ", "slowest ", "from the README "];

/// Drives both pages through the story of the browser tests: a question, its answer, and the value
/// on the page.
pub(super) async fn partners_page(world: &World) -> anyhow::Result<String> {
    run(world, "test", &["--project=story"]).await
}

/// No page of either daemon has barriers. Light and in English, without dialogs, which is what fits beside the rest; the
/// other looks are looked through with the pictures.
pub(super) async fn without_barriers(world: &World) -> anyhow::Result<String> {
    let of_light = ["--project=accessibility", "--grep=barriers.in.light"];
    run_with(world, "test", &of_light, &[("WITHOUT_DIALOGS", "1".to_owned())]).await
}

/// An operator's tablet loses the network while a person works with it.
pub(super) async fn operators_page(world: &World) -> anyhow::Result<String> {
    run(world, "test", &["--project=operator"]).await
}

/// People meet on each page what others met there in their first week.
pub(super) async fn findings(world: &World) -> anyhow::Result<String> {
    run(world, "test", &["--project=findings"]).await
}

/// A person adds a passkey of the browser, and signs in by it.
pub(super) async fn passkey(world: &World) -> anyhow::Result<String> {
    run(world, "test", &["--project=passkey"]).await
}

/// Runs a script of `tests/browser` against this world.
///
/// # Errors
/// The findings of the browser.
pub async fn run(world: &World, script: &str, arguments: &[&str]) -> anyhow::Result<String> {
    run_with(world, script, arguments, &[]).await
}

/// Runs like [`run`], with further variables.
///
/// # Errors
/// The findings of the browser.
pub async fn run_with(
    world: &World,
    script: &str,
    arguments: &[&str],
    variables: &[(&str, String)],
) -> anyhow::Result<String> {
    run_at(&world.places, script, arguments, variables).await
}

/// Runs like [`run_with`], against a world that another program has started.
///
/// # Errors
/// The findings of the browser.
pub async fn run_at(
    places: &Places,
    script: &str,
    arguments: &[&str],
    variables: &[(&str, String)],
) -> anyhow::Result<String> {
    let entrances = [
        ("PLATFORM_URL", format!("http://127.0.0.1:{}", places.platform_web)),
        ("PLATFORM_USER", ADMIN.to_owned()),
        ("PLATFORM_PASSWORD", PASSWORD.to_owned()),
        ("CONNECTOR_URL", format!("http://127.0.0.1:{}", places.munich.connector_web)),
        ("CONNECTOR_USER", ENGINEER.to_owned()),
        ("CONNECTOR_PASSWORD", PASSWORD.to_owned()),
    ];
    let variables: Vec<_> = entrances.iter().chain(variables).cloned().collect();
    run_alone(script, arguments, &variables).await
}

/// Runs a script of `tests/browser` that starts by itself what it needs.
///
/// # Errors
/// The findings of the browser.
pub async fn run_alone(
    script: &str,
    arguments: &[&str],
    variables: &[(&str, String)],
) -> anyhow::Result<String> {
    let folder = repository()?.join("tests/browser");
    let script = if script == "test" { "playwright test" } else { script };
    // Several runs at once, each with a folder of its own: what one begins with would remove what another one writes.
    let project = arguments.iter().find_map(|argument| argument.strip_prefix("--project="));
    let output = project.map(|project| format!("--output=../../target/browser/{project}"));
    let mut command = Command::new("npx");
    command
        .current_dir(&folder)
        .args(script.split(' '))
        .args(arguments)
        .args(output)
        .envs(variables.iter().map(|(name, value)| (*name, value)))
        .stdin(Stdio::null())
        .kill_on_drop(true);
    let output = tokio::time::timeout(PATIENCE, command.output())
        .await
        .context("the browser did not end in time")?
        .context("starting the browser tests; run `npm ci` in tests/browser first")?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    anyhow::ensure!(output.status.success(), "{text}\n{}", String::from_utf8_lossy(&output.stderr));
    let passed = text.lines().rev().find(|line| line.contains("passed")).unwrap_or_default().trim();
    // What specs measured is worth more than that they passed.
    let measured =
        text.lines().filter(|line| MEASURED.iter().any(|beginning| line.starts_with(beginning)));
    Ok(std::iter::once(passed).chain(measured).collect::<Vec<_>>().join("; "))
}
