//! The world with everything in it that can go wrong.

use std::{
    collections::{BTreeMap, BTreeSet},
    net::{Ipv4Addr, SocketAddr},
    path::PathBuf,
    time::Duration,
};

use anyhow::Context as _;
use tokio::sync::watch;

use super::{
    clock::Clock,
    comments,
    control::LostControls,
    disk::Disk,
    disturbances::{self, Disturbances},
    line::{Condition, Line},
    plan::{ClockOffset, Fault, PLATFORM},
    stores,
};
use crate::{
    demo::{self, Cast},
    frame_order::{HAMBURG, MUNICH},
    harness::{Daemon, Steps, say},
    world::{BrokerKind, ExternalBroker, Places, World},
};

/// Size of a spool, in bytes, that has no room for the values of an outage.
const SMALL_SPOOL: &str = "32768";

/// Time before a fault in which many comments are on their way.
const HURRY: Duration = Duration::from_millis(250);

/// Everything that runs, and what stands between it.
pub(super) struct Stage {
    pub world: World,
    line: Line,
    // Unmounted after the programs above are gone.
    disks: BTreeMap<&'static str, Disk>,
    clocks: BTreeMap<&'static str, Clock>,
    /// Reports that the broker may have had when it lost its store: they arrive later, out of their
    /// order.
    pub set_back: BTreeSet<stores::ReportKey>,
    /// Decisions and receipts that the broker may have had when it lost its store.
    pub lost_controls: LostControls,
    /// Times in which connectors may miss values.
    pub disturbed: Disturbances,
    /// Comments that the broker may have had when it lost its store.
    pub lost_comments: BTreeSet<stores::Comment>,
    /// True where much should be on its way: something is about to be killed, or a disk is full.
    pub comments_hurry: watch::Sender<bool>,
    /// Number of faults by kind.
    pub counts: BTreeMap<&'static str, u32>,
    /// Number of programs that were killed.
    pub kills: u32,
    /// Programs that ended by themselves and were started again, as a supervisor does.
    pub ended: u32,
}

impl Stage {
    /// Starts everything in a folder, with values flowing.
    pub async fn set(
        folder: PathBuf,
        broker: BrokerKind,
        steps: &mut Steps,
    ) -> anyhow::Result<(Self, Cast)> {
        let mut places = Places::anywhere(folder)?;
        let [detour] = free_ports::reserve()?;
        places.broker_detour = Some(detour);
        places.counters = Some(free_ports::reserve()?);
        let mut disks = BTreeMap::new();
        for (whose, folder) in [
            (MUNICH, format!("connector-{MUNICH}")),
            (HAMBURG, format!("connector-{HAMBURG}")),
            (PLATFORM, PLATFORM.into()),
        ] {
            match Disk::mount(&places.folder.join(folder)) {
                Ok(disk) => drop(disks.insert(whose, disk)),
                Err(error) => say(&format!("  The disk of {whose} will not be full: {error:#}")),
            }
        }
        let at = |port| SocketAddr::from((Ipv4Addr::LOCALHOST, port));
        let external = ExternalBroker::start(broker).await;
        let own = at(places.broker_tls);
        let to = external.as_ref().map_or(own, ExternalBroker::address);
        let line = Line::open(at(detour), to).await?;
        let world = World::start_beside(places, external)?;
        let mut stage = Self {
            world,
            line,
            disks,
            clocks: BTreeMap::new(),
            set_back: BTreeSet::new(),
            lost_controls: LostControls::default(),
            disturbed: Disturbances::default(),
            lost_comments: BTreeSet::new(),
            comments_hurry: watch::Sender::new(false),
            counts: BTreeMap::new(),
            kills: 0,
            ended: 0,
        };
        let cast = demo::play(&mut stage.world, steps).await?;
        stage.prepare()?;
        Ok((stage, cast))
    }

    /// Configures the programs' next start: clocks that can jump, and shorter timeouts.
    fn prepare(&mut self) -> anyhow::Result<()> {
        let folder = self.world.places.folder.clone();
        if let Some(clock) = Clock::of(&mut self.world.platform, &folder)? {
            self.clocks.insert(PLATFORM, clock);
        }
        // A part that a broker lost is sent again while the run goes on.
        self.world.platform.set_environment("VERBUND_PARTS__RESEND_AFTER_MS", "5000");
        for factory in &mut self.world.factories {
            let Some(connector) = &mut factory.connector else { continue };
            // A run is too short to wait a minute for each report that a broker lost.
            connector.set_environment("VERBUND_SPOOL__RESEND_AFTER_S", "5");
            if factory.id == HAMBURG {
                connector.set_environment("VERBUND_SPOOL__BYTES_MAX", SMALL_SPOOL);
            }
            if let Some(clock) = Clock::of(connector, &folder)? {
                self.clocks.insert(factory.id, clock);
            }
        }
        Ok(())
    }

    /// Returns what has to be done so that every fault can be caused.
    pub fn lacking(&self) -> Vec<String> {
        let mut lacking = Vec::new();
        if self.disks.len() < 3 {
            lacking.push("run as root, which mounts the disks that will be full".to_owned());
        }
        if self.clocks.len() < 3 {
            lacking.push("install libfaketime, by which clocks jump".to_owned());
        }
        lacking
    }

