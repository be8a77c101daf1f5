//! Bodies of requests to the connector's API, for the fuzz target and for the test that replays its corpus.

use std::{cell::RefCell, collections::BTreeSet, fs, path::PathBuf};

use asi_model::messages::ValueSource;
use connector_state::scene::{self, Scene};
use daemon::web::Problem;
use factory_connector::api::bodies::{BodyReader, OPERATIONS};
use tempfile::TempDir;
use tokio::runtime::{Builder, Runtime};
use twin::{ApplicationCertificate, TrustList, TwinConfig};

/// Certificate of the authority that is trusted before each input; revocation lists among the inputs are of it.
const AUTHORITY: &[u8] = include_bytes!("../authority.der");

/// Parts that bodies are judged by, beside a state that is new for each of them.
struct BodyBench {
    runtime: Runtime,
    folder: TempDir,
    trust_list: TrustList,
    certificate: ApplicationCertificate,
    kept: BTreeSet<PathBuf>,
}

thread_local! {
    static BENCH: RefCell<Option<BodyBench>> = const { RefCell::new(None) };
}

/// Reads bytes as a body. The first one says of which operation. A body that is refused is refused as the caller's
/// fault: no answer is a fault of the connector.
pub fn body(bytes: &[u8]) {
    let Some((operation, outcome)) = read(bytes) else { return };
    if let Err(problem) = outcome {
        assert!((400..500).contains(&problem.status), "{operation}: {problem:?}");
    }
}

/// Returns the operation that the first byte means, and its outcome with the rest.
pub fn read(bytes: &[u8]) -> Option<(&'static str, Result<(), Problem>)> {
    let (number, rest) = bytes.split_first()?;
    let operation = OPERATIONS[usize::from(*number) % OPERATIONS.len()];
    let outcome = BENCH
        .with_borrow_mut(|bench| bench.get_or_insert_with(BodyBench::new).play(operation, rest));
    Some((operation, outcome))
}

impl BodyBench {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let pki = folder.path().to_owned();
        let config = TwinConfig { pki_directory: pki.clone(), ..TwinConfig::default() };
        let certificate = ApplicationCertificate::new(&"F".parse().expect("an id"), config);
        certificate.show().expect("a certificate is made");
        let trust_list = TrustList::of_folder(&pki);
        trust_list.trust_new(AUTHORITY, "eva").expect("an authority's certificate");
        let runtime = Builder::new_current_thread().build().expect("a runtime");
        let mut bench = Self { runtime, folder, trust_list, certificate, kept: BTreeSet::new() };
        bench.kept = bench.files();
        bench
    }

    fn play(&self, operation: &str, body: &[u8]) -> Result<(), Problem> {
        let mut plant = Scene::default();
        plant.map("note", ValueSource::Manual, "{}");
        let field = scene::field(if operation == "enterValue" { "note" } else { "made" });
        let reader = BodyReader {
            state: &mut plant.state,
            field,
            trust_list: &self.trust_list,
            certificate: &self.certificate,
        };
        let outcome = self.runtime.block_on(reader.read(operation, body.to_vec()));
        // A certificate that was added is none of the next input's business.
        if operation == "addClientCertificate" {
            for added in self.files().difference(&self.kept) {
                fs::remove_file(added).expect("a file of the trust list");
            }
        }
        outcome.expect("an operation with a body")
    }

    /// Returns the files of the trust list.
    fn files(&self) -> BTreeSet<PathBuf> {
        let folders = ["trusted", "rejected", "denied", "issuers", "crl"];
        let files = folders.map(|folder| fs::read_dir(self.folder.path().join(folder)));
        let files = files.into_iter().flatten().flatten();
        files.map(|file| file.expect("an entry").path()).collect()
    }
}
