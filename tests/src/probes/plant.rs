//! People at the plant who may look and want more, and texts that others open in a spreadsheet.

use std::time::{Duration, Instant};

use anyhow::Context as _;
use futures::future::join_all;
use reqwest::StatusCode;
use serde_json::{Value, json};

use super::{accounts, scene::honest_request};
use crate::{
    frame_order::{BUYER, MUNICH, NETWORK},
    harness::{Api, ApiError, eventually},
    scenario::story::{field_path, machines},
};

const PATIENCE: Duration = Duration::from_secs(30);
/// Time in which a page has to be served while the ledger is verified.
const SERVED_MAX: Duration = Duration::from_secs(2);
/// Text that a spreadsheet would run.
const FORMULA: &str = "=HYPERLINK(\"http://example.org\";\"1\")";
/// Verifications of the ledger at once.
const VERIFICATIONS: usize = 8;

fn status<T>(answer: &anyhow::Result<T>) -> StatusCode {
    let Err(error) = answer else { return StatusCode::OK };
    let of_problem = error.downcast_ref::<ApiError>().map(|error| error.status);
    of_problem.unwrap_or(StatusCode::IM_A_TEAPOT)
}

/// Reads the live value of a machine, as those who are to see only what left.
pub(super) async fn live_values(engineer: Api) -> anyhow::Result<String> {
    let machine = machines(MUNICH).into_iter().next().context("a machine")?;
    // The server's own clock, which each OPC UA server has.
    let path = format!("/api/v1/sources/{machine}/values");
    let clock = json!({ "nodes": ["i=2258"] });
    let _: Value = engineer.post(&path, &clock).await.context("an engineer reads it")?;
    for (name, role) in [("probe-viewer", "VIEWER"), ("probe-operator", "OPERATOR")] {
        let person = accounts::person(&engineer, name, &json!({ "role": role })).await?;
        let answered = status(&person.post::<Value>(&path, &clock).await);
        anyhow::ensure!(answered == StatusCode::FORBIDDEN, "{role} is answered {answered}");
    }
    Ok("403 for viewers and operators".to_owned())
}

/// Verifies the ledger many times at once, and as a viewer; pages are served meanwhile.
pub(super) async fn verifications(engineer: Api) -> anyhow::Result<String> {
    const PATH: &str = "/api/v1/ledger/verification";
    let viewer = accounts::person(&engineer, "probe-verifier", &accounts::viewer()).await?;
    let answered = status(&viewer.post::<Value>(PATH, &json!({})).await);
    anyhow::ensure!(answered == StatusCode::FORBIDDEN, "a viewer is answered {answered}");
    let nothing = json!({});
    let all = join_all((0..VERIFICATIONS).map(|_| engineer.post::<Value>(PATH, &nothing)));
    let pages = async {
        let mut slowest = Duration::ZERO;
        for _ in 0..10 {
            slowest = slowest.max(honest_request(&engineer).await?);
        }
        anyhow::Ok(slowest)
    };
    let (answers, slowest) = tokio::join!(all, pages);
    let slowest = slowest?;
    let (mut verified, mut refused) = (0, 0);
    for answer in &answers {
        match status(answer) {
            StatusCode::OK => verified += 1,
            StatusCode::CONFLICT | StatusCode::TOO_MANY_REQUESTS => refused += 1,
            other => anyhow::bail!("answered {other}"),
        }
    }
    anyhow::ensure!(verified > 0 && refused > 0, "{verified} verified, {refused} refused");
    anyhow::ensure!(slowest < SERVED_MAX, "a page took {slowest:?}");
    Ok(format!("{verified} done, {refused} refused, pages within {slowest:.1?}"))
}

/// Looks whether the kernel holds the workers of scripts, as the status says.
pub(super) async fn walls(engineer: Api) -> anyhow::Result<String> {
    let workers = eventually("scripts run", PATIENCE, || async {
        let status: Value = engineer.get("/api/v1/status").await.map_err(|e| format!("{e:#}"))?;
        match status["scriptWorkers"].as_array() {
            Some(workers) if !workers.is_empty() => Ok(workers.clone()),
            _ => Err("no worker".to_owned()),
        }
    })
    .await?;
    for worker in &workers {
        let walls = &worker["walls"];
        // A worker that runs without a filter or without bounds would be the hole.
        let is_held = walls["isFiltered"] == true && walls["hasLimits"] == true;
        let is_refused = walls.is_null() && worker["fault"].is_string();
        anyhow::ensure!(is_held || is_refused, "a worker runs without walls: {worker}");
    }
    let held = workers.iter().filter(|worker| !worker["walls"].is_null()).count();
    anyhow::ensure!(held > 0, "no worker runs: {workers:?}");
    Ok(format!(
        "{held} workers with filter and bounds, Landlock {}",
        workers[0]["walls"]["landlock"]
    ))
}

