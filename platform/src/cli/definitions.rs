//! Broker definitions for import by the administration of an external broker.

use anyhow::Context;
use clap::ValueEnum;
use messaging::definitions::{
    Account, BrokerPlan, QueueLimits, artemis_broker_xml, mosquitto_acl, rabbitmq_definitions,
};
use platform::{
    config::PlatformConfig,
    store::{Holder, Scope, Store},
};
use rand::RngCore;
use zeroize::Zeroizing;

use super::output;

/// The kinds of broker that definitions are made for.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum BrokerKind {
    /// RabbitMQ: a definitions file for its virtual host `/`.
    Rabbitmq,
    /// ActiveMQ Artemis (untested): elements for `broker.xml`.
    Activemq,
    /// Mosquitto: an access control list.
    Mosquitto,
}

/// Prints the definitions for all factories and tools that the platform knows; each needs an
/// account. Says beside them where nothing was tried with the broker.
pub async fn print(config: &PlatformConfig, kind: BrokerKind) -> anyhow::Result<()> {
    let plan = plan(config).await?;
    if let Some(note) = config.untested_broker() {
        output::note(&note)?;
    }
    let text = match kind {
        BrokerKind::Rabbitmq => {
            let salt = || {
                let mut salt = [0; 4];
                rand::rng().fill_bytes(&mut salt);
                salt
            };
            serde_json::to_string_pretty(&rabbitmq_definitions(&plan, "/", salt))?
        }
        BrokerKind::Activemq => artemis_broker_xml(&plan),
        BrokerKind::Mosquitto => mosquitto_acl(&plan),
    };
    output::print(text.trim_end())
}

async fn plan(config: &PlatformConfig) -> anyhow::Result<BrokerPlan> {
    let external = config.broker.external.as_ref().context("broker.external is not configured")?;
    let store = Store::open(&config.database_path()).await?;
    let mut work = store.read().await?;
    let sealer = config.sealer();
    let account = |user_name: String| {
        let password = external.password_of(&user_name, &sealer);
        let password = password.context("the definitions have the password of each account")?;
        anyhow::Ok(Account { user_name, password: Zeroizing::new(password.expose().clone()) })
    };
    let mut plan = BrokerPlan {
        platform: account(external.user_name.clone())?,
        factories: Vec::new(),
        tools: Vec::new(),
        limits: QueueLimits::default(),
    };
    for factory in work.factories().list(&Scope::Platform).await? {
        let id = factory.factory_id;
        plan.factories.push((id.clone(), account(Holder::Factory(id).user_name())?));
    }
    for tool in work.tools().list(&Scope::Platform).await? {
        let id = tool.tool_id;
        plan.tools.push((id.clone(), account(Holder::Tool(id).user_name())?));
    }
    Ok(plan)
}
