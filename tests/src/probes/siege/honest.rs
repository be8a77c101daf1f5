//! Honest people under siege: what they ask for, and how long that takes.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use anyhow::Context as _;
use futures::future::join_all;
use serde_json::Value;

use super::judgement::Times;
use crate::{
    harness::Api,
    probes::{
        accounts, amqp,
        entrance::{Entrance, Layers, trusting},
        http, opcua,
        route::Route,
        scene::{Scene, honest_request},
    },
};

/// Rounds of each kind before the siege.
const ROUNDS: usize = 40;
/// Pause between two requests of one kind.
const PAUSE: Duration = Duration::from_millis(200);
/// Time after which a person gives up.
const PATIENCE: Duration = Duration::from_secs(60);
/// Name and password of honest people, which others guess meanwhile.
pub(super) const NAME: &str = "honest-person";
const PASSWORD: &str = "a first password";

/// Kinds of honest requests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Page(Program),
    NewCaller(Program),
    SignIn(Program),
    Broker,
    BrokerInTls,
    BrokerInWebSocket,
    Discovery,
    TwinSignIn,
}

/// Programs with pages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Program {
    Platform,
    Connector,
}

impl Kind {
    pub const ALL: [Self; 11] = [
        Self::Page(Program::Platform),
        Self::Page(Program::Connector),
        Self::NewCaller(Program::Platform),
        Self::NewCaller(Program::Connector),
        Self::SignIn(Program::Platform),
        Self::SignIn(Program::Connector),
        Self::Broker,
        Self::BrokerInTls,
        Self::BrokerInWebSocket,
        Self::Discovery,
        Self::TwinSignIn,
    ];

    /// Names it for people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Page(Program::Platform) => "a page of the platform",
            Self::Page(Program::Connector) => "a page of the connector",
            Self::NewCaller(Program::Platform) => "a new caller of the platform",
            Self::NewCaller(Program::Connector) => "a new caller of the connector",
            Self::SignIn(Program::Platform) => "a sign-in with a password at the platform",
            Self::SignIn(Program::Connector) => "a sign-in with a password at the connector",
            Self::Broker => "a sign-in at the broker",
            Self::BrokerInTls => "a sign-in at the broker in TLS",
            Self::BrokerInWebSocket => "a sign-in at the broker in a WebSocket",
            Self::Discovery => "a discovery at the OPC UA server",
            Self::TwinSignIn => "a sign-in with a password at the OPC UA server",
        }
    }
}

/// People who ask as they always do.
pub(super) struct Honest {
    platform: Api,
    connector: Api,
    ports: [u16; 2],
    /// Entrances of the broker: as it is, in TLS, in a WebSocket.
    broker: [Entrance; 3],
    twin: Route,
    client: opcua::Client,
    folder: tempfile::TempDir,
}

impl Honest {
    /// Adds an honest person to each program, and lets the connector trust the client of one.
    pub async fn among(scene: &Scene) -> anyhow::Result<Self> {
        let (places, cast) = (&scene.world.places, &scene.cast);
        for (administrator, role) in
            [(&cast.platform, accounts::planner()), (&cast.munich, accounts::engineer())]
        {
            accounts::person(administrator, NAME, &role).await?;
        }
        let tls = trusting(&places.folder.join("platform"))?;
        let websocket = places.broker_websocket.context("a broker in WebSockets")?;
        let client = opcua::Client::named("probe of honest people")?;
        opcua::trust(&cast.munich, &client).await?;
        Ok(Self {
            platform: cast.platform.clone(),
            connector: cast.munich.clone(),
            ports: [places.platform_web, places.munich.connector_web],
            broker: [
                Entrance::plain(places.broker_plain),
                Entrance { port: places.broker_tls, layers: Layers::Tls(Arc::clone(&tls)) },
                Entrance { port: websocket, layers: Layers::WebSocket(tls) },
            ],
            twin: Route::honest(places.munich.twin),
            client,
            folder: tempfile::tempdir()?,
        })
    }

    /// Makes honest requests of all kinds beside each other, some rounds or until a time. Returns those of each
    /// kind, and what failed.
    pub async fn ask(&self, until: Option<Instant>) -> (Vec<Times>, Vec<String>) {
        let rounds = join_all(Kind::ALL.map(|kind| self.rounds(kind, until))).await;
        let (times, failed): (Vec<_>, Vec<_>) = rounds.into_iter().unzip();
        (times, failed.into_iter().flatten().collect())
    }

    async fn rounds(&self, kind: Kind, until: Option<Instant>) -> (Times, Vec<String>) {
        let (mut times, mut failed, mut round) = (Times::default(), Vec::new(), 0);
        while until.map_or(round < ROUNDS, |until| Instant::now() < until) {
            round += 1;
            match tokio::time::timeout(PATIENCE, self.one(kind)).await {
                Ok(Ok(took)) => times.add(took),
                Ok(Err(error)) => failed.push(format!("{}: {error:#}", kind.name())),
                Err(_) => failed.push(format!("{}: no answer in {PATIENCE:?}", kind.name())),
            }
            tokio::time::sleep(PAUSE).await;
        }
        (times, failed)
    }

    async fn one(&self, kind: Kind) -> anyhow::Result<Duration> {
        let [plain, tls, websocket] = &self.broker;
        match kind {
            Kind::Page(program) => honest_request(self.api(program)).await,
            Kind::NewCaller(program) => {
                new_caller(self.ports[usize::from(program == Program::Connector)]).await
            }
            Kind::SignIn(program) => sign_in(self.api(program)).await,
            Kind::Broker => amqp::sign_in(plain).await,
            Kind::BrokerInTls => amqp::sign_in(tls).await,
            Kind::BrokerInWebSocket => amqp::sign_in(websocket).await,
            Kind::Discovery => opcua::discover(self.twin).await,
            Kind::TwinSignIn => self.twin_sign_in().await,
        }
    }

    const fn api(&self, program: Program) -> &Api {
        match program {
            Program::Platform => &self.platform,
            Program::Connector => &self.connector,
        }
    }

    async fn twin_sign_in(&self) -> anyhow::Result<Duration> {
        let begun = Instant::now();
        let (folder, url) = (self.folder.path(), self.twin.opcua_url());
        let is_in = self.client.signs_in(folder, &url, (NAME, PASSWORD)).await?;
        anyhow::ensure!(is_in, "an honest person is not let in");
        Ok(begun.elapsed())
    }
}

/// Asks over a connection of its own, and returns the time that it took.
async fn new_caller(port: u16) -> anyhow::Result<Duration> {
    let begun = Instant::now();
    http::client()?
        .get(format!("http://127.0.0.1:{port}/healthz"))
        .send()
        .await?
        .error_for_status()?;
    Ok(begun.elapsed())
}

/// Signs in with a new browser, and returns the time that it took until a page was there.
async fn sign_in(at: &Api) -> anyhow::Result<Duration> {
    let begun = Instant::now();
    let mut browser = Api::new(at.base())?;
    browser.sign_in(NAME, PASSWORD).await?;
    let _: Value = browser.get("/api/v1/session").await?;
    Ok(begun.elapsed())
}