/// Signs a comment with the name of a partner's planner. The platform says whose it is.
pub(super) async fn borrowed_names(platform: Api, engineer: Api) -> anyhow::Result<String> {
    const TEXT: &str = "Please send the truck tomorrow.";
    // With what the platform writes behind the names of partners, and a sign that is not seen.
    let name = format!("planner@{BUYER}\u{200B}");
    let encoded = format!("planner%40{BUYER}%E2%80%8B");
    let role = json!({ "role": "OPERATOR", "password": "a first password" });
    let _: Value = engineer.put(&format!("/api/v1/users/{encoded}"), &role).await?;
    let mut poser = Api::new(engineer.base())?;
    poser.sign_in(&name, "a first password").await?;
    let path = format!("/api/v1/operation-networks/{NETWORK}/comments");
    let _: Value = poser.post(&path, &json!({ "text": TEXT })).await?;
    let shown = eventually("the comment arrives", PATIENCE, || async {
        let comments: Value = platform.get(&path).await.map_err(|e| format!("{e:#}"))?;
        let items = comments["items"].as_array().cloned().unwrap_or_default();
        items.into_iter().find(|item| item["text"] == TEXT).ok_or_else(|| "no comment".to_owned())
    })
    .await?;
    let author = shown["authorId"].as_str().context("an author")?;
    let is_vouched_for = shown["isFromFactory"] == true
        && author.ends_with(&format!("@{MUNICH}"))
        && !author.contains('\u{200B}');
    anyhow::ensure!(is_vouched_for, "shown as {shown}");
    Ok(format!("shown as {author}"))
}

/// Lets a text leave that a spreadsheet would run, and opens what is exported as tables.
pub(super) async fn formulas(engineer: Api) -> anyhow::Result<String> {
    let field = field_path("MakeFrame1", "ReqResponse1", "note");
    let decision = json!({ "mappingState": "MAPPED", "valueSource": "MANUAL", "disclosure": {} });
    let _: Value = engineer.put(&format!("{field}/decision"), &decision).await?;
    let _: Value = engineer.put(&format!("{field}/value"), &json!({ "value": FORMULA })).await?;
    let path = format!("/api/v1/ledger/export?recipient={BUYER}&format=csv");
    let ledger = eventually("the text left", PATIENCE, || async {
        let table = engineer.text(&path).await.map_err(|e| format!("{e:#}"))?;
        if table.contains("HYPERLINK") { Ok(table) } else { Err("not in the ledger".to_owned()) }
    })
    .await?;
    let mappings = engineer.text("/api/v1/mappings/export?form=csv").await?;
    let mut count = 0;
    for cell in [ledger, mappings].iter().flat_map(|table| cells(table)) {
        let text = cell.trim_start_matches([' ', '\u{a0}']);
        let is_formula = text.starts_with(['=', '+', '-', '@', '\t', '\r', '＝', '＋', '－', '＠']);
        anyhow::ensure!(!is_formula || cell.parse::<f64>().is_ok(), "a cell is run: {cell}");
        count += 1;
    }
    anyhow::ensure!(count > 100, "{count} cells were read");
    Ok(format!("none of {count} cells is a formula"))
}

/// Returns the cells of a table (RFC 4180); semicolons part cells, too, as spreadsheets of some languages take them.
fn cells(table: &str) -> Vec<String> {
    let (mut cells, mut cell, mut is_quoted) = (Vec::new(), String::new(), false);
    for sign in table.chars() {
        match sign {
            '"' => is_quoted = !is_quoted,
            ',' | ';' | '\n' if !is_quoted => cells.push(std::mem::take(&mut cell)),
            '\r' if !is_quoted => {}
            other => cell.push(other),
        }
    }
    cells.push(cell);
    cells
}

/// Waits for the status of a source. Returns its state and the kind of its problem.
pub(super) async fn source_is(
    engineer: &Api,
    id: &str,
    wanted: impl Fn(&str, &str) -> bool,
) -> anyhow::Result<()> {
    let begun = Instant::now();
    eventually("the source is as it must be", PATIENCE, || async {
        let status: Value = engineer.get("/api/v1/status").await.map_err(|e| format!("{e:#}"))?;
        let sources = status["sources"].as_array().cloned().unwrap_or_default();
        let source = sources.into_iter().find(|source| source["sourceId"] == id);
        let source = source.ok_or_else(|| format!("no source after {:?}", begun.elapsed()))?;
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let (state, kind) = (text(&source["state"]), text(&source["problem"]["kind"]));
        if wanted(&state, &kind) { Ok(()) } else { Err(source.to_string()) }
    })
    .await
}
