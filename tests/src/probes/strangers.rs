//! Factories of an organisation that is no member of the collaboration, each with a connector that mean people wrote.

use std::{collections::BTreeMap, sync::Arc, time::Duration};

use anyhow::Context as _;
use async_trait::async_trait;
use messaging::{
    Delivery, Envelope, Inbox, Link, LinkConfig, LinkHandle, LogicalAddress, Login, Roots,
    Settlement,
    spool::memory::{AcceptedReports, MemorySpool},
};
use serde_json::{Value, json};
use tokio_util::sync::{CancellationToken, DropGuard};

use super::{amqp, route::Route};
use crate::{
    frame_order::NETWORK,
    harness::{Api, eventually},
};

/// Messages without use that a factory sends: more than are kept of it.
const RUBBISH: usize = 1_200;
/// Letters that are kept of a factory, at most.
const LETTERS_MAX: usize = 1_000;
const PATIENCE: Duration = Duration::from_secs(60);

struct Unread;

#[async_trait]
impl Inbox for Unread {
    async fn receive(&self, _: &LogicalAddress, deliveries: Vec<Delivery>) -> Vec<Settlement> {
        vec![Settlement::Accept; deliveries.len()]
    }
}

/// A factory with a credential for the broker.
struct Stranger {
    factory: &'static str,
    link: LinkHandle,
    spool: Arc<MemorySpool>,
    _end: DropGuard,
}

impl Stranger {
    /// Enrols a factory of an organisation of its own, and connects it.
    async fn enrolled(platform: &Api, factory: &'static str) -> anyhow::Result<Self> {
        let credential = enrol(platform, factory).await?;
        let text = |name: &str| text_of(&credential, name);
        let login = Login::new(text("userName")?, text("password")?);
        let mut config = LinkConfig::new(text("brokerUrl")?.parse()?, login, factory);
        let roots = text("rootCertificatePem")?.into_bytes();
        config.tls.roots = Roots::Pem(roots.into());
        config.consumed = vec![LogicalAddress::FactoryRequests(factory.parse()?)];
        let spool = Arc::new(MemorySpool::new(AcceptedReports::Leave));
        let (running, link) = Link::new(config, Arc::clone(&spool) as _, Arc::new(Unread) as _)?;
        let shutdown = CancellationToken::new();
        tokio::spawn(running.run(shutdown.clone()));
        Ok(Self { factory, link, spool, _end: shutdown.drop_guard() })
    }

    fn send(&self, body: String) -> anyhow::Result<()> {
        let id = uuid::Uuid::new_v4().to_string().parse()?;
        let address = LogicalAddress::FactoryIngress(self.factory.parse()?);
        self.spool.push(address, Envelope::new(id, "ua-data", body));
        self.link.wake();
        Ok(())
    }

    fn address(&self) -> String {
        format!("factory.{}.ingress", self.factory)
    }
}

/// Adds a factory of an organisation of its own, and spends a token. Returns what the platform answers.
async fn enrol(platform: &Api, factory: &str) -> anyhow::Result<Value> {
    let organisation = factory.to_lowercase();
    let body = json!({ "organisationId": organisation, "name": organisation });
    let _: Value = platform.post("/api/v1/organisations", &body).await?;
    let body = json!({ "factoryId": factory, "organisationId": organisation, "name": factory });
    let _: Value = platform.post("/api/v1/factories", &body).await?;
    let path = format!("/api/v1/factories/{factory}/enrolment-tokens");
    let token: Value = platform.post(&path, &json!({})).await?;
    let body = json!({ "token": token["token"], "signingKey": null });
    platform.post("/api/v1/enrolments", &body).await
}

fn text_of(document: &Value, name: &str) -> anyhow::Result<String> {
    document[name].as_str().map(str::to_owned).with_context(|| format!("no {name}"))
}

/// Links to the addresses of another factory, by a factory that is signed in.
pub(super) async fn addresses_of_others(platform: Api, broker: Route) -> anyhow::Result<String> {
    let credential = enrol(&platform, "STR_FOUR").await?;
    let (user, password) = (text_of(&credential, "userName")?, text_of(&credential, "password")?);
    amqp::foreign_addresses(broker, &user, &password).await
}

