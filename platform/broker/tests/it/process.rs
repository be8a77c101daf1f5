//! The broker in a process of its own, killed without warning.

use std::{
    io::{BufRead, BufReader},
    path::Path,
    process::{Child, Command, Stdio},
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
};

use messaging::{Settlement, spool::memory::AcceptedReports};

use crate::support::{TestBroker, TestLink, address, envelope, eventually};

/// Names the folder to the child; without it the child's test does nothing.
const FOLDER: &str = "BROKER_TEST_FOLDER";
const PORT: &str = "BROKER_TEST_PORT";

/// A broker process, killed when dropped.
pub struct BrokerProcess {
    child: Child,
    pub port: u16,
    panics: Arc<AtomicUsize>,
}

impl BrokerProcess {
    /// Starts this very test program again, as a broker.
    pub fn start(folder: &Path, port: u16) -> Self {
        let mut child = Command::new(std::env::current_exe().expect("this program"))
            .args(["--exact", "process::child_serves_until_it_is_killed", "--nocapture"])
            .env(FOLDER, folder)
            .env(PORT, port.to_string())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("a broker process");
        let out = BufReader::new(child.stdout.take().expect("its output"));
        let (found_port, port) = std::sync::mpsc::channel();
        // To the end, for a full or closed pipe would stop the child.
        std::thread::spawn(move || {
            for line in out.lines().map_while(Result::ok) {
                if let Some((_, port)) = line.split_once("listens:") {
                    let _ = found_port.send(port.trim().parse().expect("a port"));
                }
            }
        });
        let port = port.recv().expect("its port");
        let errors = BufReader::new(child.stderr.take().expect("its errors"));
        let panics = Arc::new(AtomicUsize::new(0));
        let seen = Arc::clone(&panics);
        std::thread::spawn(move || {
            for line in errors.lines().map_while(Result::ok) {
                if line.contains("panicked at") {
                    seen.fetch_add(1, Ordering::Relaxed);
                }
            }
        });
        Self { child, port, panics }
    }

    pub fn url(&self) -> String {
        format!("amqp://127.0.0.1:{}", self.port)
    }

    /// Largest memory that the process has had, in KB.
    pub fn peak_kb(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id()));
        let status = status.expect("the process lives");
        let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let peak = peak.and_then(|peak| peak.trim().strip_suffix("kB"));
        peak.expect("its peak").trim().parse().expect("a number")
    }

    /// Number of panics that the process has reported so far.
    pub fn panics(&self) -> usize {
        self.panics.load(Ordering::Relaxed)
    }

    pub fn kill(mut self) {
        self.child.kill().expect("killed");
        self.child.wait().expect("reaped");
    }
}

impl Drop for BrokerProcess {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn child_serves_until_it_is_killed() {
    let Some(folder) = std::env::var_os(FOLDER) else { return };
    let port: u16 = std::env::var(PORT).expect("a port").parse().expect("a number");
    let broker = TestBroker::start_with(Path::new(&folder), |config| {
        config.listeners[0].address.set_port(port)
    })
    .await;
    #[allow(clippy::print_stdout)]
    {
        println!("\nlistens:{}", broker.port());
    }
    std::future::pending::<()>().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn kills_lose_nothing_that_was_accepted() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut process = BrokerProcess::start(folder.path(), 0);
    let port = process.port;
    let url = format!("amqp://127.0.0.1:{port}");
    let sender = TestLink::start(&url, "f1", &[]);
    let receiver = TestLink::start_with(
        &url,
        "platform",
        &["factory.f1.ingress"],
        AcceptedReports::Leave,
        |config| {
            config.limits.batch = 20;
        },
    );
    receiver.inbox.answer("m3", Settlement::Release);
    let (rounds, per_round) = (6, 300);
    for round in 0..rounds {
        for n in 0..per_round {
            sender.spool.push(
                address("factory.f1.ingress"),
                envelope(format!("m{}", round * per_round + n), vec![b'x'; 300]),
            );
        }
        sender.handle.wake();
        let before = receiver.inbox.ids().len();
        eventually("some arrive", || receiver.inbox.ids().len() > before + 20).await;
        process.kill();
        process = BrokerProcess::start(folder.path(), port);
    }
    eventually("every message arrives", || {
        let mut ids = receiver.inbox.ids();
        ids.sort();
        ids.dedup();
        ids.len() == rounds * per_round
    })
    .await;
    eventually("nothing waits any more", || sender.spool.waiting() == 0).await;
    sender.stop().await;
    receiver.stop().await;
    process.kill();
}
