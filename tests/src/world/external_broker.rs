//! A broker of another make in place of the platform's own.

use std::{
    fmt::Write as _,
    net::{Ipv4Addr, SocketAddr},
    path::Path,
};

use anyhow::Context as _;
use messaging::{
    BrokerProfile, LinkConfig, Login,
    definitions::{Account, BrokerPlan, QueueLimits, rabbitmq_definitions},
    test_support::{Mosquitto, RabbitMq, Saving},
};

use zeroize::Zeroizing;

use crate::{
    frame_order::{HAMBURG, MUNICH},
    harness::write_private,
};

/// Tool of the buyer that has an account.
pub const TOOL: &str = "Monitoring";
/// File with the passwords of all accounts.
const PASSWORD_FILE: &str = "broker-passwords";

/// Broker between factories and cloud.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BrokerKind {
    /// The platform's own.
    #[default]
    Embedded,
    /// RabbitMQ with its AMQP 1.0 plugin.
    RabbitMq,
    /// Mosquitto, by MQTT 5.
    Mosquitto,
}

impl std::str::FromStr for BrokerKind {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "embedded" => Ok(Self::Embedded),
            "rabbitmq" => Ok(Self::RabbitMq),
            "mosquitto" => Ok(Self::Mosquitto),
            _ => Err("choose embedded, rabbitmq or mosquitto".to_owned()),
        }
    }
}

/// A running broker of another make, with accounts of the platform and both factories.
#[derive(Debug)]
pub struct ExternalBroker {
    process: Process,
    plan: BrokerPlan,
}

#[derive(Debug)]
enum Process {
    RabbitMq(RabbitMq),
    Mosquitto(Mosquitto),
}

impl ExternalBroker {
    /// True where messages that a consumer gives back come behind those that another one gave back before.
    #[must_use]
    pub const fn turns_returned_round(&self) -> bool {
        matches!(self.process, Process::RabbitMq(_))
    }

    /// Starts one; none where the platform's own is asked for.
    pub async fn start(kind: BrokerKind) -> Option<Self> {
        let plan = plan();
        let process = match kind {
            BrokerKind::Embedded => return None,
            BrokerKind::RabbitMq => {
                let definitions = rabbitmq_definitions(&plan, "/", rand::random);
                Process::RabbitMq(RabbitMq::start(&definitions).await)
            }
            BrokerKind::Mosquitto => {
                // As `platform definitions mosquitto` says.
                Process::Mosquitto(Mosquitto::start(&plan, Saving::Always).await)
            }
        };
        Some(Self { process, plan })
    }

    fn url(&self) -> String {
        match &self.process {
            Process::RabbitMq(broker) => broker.url(),
            Process::Mosquitto(broker) => broker.url(),
        }
    }