/// Reports to the requests of others, in a stranger's name: to one that is there, and to one that may come.
pub(super) async fn reports_to_requests_of_others(platform: Api) -> anyhow::Result<String> {
    let stranger = Stranger::enrolled(&platform, "STR_ONE").await?;
    for (number, request) in ["ReqResponse1", "ReqOfTomorrow"].into_iter().enumerate() {
        let text = |text: &str| json!({ "Type": 12, "Body": text });
        let report = json!({ "MessageId": uuid::Uuid::new_v4().to_string(), "MessageType": "ua-data",
            "PublisherId": stranger.factory, "Messages": [ { "DataSetWriterId": 1, "SequenceNumber": number,
            "MetaDataVersion": { "MajorVersion": 608_926_829, "MinorVersion": 608_926_829 },
            "Timestamp": "2026-01-01T00:00:00Z", "Payload": {
                "reportName": text("ProgressReport"), "dynamicDataRequestId": text(request),
                "operationId": text("MakeFrame1"), "operationNetworkId": text(NETWORK),
                "recipientList": { "Type": 12, "Body": ["acme-aero"] },
                "shopfloorTimestamp": { "Type": 13, "Body": "2026-01-01T00:00:00Z" },
                "progressStatus": { "Type": 9, "Body": "666" } } } ] });
        stranger.send(report.to_string())?;
    }
    eventually("both reports are set aside", PATIENCE, || async {
        let letters = letters(&platform).await.map_err(|error| format!("{error:#}"))?;
        let own = |(address, code): &&(String, String)| {
            *address == stranger.address() && code == "FOREIGN_REQUEST"
        };
        let count = letters.iter().filter(own).count();
        if count == 2 { Ok(()) } else { Err(format!("{count} of 2")) }
    })
    .await?;
    let path = format!("/api/v1/reports?operationNetworkId={NETWORK}&limit=500");
    let shown: Value = platform.get(&path).await?;
    anyhow::ensure!(!shown.to_string().contains(stranger.factory), "the buyer reads its report");
    Ok("set aside as FOREIGN_REQUEST, the buyer reads nothing of them".to_owned())
}

/// Rubbish of one factory, more than is kept: what was set aside of another one is there still.
pub(super) async fn floods_dead_letters(platform: Api) -> anyhow::Result<String> {
    let quiet = Stranger::enrolled(&platform, "STR_TWO").await?;
    quiet.send("no JSON".to_owned())?;
    let count = |address: String| {
        let platform = platform.clone();
        async move {
            let letters = letters(&platform).await.map_err(|error| format!("{error:#}"))?;
            let mut counts = BTreeMap::<String, usize>::new();
            for (address, _) in letters {
                *counts.entry(address).or_default() += 1;
            }
            Ok::<_, String>(counts.get(&address).copied().unwrap_or_default())
        }
    };
    eventually("one letter", PATIENCE, || async {
        match count(quiet.address()).await? {
            1 => Ok(()),
            other => Err(format!("{other} letters")),
        }
    })
    .await?;
    let loud = Stranger::enrolled(&platform, "STR_THREE").await?;
    for _ in 0..RUBBISH {
        loud.send("no JSON".to_owned())?;
    }
    let kept = eventually("the rubbish is set aside", PATIENCE, || async {
        let kept = count(loud.address()).await?;
        if kept >= LETTERS_MAX { Ok(kept) } else { Err(format!("{kept} letters")) }
    })
    .await?;
    anyhow::ensure!(kept == LETTERS_MAX, "{kept} letters are kept of one factory");
    let others = count(quiet.address()).await.map_err(anyhow::Error::msg)?;
    anyhow::ensure!(others == 1, "the letter of another factory is gone");
    Ok(format!("{kept} of {RUBBISH} are kept, and the letter of another factory is"))
}

/// Returns address and code of all dead letters.
async fn letters(platform: &Api) -> anyhow::Result<Vec<(String, String)>> {
    let (mut found, mut cursor) = (Vec::new(), String::new());
    loop {
        let page: Value = platform.get(&format!("/api/v1/dead-letters?limit=500{cursor}")).await?;
        for letter in page["items"].as_array().into_iter().flatten() {
            let text = |name: &str| letter[name].as_str().unwrap_or_default().to_owned();
            found.push((text("address"), text("code")));
        }
        let Some(next) = page["nextCursor"].as_str() else { return Ok(found) };
        cursor = format!("&cursor={next}");
    }
}
