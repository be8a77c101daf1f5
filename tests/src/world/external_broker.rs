//! A broker of another make in place of the platform's own.

use std::{
    fmt::Write as _,
    net::{Ipv4Addr, SocketAddr},
};

use messaging::{
    BrokerProfile,
    definitions::{Account, BrokerPlan, QueueLimits, rabbitmq_definitions},
    test_support::{Mosquitto, RabbitMq, Saving},
};

use crate::frame_order::{HAMBURG, MUNICH};

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
                Process::Mosquitto(Mosquitto::start(&plan, Saving::AtTheEnd).await)
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

    /// Ends and starts again. RabbitMQ is killed: what it confirmed is on its disk. Mosquitto writes its store at an
    /// orderly end alone, so that one is asked to end.
    pub async fn restart(&mut self) {
        match &mut self.process {
            Process::RabbitMq(broker) => broker.kill_and_restart().await,
            Process::Mosquitto(broker) => broker.restart().await,
        }
    }

    /// Returns the platform's configuration for it. Connectors are sent to the port of a proxy where there is one.
    #[must_use]
    pub fn configuration(&self, detour: Option<u16>) -> String {
        let url = self.url();
        let (scheme, _) = url.split_once("://").unwrap_or(("amqp", ""));
        let (scheme, profile) = match self.process {
            Process::RabbitMq(_) => (scheme, BrokerProfile::rabbitmq_3()),
            Process::Mosquitto(_) => (scheme, BrokerProfile::mqtt()),
        };
        let mut text = String::from("[broker]\n");
        if let Some(port) = detour {
            let _ = writeln!(text, "public_url = \"{scheme}://127.0.0.1:{port}\"");
        }
        let Account { user_name, password } = &self.plan.platform;
        let _ = writeln!(
            text,
            "\n[broker.external]\nurls = [\"{url}\"]\nprofile = \"{}\"\nuser_name = \"{user_name}\"\npassword = \
             \"{}\"",
            profile.name(),
            password.as_str()
        );
        for (_, Account { user_name, password }) in &self.plan.factories {
            let password = password.as_str();
            let _ = writeln!(
                text,
                "\n[[broker.external.accounts]]\nuser_name = \"{user_name}\"\npassword = \"{password}\""
            );
        }
        text
    }
}

fn plan() -> BrokerPlan {
    let account = |user_name: String| Account {
        password: format!("{:032x}", rand::random::<u128>()).into(),
        user_name,
    };
    let factory = |id: &str| {
        (id.parse().expect("factories of the order have ids"), account(format!("factory.{id}")))
    };
    BrokerPlan {
        platform: account("platform".to_owned()),
        factories: [MUNICH, HAMBURG].map(factory).into(),
        tools: Vec::new(),
        limits: QueueLimits::default(),
    }
}
