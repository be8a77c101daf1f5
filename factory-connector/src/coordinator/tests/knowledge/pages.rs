//! Pages and exports as people who may not decide see them, through the whole API.

use std::path::Path;

use axum::{
    Router,
    body::{Body, to_bytes},
    extract::ConnectInfo,
    http::{Request, header, response::Parts},
};
use daemon::{
    sealing::{Sealer, SealingConfig},
    telemetry::Metrics,
    web::{
        client_address::TrustedProxies,
        health::Readiness,
        session::{PasswordHash, PasswordHashing, PasswordPolicy},
        shares::PersonShare,
    },
};
use mapping_engine::{MappingEngine, MappingEngineConfig};
use tokio::sync::watch;
use tower::ServiceExt as _;

use super::{
    fields::{FIELDS, FieldOf, PARTNERS},
    plant::{self, Plant},
    *,
};
use crate::{
    api::{self, Api, ApiParts, RunningConnector, ServerParts},
    catalog::Catalog,
    coordinator::commands::handle_command,
    lease::{LeaseState, LeaseStatus},
    store::{Role, User},
};

const PASSWORD: &str = "a password of their own";
/// Addresses of what never ends, and of sessions with their random ids and tokens.
const LEFT_OUT: [&str; 3] = ["/api/v1/events", "/api/v1/session", "/api/v1/sessions"];

/// Addresses to read at the end of a history, and the password of who reads.
pub(super) struct Pages {
    addresses: Vec<String>,
    password_hash: String,
}

impl Pages {
    /// Takes all that can be read from the API's description.
    pub(super) fn of_description() -> Self {
        let description = serde_json::to_value(api::openapi()).expect("JSON");
        let paths = description["paths"].as_object().expect("paths");
        let read = paths
            .iter()
            .filter(|(path, item)| item.get("get").is_some() && !LEFT_OUT.contains(&path.as_str()));
        let password = PASSWORD.to_owned().into();
        let hash = PasswordHash::of(&password, PasswordPolicy::default()).expect("long enough");
        Self {
            addresses: read.flat_map(|(path, _)| filled(path)).collect(),
            password_hash: hash.as_str().to_owned(),
        }
    }
}

/// Returns the addresses of a path with parameters.
fn filled(path: &str) -> Vec<String> {
    if path.ends_with("/ledger/export") {
        let of = |partner: &str| {
            ["jsonl", "csv", "html"].map(|form| format!("{path}?recipient={partner}&format={form}"))
        };
        return PARTNERS.iter().flat_map(|partner| of(partner)).collect();
    }
    let of = |field: &FieldOf| {
        let path = path.replace("{operationNetworkId}", "n").replace("{operationId}", "op");
        let request = format!("R{}", field.request);
        let path = path.replace("{dynamicDataRequestId}", &request);
        let mut path = path.replace("{fieldName}", field.name);
        while let Some((before, after)) = path.split_once('{') {
            let after = after.split_once('}').map_or("", |(_, after)| after);
            path = format!("{before}policy-0{after}");
        }
        path
    };
    // A number of each request, a text, an array, a structure and a value with a status of its own: lists
    // have all fields.
    let names = ["level", "note", "curve", "samples", "part", "count"];
    let shown = FIELDS.iter().filter(|field| names.contains(&field.name));
    let mut addresses: Vec<String> = shown.map(of).collect();
    addresses.sort_unstable();
    addresses.dedup();
    addresses
}

/// Members of a certificate that the connector has made for itself, by a key that is new in each plant.
const OF_OWN_CERTIFICATES: [&str; 4] = ["thumbprint", "fingerprint", "content", "validTo"];

/// Replaces what is of the connector's own certificate, and none of the plant's.
fn without_own_certificate(body: &str) -> String {
    let parts: Vec<&str> = body.split('"').collect();
    let is_own =
        |at: usize| at >= 2 && parts[at - 1] == ":" && OF_OWN_CERTIFICATES.contains(&parts[at - 2]);
    let parts = parts.iter().enumerate().map(|(at, part)| if is_own(at) { "own" } else { part });
    parts.collect::<Vec<_>>().join("\"")
}

/// Replaces the machine's time, which is none of the plant's.
fn without_present(body: &str) -> String {
    let now = crate::clock::now();
    let is_present = |text: &str| {
        let at: Option<DateTime> = serde_json::from_value(json!(text)).ok();
        at.is_some_and(|at| now.since(at).max(at.since(now)) < Duration::from_secs(3600))
    };
    let parts = body.split('"').map(|text| if is_present(text) { "present" } else { text });
    parts.collect::<Vec<_>>().join("\"")
}

