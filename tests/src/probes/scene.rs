//! The programs under attack, and honest people beside.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use anyhow::Context as _;

use super::{
    amqp,
    entrance::Entrance,
    opcua,
    process::{Memory, mib},
    route::Route,
};
use crate::{
    harness::{Api, say},
    scenario::Cast,
    world::World,
};

/// Growth of a program by one attack, at most.
const GROWTH_MAX: u64 = 96 << 20;
/// Memory of a program, whatever happens.
pub(super) const MEMORY_MAX: u64 = 512 << 20;
/// Addresses by which a program may grow in one attack, used or not: less than the four gigabytes that attackers claim,
/// and more than the arenas and stacks that a busy process adds.
const ADDRESSES_MAX: u64 = 2 << 30;
/// Time in which an honest request has to be answered after an attack.
const ANSWER_MAX: Duration = Duration::from_secs(2);

/// The program that an attack is aimed at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Target {
    Platform,
    /// The platform's broker, a process of its own.
    Broker,
    Connector,
    /// The OPC UA server of the same process.
    Twin,
}

/// The running programs, and people who are signed in.
pub(super) struct Scene {
    pub(super) world: World,
    pub(super) cast: Cast,
    /// Planners of the maker and of the inspector.
    pub(super) maker: Api,
    pub(super) inspector: Api,
    /// Client that came to Munich's OPC UA server while that trusted any certificate.
    pub(super) newcomer: Arc<opcua::Client>,
    pub(super) failures: Vec<String>,
}

impl Scene {
    pub(super) fn before(&self, target: Target) -> anyhow::Result<Before> {
        let memory = self.memory(target)?;
        memory.reset_peak()?;
        let (resident, addresses) = (memory.resident()?, memory.addresses()?);
        Ok(Before { target, memory, resident, addresses, since: Instant::now() })
    }

    pub(super) fn memory(&self, target: Target) -> anyhow::Result<Memory> {
        let platform = self.world.platform.pid();
        Ok(match target {
            Target::Platform => Memory::of(platform),
            Target::Broker => Memory::of_child(platform)?,
            Target::Connector | Target::Twin => {
                let connector = self.world.factories[0].connector.as_ref();
                Memory::of(connector.context("the connector is not started")?.pid())
            }
        })
    }

    /// Prints what an attack brought, and notes it where it was not borne.
    pub(super) async fn judge(
        &mut self,
        name: &str,
        before: Before,
        outcome: anyhow::Result<String>,
    ) -> anyhow::Result<()> {
        let took = before.since.elapsed();
        let Before { target, memory, resident, addresses, .. } = before;
        let mut faults = Vec::new();
        // A supervisor starts a broker again that has crashed.
        if self.memory(target).is_ok_and(|now| now != memory) {
            faults.push("the program ended and was started again".to_owned());
        }
        let peak = self.memory(target).and_then(Memory::peak).unwrap_or_else(|error| {
            faults.push(format!("{error:#}"));
            0
        });
        let grew = peak.saturating_sub(resident);
        let claimed = memory.addresses().unwrap_or_default().saturating_sub(addresses);
        if claimed > ADDRESSES_MAX {
            faults.push(format!("{} MiB of addresses were allocated", mib(claimed)));
        }
        let answer = outcome.unwrap_or_else(|error| {
            faults.push(format!("{error:#}"));
            "not as expected".to_owned()
        });
        if let Err(error) = self.is_served(target).await {
            faults.push(format!("honest people are not served: {error:#}"));
        }
        if grew > GROWTH_MAX || peak > MEMORY_MAX {
            faults.push(format!("{} MiB more, {} MiB in all", mib(grew), mib(peak)));
        }
        let shown = format!("{target:?}").to_lowercase();
        say(&format!(
            "  {shown:<10} {:>6.2} s {:>5} MiB {:>4} MiB  {name}: {answer}",
            took.as_secs_f64(),
            mib(peak),
            mib(grew)
        ));
        for fault in faults {
            say(&format!("  FAIL {name}: {fault}"));
            self.failures.push(format!("{shown}: {name}: {fault}"));
        }
        Ok(())
    }

    /// Fails if the program has ended.
    pub(super) fn runs(&mut self, target: Target) -> anyhow::Result<()> {
        let daemon = match target {
            // The platform ends with its broker.
            Target::Platform | Target::Broker => &mut self.world.platform,
            Target::Connector | Target::Twin => {
                let connector = self.world.factories[0].connector.as_mut();
                connector.context("the connector is not started")?
            }
        };
        if let Some(status) = daemon.ended()? {
            anyhow::bail!("{} ended with {status}:\n{}", daemon.name(), daemon.log_tail(20));
        }
        Ok(())
    }

    /// Fails unless the program runs, and answers an honest request within some time.
    async fn is_served(&mut self, target: Target) -> anyhow::Result<()> {
        self.runs(target)?;
        let took = match target {
            Target::Platform => honest_request(&self.cast.platform).await?,
            Target::Broker => {
                amqp::sign_in(&Entrance::plain(self.world.places.broker_plain)).await?
            }
            Target::Connector => honest_request(&self.cast.munich).await?,
            Target::Twin => opcua::discover(Route::honest(self.world.places.munich.twin)).await?,
        };
        anyhow::ensure!(took < ANSWER_MAX, "an answer took {took:?}");
        Ok(())
    }
}

/// State of a program before an attack.
pub(super) struct Before {
    target: Target,
    memory: Memory,
    resident: u64,
    addresses: u64,
    since: Instant,
}

/// Asks as an honest person does, and returns the time that the answer took.
pub(super) async fn honest_request(api: &Api) -> anyhow::Result<Duration> {
    let begun = Instant::now();
    let _: serde_json::Value = api.get("/api/v1/status").await?;
    Ok(begun.elapsed())
}