    /// Returns its address on this machine.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        let url = self.url();
        let port = url.rsplit(':').next().and_then(|port| port.parse().ok()).unwrap_or_default();
        SocketAddr::from((Ipv4Addr::LOCALHOST, port))
    }

    /// True where it accepts messages that are on no disk yet, and that a crash loses.
    #[must_use]
    pub const fn loses_by_a_crash(&self) -> bool {
        matches!(self.process, Process::Mosquitto(_))
    }

    /// Kills it, as a crash does, and starts it again.
    pub async fn crash(&mut self) {
        match &mut self.process {
            Process::RabbitMq(broker) => broker.kill_and_restart().await,
            Process::Mosquitto(broker) => broker.kill_and_restart().await,
        }
    }

    /// Ends and starts again. RabbitMQ is killed here, too: what it confirmed is on its disk.
    pub async fn restart(&mut self) {
        match &mut self.process {
            Process::RabbitMq(broker) => broker.kill_and_restart().await,
            Process::Mosquitto(broker) => broker.restart().await,
        }
    }

    /// Makes a new password for an account, the platform's or a factory's.
    ///
    /// # Panics
    /// Panics when the broker does not take it, or there is no such account.
    pub fn rotate(&mut self, user_name: &str) {
        let password = random_password();
        for account in self
            .plan
            .factories
            .iter_mut()
            .map(|(_, account)| account)
            .chain([&mut self.plan.platform])
        {
            if account.user_name == user_name {
                account.password.clone_from(&password);
            }
        }
        match &self.process {
            Process::RabbitMq(broker) => {
                broker.import(&rabbitmq_definitions(&self.plan, "/", rand::random));
            }
            Process::Mosquitto(broker) => broker.set_password(user_name, &password),
        }
    }

    /// Removes an account. [`Self::rotate`] makes it again.
    pub fn remove_account(&self, user_name: &str) {
        match &self.process {
            Process::RabbitMq(broker) => {
                // A restart would load it again.
                let mut plan = self.plan.clone();
                plan.factories.retain(|(_, account)| account.user_name != user_name);
                broker.import(&rabbitmq_definitions(&plan, "/", rand::random));
                broker.remove_account(user_name);
            }
            Process::Mosquitto(broker) => broker.remove_account(user_name),
        }
    }

    /// Writes the file from which the platform takes the passwords of all accounts.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write_passwords(&self, folder: &Path) -> anyhow::Result<()> {
        let factories = self.plan.factories.iter().map(|(_, account)| account);
        let tools = self.plan.tools.iter().map(|(_, account)| account);
        let accounts = factories.chain(tools).chain([&self.plan.platform]);
        let lines: String = accounts
            .map(|account| format!("{} {}\n", account.user_name, account.password.as_str()))
            .collect();
        let aside = folder.join("broker-passwords.new");
        write_private(&aside, &lines)?;
        std::fs::rename(&aside, folder.join(PASSWORD_FILE)).context("replacing the passwords")
    }

    fn profile(&self) -> BrokerProfile {
        match self.process {
            Process::RabbitMq(_) => BrokerProfile::rabbitmq_3(),
            Process::Mosquitto(_) => BrokerProfile::mqtt(),
        }
    }

    /// Returns the configuration of a link of the tool [`TOOL`], which reads what is for it.
    ///
    /// # Errors
    /// When the tool has no account.
    pub fn link_of_tool(&self) -> anyhow::Result<LinkConfig> {
        let (_, account) = self.plan.tools.first().context("the tool has an account")?;
        let mut config = self.link_of(account)?;
        config.consumed = vec![format!("tool.{TOOL}.reports").parse()?];
        Ok(config)
    }

    /// Returns the configuration of a link that sends with the platform's account, and reads nothing.
    ///
    /// # Errors
    /// When the broker's address is none.
    pub fn link_of_platform(&self) -> anyhow::Result<LinkConfig> {
        self.link_of(&self.plan.platform)
    }

    fn link_of(&self, account: &Account) -> anyhow::Result<LinkConfig> {
        let login = Login::new(account.user_name.clone(), account.password.as_str());
        let mut config = LinkConfig::new(self.url().parse()?, login, &account.user_name);
        config.profile = self.profile();
        Ok(config)
    }

    /// Returns how many messages a queue holds; none where the broker has no queues by name.
    #[must_use]
    pub fn messages_in(&self, queue: &str) -> Option<u64> {
        match &self.process {
            Process::RabbitMq(broker) => Some(broker.messages_in(queue)),
            Process::Mosquitto(_) => None,
        }
    }

    /// Returns the platform's configuration for it. Connectors are sent to the port of a proxy where there is one.
    #[must_use]
    pub fn configuration(&self, folder: &Path, detour: Option<u16>) -> String {
        let url = self.url();
        let (scheme, _) = url.split_once("://").unwrap_or(("amqp", ""));
        let profile = self.profile();
        let mut text = String::from("[broker]\n");
        if let Some(port) = detour {
            let _ = writeln!(text, "public_url = \"{scheme}://127.0.0.1:{port}\"");
        }
        let _ = writeln!(
            text,
            "\n[broker.external]\nurls = [\"{url}\"]\nprofile = \"{}\"\nuser_name = \"{}\"\npassword_file = {:?}",
            profile.name(),
            self.plan.platform.user_name,
            folder.join(PASSWORD_FILE)
        );
        text
    }
}

fn random_password() -> Zeroizing<String> {
    format!("{:032x}", rand::random::<u128>()).into()
}

fn plan() -> BrokerPlan {
    let account = |user_name: String| Account { password: random_password(), user_name };
    let factory = |id: &str| {
        (id.parse().expect("factories of the order have ids"), account(format!("factory.{id}")))
    };
    BrokerPlan {
        platform: account("platform".to_owned()),
        factories: [MUNICH, HAMBURG].map(factory).into(),
        tools: vec![(
            TOOL.parse().expect("tools of the tests have ids"),
            account(format!("tool.{TOOL}")),
        )],
        limits: QueueLimits::default(),
    }
}