impl Plant {
    /// Reads all pages as a person of a role. Returns how many of them there are for one.
    pub(super) async fn read(&mut self, pages: &Pages, user_name: &str, role: Role) -> usize {
        let (handle, mut asked) = channel();
        let router = self.router(handle);
        // Exports of what left are an engineer's; everything else is read in the role.
        let mut cookies = Vec::new();
        for (name, role) in [(user_name, role), ("eva", Role::Engineer)] {
            let password_hash = pages.password_hash.clone();
            let user = User { user_name: name.to_owned(), role, password_hash };
            let mut session = Store::connect(self.folder.path()).await.expect("a connection");
            session.users().put(&user, self.now).await.expect("stored");
            drop(session);
            let credentials = json!({ "userName": name, "password": PASSWORD }).to_string();
            let sign_in = Request::post("/api/v1/session")
                .header(header::CONTENT_TYPE, "application/json")
                .body(Body::from(credentials))
                .expect("a request");
            let (head, body) = answer(&mut self.work, &mut asked, &router, sign_in).await;
            assert!(head.status.is_success(), "{body}");
            let cookie = head.headers[header::SET_COOKIE].to_str().expect("text");
            cookies.push(cookie.split(';').next().expect("a cookie").to_owned());
        }
        let mut count = 0;
        for address in &pages.addresses {
            let cookie = &cookies[usize::from(address.contains("/ledger/export"))];
            let request = Request::get(address).header(header::COOKIE, cookie);
            let request = request.body(Body::empty()).expect("a request");
            let (head, body) = answer(&mut self.work, &mut asked, &router, request).await;
            count += usize::from(head.status.is_success());
            let mut body = without_present(&body);
            if address.ends_with("/source-client-certificate") {
                body = without_own_certificate(&body);
            }
            self.seen.push(format!("page {address}: {} {body}", head.status));
        }
        count
    }

    fn router(&self, coordinator: CoordinatorHandle) -> Router {
        let folder = self.folder.path().to_owned();
        let floor_config = shop_floor::Config::new(folder.join("source-pki"), "plant", "urn:plant");
        let (_, shop_floor, changes) = shop_floor::ShopFloor::new(floor_config);
        let (_, engine, _) =
            MappingEngine::new(MappingEngineConfig::default(), shop_floor.clone(), changes);
        let (_, catalog) = Catalog::new(shop_floor.clone());
        let lease = LeaseStatus {
            state: LeaseState::Asking,
            since: plant::start(),
            host: String::new(),
            lease_number: None,
            holder: None,
            contender: None,
        };
        let outputs = &self.work.outputs;
        let parts = ApiParts {
            coordinator,
            readers: self.work.store.readers(),
            shop_floor,
            engine,
            catalog,
            twin: outputs.twin.clone(),
            link: None,
            lease: watch::channel(lease).1,
            events: outputs.events.clone(),
            users_changed: Arc::default(),
            instance: RunningConnector {
                factory_id: self.work.config.state.factory_id.clone(),
                started_at: plant::start(),
                // Not where it is: folders have random names.
                data_directory: PathBuf::from("plant"),
                sealer: Sealer::new(&SealingConfig::default(), Path::new("plant")),
                encoding: Encoding::Digicor,
                settings: Vec::new(),
                plaintext_ways: Vec::new(),
            },
            server: ServerParts {
                readiness: Readiness::new(),
                metrics: Metrics::install().expect("a recorder"),
                shutdown: CancellationToken::new(),
                is_secure: false,
                port: 8090,
                public_url: String::new(),
                trusted_proxies: TrustedProxies::default(),
                share_per_person: PersonShare::default(),
                hashing: PasswordHashing::default(),
            },
        };
        api::router(Api::new(parts), false)
    }
}

/// Sends a request, and takes the coordinator's part until the answer is there.
async fn answer(
    work: &mut UnitOfWork,
    asked: &mut mpsc::Receiver<CoordinatorCommand>,
    router: &Router,
    mut request: Request<Body>,
) -> (Parts, String) {
    let client: std::net::SocketAddr = "127.0.0.1:1".parse().expect("an address");
    request.extensions_mut().insert(ConnectInfo(client));
    let answer = async {
        let (head, body) = router.clone().oneshot(request).await.expect("an answer").into_parts();
        let body = to_bytes(body, usize::MAX).await.expect("a body");
        (head, String::from_utf8_lossy(&body).into_owned())
    };
    tokio::pin!(answer);
    loop {
        tokio::select! {
            answer = &mut answer => return answer,
            Some(command) = asked.recv() => {
                if let Some(reply) = handle_command(work, command).await.expect("the store is read") {
                    reply(true);
                }
            }
        }
    }
}