    /// Returns the kinds of faults that every run has to have, that this machine can cause, and that did not strike.
    pub fn missed(&self) -> Vec<&'static str> {
        let has_any =
            |kinds: &[&str]| kinds.iter().any(|kind| self.counts.get(kind).is_some_and(|n| *n > 0));
        let wanted = [
            (
                "jump of a clock",
                !self.clocks.is_empty(),
                &["connector clock", "platform clock"][..],
            ),
            ("outage", true, &["outage"]),
            ("full disk", !self.disks.is_empty(), &["full disk"][..]),
        ];
        let missed = wanted.into_iter().filter(|(_, can_be, kinds)| *can_be && !has_any(kinds));
        missed.map(|(name, ..)| name).collect()
    }

    /// Lets it happen; when this returns, everything has been started again and the line is clear.
    pub async fn strike(&mut self, fault: Fault) -> anyhow::Result<()> {
        if fault.kills() > 0 || matches!(fault, Fault::FullDisk(..)) {
            self.comments_hurry.send_replace(true);
            tokio::time::sleep(HURRY).await;
        }
        let from = disturbances::now();
        let is_caused = self.cause(fault).await?;
        self.comments_hurry.send_replace(false);
        if is_caused {
            self.disturbed.struck(fault, from);
            *self.counts.entry(fault.kind()).or_default() += 1;
            self.kills += fault.kills();
        }
        Ok(())
    }

    /// Returns false where there is nothing to strike.
    async fn cause(&mut self, fault: Fault) -> anyhow::Result<bool> {
        match fault {
            Fault::KillConnector(factory) => self.connector(factory)?.restart()?,
            Fault::KillPlatform => self.world.platform.restart()?,
            Fault::KillBroker => return Ok(self.world.platform.kill_children() > 0),
            Fault::KillMachines(factory) => self.world.factory(factory)?.simulator.restart()?,
            Fault::KillAll => {
                for daemon in self.world.daemons() {
                    daemon.kill()?;
                }
                for daemon in self.world.daemons() {
                    daemon.restart()?;
                }
            }
            Fault::Cut => self.line.cut(),
            Fault::Stall(span) | Fault::Outage(span) => {
                self.through(Condition::Stalled, span).await
            }
            Fault::Slow(span) => self.through(Condition::Thin, span).await,
            Fault::HalfOpen(span) => {
                self.through(Condition::Swallowing, span).await;
                self.line.cut();
            }
            Fault::LoseBrokerStore | Fault::OldBrokerStore | Fault::DoubleQueued => {
                self.broker_store(fault).await?
            }
            Fault::RestartBroker => {
                let Some(broker) = &mut self.world.external else { return Ok(false) };
                broker.restart().await;
            }
            Fault::ConnectorClock(who, offset) => return self.jump(who, offset),
            Fault::PlatformClock(offset) => return self.jump(PLATFORM, offset),
            Fault::FullDisk(whose, span) => {
                let Some(disk) = self.disks.get(whose) else { return Ok(false) };
                disk.fill()?;
                tokio::time::sleep(span).await;
                disk.free()?;
            }
            Fault::PauseConnector(factory, span) => {
                return pause(self.connector(factory)?, span).await;
            }
            Fault::PausePlatform(span) => return pause(&mut self.world.platform, span).await,
        }
        Ok(true)
    }

    async fn through(&self, condition: Condition, span: Duration) {
        self.line.set(condition);
        tokio::time::sleep(span).await;
        self.line.set(Condition::Clear);
    }

    fn jump(&mut self, who: &'static str, offset: ClockOffset) -> anyhow::Result<bool> {
        let Some(clock) = self.clocks.get_mut(who) else { return Ok(false) };
        let is_other = clock.set(offset)?;
        let program = if who == PLATFORM { &self.world.platform } else { self.connector(who)? };
        Ok(is_other && Clock::is_followed_by(program))
    }

    async fn broker_store(&mut self, fault: Fault) -> anyhow::Result<()> {
        let folder = self.world.places.folder.clone();
        self.world.platform.kill()?;
        match fault {
            Fault::DoubleQueued => stores::double_queued(&folder).await?,
            _ => {
                for factory in [MUNICH, HAMBURG] {
                    self.set_back.extend(stores::unreceipted_reports(&folder, factory).await?);
                }
                self.lost_controls.add(&folder).await?;
                self.lost_comments.extend(comments::on_the_way(&folder).await?);
                if fault == Fault::OldBrokerStore {
                    stores::exchange_broker_store(&folder)?;
                } else {
                    stores::remove_broker_store(&folder)?;
                }
            }
        }
        self.world.platform.restart()
    }

    fn connector(&mut self, factory: &str) -> anyhow::Result<&mut Daemon> {
        self.world.factory(factory)?.connector.as_mut().context("the connector was started")
    }

    /// Starts what has ended by itself. A program may give up where its disk is full; its
    /// supervisor starts it again.
    pub fn supervise(&mut self) -> anyhow::Result<()> {
        for daemon in self.world.daemons() {
            if let Some(status) = daemon.ended()? {
                say(&format!(
                    "    {} ended by itself with {status}:\n{}",
                    daemon.name(),
                    daemon.log_tail(6)
                ));
                daemon.restart()?;
                self.ended += 1;
                for factory in [MUNICH, HAMBURG] {
                    if daemon.name().ends_with(factory) {
                        self.disturbed.ended(factory);
                    }
                }
            }
        }
        Ok(())
    }
}

async fn pause(daemon: &mut Daemon, span: Duration) -> anyhow::Result<bool> {
    // One that has ended cannot be paused; it is started again after the round.
    if daemon.ended()?.is_some() {
        return Ok(false);
    }
    daemon.set_paused(true)?;
    tokio::time::sleep(span).await;
    daemon.set_paused(false)?;
    Ok(true)
}
