use std::{
    path::PathBuf,
    process::{Child, Command, Stdio},
};

use rand::{Rng as _, SeedableRng as _};

use super::{failures::consistent, *};

/// Variable that names the store's folder to the test's second process; without it that test does
/// nothing.
const FOLDER: &str = "VERBUND_TEST_CRASH_FOLDER";
/// Number of times that the process is killed.
const KILLS: usize = 12;
const SEED: u64 = 20_261_122;

/// A process that discloses, sends, receipts and revokes without end is killed again and again, at
/// moments that no transaction knows of.
#[tokio::test]
async fn kills_at_any_point_leave_chain_and_spool_consistent() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut random = rand::rngs::StdRng::seed_from_u64(SEED);
    let mut reports = 0;
    for kill in 0..KILLS {
        let mut process = working(folder.path());
        let wanted = reports + random.random_range(1..80);
        reports = reach(folder.path(), wanted, &mut process).await;
        process.kill().expect("killed");
        process.wait().expect("ended");
        let mut connection = connect(folder.path()).await;
        consistent(&mut connection).await;
        assert!(reports >= wanted, "kill {kill} of seed {SEED}");
    }
}

/// Body of the killed process: discloses and sends without end.
#[tokio::test]
async fn work_until_killed() {
    let Some(folder) = std::env::var_os(FOLDER) else { return };
    let running = Running::open_in(PathBuf::from(folder), None).await;
    running.receive("operation-network", network(1)).await;
    for round in 0_u64.. {
        if round % 40 == 0 {
            running.open_fields().await;
        }
        running.enter_both(now().unix_micros().unsigned_abs()).await;
        let rows = running.fetch(Lane::Reports).await;
        running.accept(&rows).await;
        if let Some(report) = rows.last().and_then(|row| super::reports(row).into_iter().next()) {
            running.receipt(&report, u32::try_from(report.sequence).expect("small")).await;
        }
        if round % 40 == 39 {
            running.revoke(None).await;
        }
    }
}

fn working(folder: &Path) -> Child {
    let test = std::env::current_exe().expect("this test");
    Command::new(test)
        .args(["--exact", "coordinator::tests::crash::work_until_killed", "--nocapture"])
        .env(FOLDER, folder)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("started")
}

/// Waits until so many reports are there.
async fn reach(folder: &Path, wanted: i64, process: &mut Child) -> i64 {
    let until = Instant::now() + DEADLINE;
    let mut connection: Option<SqliteConnection> = None;
    loop {
        assert!(Instant::now() < until, "{wanted} reports are made in time");
        assert_eq!(process.try_wait().expect("asked"), None, "it works until it is killed");
        // The first process makes the file.
        if connection.is_none() && folder.join("generation").exists() {
            connection = Some(connect(folder).await);
        }
        if let Some(connection) = &mut connection {
            let count: i64 = sqlx::query_scalar("SELECT count(*) FROM report")
                .fetch_one(connection)
                .await
                .expect("counted");
            if count >= wanted {
                return count;
            }
        }
        tokio::time::sleep(PAUSE).await;
    }
}

#[tokio::test]
async fn the_newest_lane_has_no_report_older_than_a_sent_one() {
    let running = Running::with_two_open_fields().await;
    running.enter_both(1).await;
    running.enter_both(2).await;
    let newest = running.fetch(Lane::Newest).await;
    assert_eq!(newest.len(), 1, "the second message has the newest report of both writers");
    assert_eq!(
        newest.last().map(|row| row.id),
        running.fetch(Lane::Reports).await.last().map(|row| row.id)
    );
    // It leaves, and the connection is lost: the first message waits still, but would come behind
    // the second.
    assert_eq!(running.accept(&newest).await, 1);
    assert_eq!(running.fetch(Lane::Newest).await, []);
    assert_eq!(running.fetch(Lane::Reports).await.len(), 1);
    // A newer message is the newest again, with one report only.
    running.enter(vec![entry("made", json!(3))]).await.expect("written");
    let newest = running.fetch(Lane::Newest).await;
    assert_eq!(newest.iter().map(reports).map(|reports| reports.len()).collect::<Vec<_>>(), [1]);
}
