//! The world with everything in it that can go wrong.

mod broker;
mod supervised;

use std::{
    collections::{BTreeMap, BTreeSet},
    net::{Ipv4Addr, SocketAddr},
    path::PathBuf,
    time::{Duration, Instant},
};

use anyhow::Context as _;
use tokio::sync::watch;

use super::{
    broker_ends::BrokerEnds,
    clock::Clock,
    control::LostControls,
    disk::{self, Disk, FilledDisk},
    disturbances::{self, Disturbances},
    interruptions::{Interruptions, interrupts},
    line::{Condition, Line},
    plan::{ClockOffset, Fault, PLATFORM},
    set_back::{self, Held, Newest},
    stores::{self, given_up},
};
use crate::{
    demo::{self, Cast},
    frame_order::{HAMBURG, MUNICH},
    harness::{Daemon, Deadline, Steps, say},
    world::{BrokerKind, ExternalBroker, Places, World},
};

/// Size of a spool, in bytes: it has room for the reports of some seconds, which wait for a receipt, and none for those of
/// an outage.
const SMALL_SPOOL: i64 = 512 << 10;

/// Name of the jumps back of a connector's clock, beside the number of all jumps.
const SET_BACK: &str = "connector clock set back";
/// Seconds by which a clock is set back at least: more than what a network brings out of order.
const SET_BACK_MIN_S: i32 = 60;
/// Time after an outage in which the small spool gives up what it has no room for.
const SPOOL_IS_FULL: Duration = Duration::from_secs(20);
/// Bytes in the small spool up to which it has room for what comes.
const ROOM: i64 = SMALL_SPOOL / 2;

/// Time before a fault in which many comments are on their way.
const HURRY: Duration = Duration::from_millis(250);

/// Everything that runs, and what stands between it.
pub(super) struct Stage {
    pub world: World,
    line: Line,
    // Unmounted after the programs above are gone.
    disks: BTreeMap<&'static str, Disk>,
    clocks: BTreeMap<&'static str, Clock>,
    /// Reports that the broker may have had when it lost its store, or RabbitMQ when the platform's link ended: they
    /// arrive later, out of their order.
    pub set_back: BTreeSet<stores::ReportKey>,
    /// Reports of a connector's store that an older one has replaced.
    pub former: BTreeMap<stores::ReportKey, stores::Left>,
    /// Reports that were given up by its ledger.
    pub former_given_up: given_up::Causes,
    /// Decisions and receipts that the broker may have had when it lost its store.
    pub lost_controls: LostControls,
    /// Times in which connectors may miss values.
    pub disturbed: Disturbances,
    /// Reports that the small spool may have had no room for.
    pub interruptions: Interruptions,
    /// Comments that the broker may have had when it lost its store.
    pub lost_comments: BTreeSet<stores::Comment>,
    /// True where much should be on its way: something is about to be killed, or a disk is full.
    pub comments_hurry: watch::Sender<bool>,
    /// Number of faults by kind.
    pub counts: BTreeMap<&'static str, u32>,
    /// Number of programs that were killed.
    pub kills: u32,
    /// Breaches of what is promised that showed on the way.
    pub faults: Vec<String>,
    /// Disks that were full, as of the last time.
    filled: BTreeMap<&'static str, FilledDisk>,
    broker_ends: BrokerEnds,
    /// Time at which all programs were last seen to run, in ticks.
    supervised_at: i64,
    /// Time at which the machines were asked to stop, in ticks.
    pub machines_stopped: Option<i64>,
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
            former: BTreeMap::new(),
            former_given_up: BTreeMap::new(),
            lost_controls: LostControls::default(),
            disturbed: Disturbances::default(),
            interruptions: Interruptions::default(),
            lost_comments: BTreeSet::new(),
            comments_hurry: watch::Sender::new(false),
            counts: BTreeMap::new(),
            kills: 0,
            faults: Vec::new(),
            filled: BTreeMap::new(),
            broker_ends: BrokerEnds::default(),
            supervised_at: disturbances::now(),
            machines_stopped: None,
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
                connector.set_environment("VERBUND_SPOOL__BYTES_MAX", &SMALL_SPOOL.to_string());
            }
            if let Some(clock) = Clock::of(connector, &folder)? {
                self.clocks.insert(factory.id, clock);
            }
        }
        Ok(())
    }

    /// Returns what has to be done so that disks can be full.
    pub fn lacking_disks(&self) -> Option<&'static str> {
        (self.disks.len() < 3).then_some(
            "disks that will be full are mounted: run as root, or in namespaces of your own with \
             `unshare --map-root-user --mount`",
        )
    }

    /// Returns what has to be done so that clocks can jump.
    pub fn lacking_clocks(&self) -> Option<&'static str> {
        (self.clocks.len() < 3).then_some(
            "clocks jump by libfaketime: install it, as tools/prerequisites.sh test does",
        )
    }

    /// Returns the kinds of faults that every run has to have, that this machine can cause, and that did not strike.
    pub fn missed(&self) -> Vec<&'static str> {
        let has_clock = |whose| self.clocks.contains_key(whose);
        let has_disk = |whose| self.disks.contains_key(whose);
        let is_external = self.world.external.is_some();
        let wanted = [
            (SET_BACK, has_clock(MUNICH) && has_clock(HAMBURG)),
            ("platform clock", has_clock(PLATFORM)),
            ("full disk of the platform", has_disk(PLATFORM)),
            ("full disk of a factory", has_disk(MUNICH) && has_disk(HAMBURG)),
            ("outage", true),
            ("cut", true),
            ("restart broker", is_external),
            ("crash broker", is_external),
            ("kill broker", !is_external),
            ("broker store lost", !is_external),
        ];
        let is_missed = |kind: &str| self.counts.get(kind).is_none_or(|count| *count == 0);
        let missed = wanted.into_iter().filter(|(kind, can_be)| *can_be && is_missed(kind));
        missed.map(|(kind, _)| kind).collect()
    }

    /// Returns the number of all faults that struck.
    pub fn faults_struck(&self) -> u32 {
        self.counts.iter().filter(|(kind, _)| **kind != SET_BACK).map(|(_, count)| count).sum()
    }

    /// Lets it happen; when this returns, everything has been started again and the line is clear. Returns false where
    /// it could not be caused, or nobody noticed.
    pub async fn strike(&mut self, fault: Fault) -> anyhow::Result<bool> {
        self.supervise()?;
        let spool = self.note_room().await?;
        if interrupts(fault, HAMBURG) {
            self.interruptions.begin(spool.first);
        }
        if fault.kills() > 0 || matches!(fault, Fault::FullDisk(..)) {
            self.comments_hurry.send_replace(true);
            tokio::time::sleep(HURRY).await;
        }
        let from = disturbances::now();
        let held = self.held_where_it_turns_round(fault).await?;
        self.note_returned(held.as_ref(), None).await?;
        let (is_caused, newest) = self.cause_and_look(fault).await?;
        self.note_returned(held.as_ref(), newest.as_ref()).await?;
        self.comments_hurry.send_replace(false);
        // A disk that was full may have cost values though its program did not say so.
        if is_caused || matches!(fault, Fault::FullDisk(..)) {
            self.disturbed.struck(fault, from);
        }
        if is_caused {
            *self.counts.entry(fault.kind()).or_default() += 1;
            self.kills += fault.kills();
        }
        Ok(is_caused)
    }

    /// Returns what the platform holds where a broker of another make may deliver other reports out of order by a fault.
    /// RabbitMQ puts what one consumer gives back behind what another gave back before, so that two ends of the
    /// platform's link in a row turn the order round. Mosquitto loses by a crash what it has just accepted: of that,
    /// receipts bring reports again.
    async fn held_where_it_turns_round(&self, fault: Fault) -> anyhow::Result<Option<Held>> {
        let Some(broker) = &self.world.external else { return Ok(None) };
        let turns_round = broker.turns_returned_round() && fault.ends_the_platforms_link();
        if turns_round || (broker.loses_by_a_crash() && fault == Fault::CrashBroker) {
            return Ok(Some(set_back::held(&self.world.places.folder).await?));
        }
        Ok(None)
    }

    /// Notes what may be on its way beside what the platform held before.
    async fn note_returned(
        &mut self,
        held: Option<&Held>,
        newest: Option<&Newest>,
    ) -> anyhow::Result<()> {
        let Some(held) = held else { return Ok(()) };
        let returned = set_back::on_the_way(&self.world.places.folder, held, newest).await?;
        self.set_back.extend(returned);
        Ok(())
    }

    /// Causes a fault. Returns the newest reports at the broker's end as well, where it ends.
    async fn cause_and_look(&mut self, fault: Fault) -> anyhow::Result<(bool, Option<Newest>)> {
        if !fault.ends_the_broker() {
            return Ok((self.cause(fault).await?, None));
        }
        let folder = self.world.places.folder.clone();
        let newest = set_back::newest_at_its_end(&folder);
        let (is_caused, newest) = tokio::join!(self.cause(fault), newest);
        Ok((is_caused?, Some(newest?)))
    }

    /// Returns false where there is nothing to strike.
    async fn cause(&mut self, fault: Fault) -> anyhow::Result<bool> {
        match fault {
            Fault::KillConnector(factory) => self.connector(factory)?.restart()?,
            Fault::KillPlatform => self.world.platform.restart()?,
            Fault::KillBroker => return self.kill_broker().await,
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
            Fault::Stall(span) => self.through(Condition::Stalled, span).await,
            Fault::Outage(span) => return self.outage(span).await,
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
            Fault::CrashBroker => {
                let Some(broker) = &mut self.world.external else { return Ok(false) };
                broker.crash().await;
            }
            Fault::ConnectorClock(who, offset) => return self.jump(who, offset),
            Fault::PlatformClock(offset) => return self.jump(PLATFORM, offset),
            Fault::FullDisk(whose, span) => {
                return self.full_disk(whose, span).await;
            }
            Fault::PauseConnector(factory, span) => {
                return pause(self.connector(factory)?, span).await;
            }
            Fault::PausePlatform(span) => return pause(&mut self.world.platform, span).await,
        }
        Ok(true)
    }

    /// Ends an interruption where the small spool has room again. Returns what is in the spool.
    pub async fn note_room(&mut self) -> anyhow::Result<stores::SpoolSample> {
        let spool = stores::spool(&self.world.places.folder, HAMBURG).await?;
        if spool.bytes <= ROOM {
            self.interruptions.end(spool.last);
        }
        Ok(spool)
    }

    async fn through(&self, condition: Condition, span: Duration) {
        self.line.set(condition);
        tokio::time::sleep(span).await;
        self.line.set(Condition::Clear);
    }

    /// Keeps the line silent for a while, and on until the small spool was too small for what waits. A connector that
    /// has just started looks at it later.
    async fn outage(&self, span: Duration) -> anyhow::Result<bool> {
        let folder = &self.world.places.folder;
        let before = given_up::overflows(folder, HAMBURG).await?;
        self.line.set(Condition::Stalled);
        tokio::time::sleep(span).await;
        let deadline = Deadline::after(SPOOL_IS_FULL);
        let mut now = before;
        while now <= before && !deadline.has_passed() {
            now = given_up::overflows(folder, HAMBURG).await?;
            tokio::time::sleep(Duration::from_millis(100)).await;
        }
        self.line.set(Condition::Clear);
        Ok(now > before)
    }

    fn jump(&mut self, who: &'static str, offset: ClockOffset) -> anyhow::Result<bool> {
        let Some(clock) = self.clocks.get_mut(who) else { return Ok(false) };
        let jump_s = clock.set(offset)?;
        let program = if who == PLATFORM { &self.world.platform } else { self.connector(who)? };
        let is_caused = jump_s != 0 && Clock::is_followed_by(program);
        if is_caused && who != PLATFORM && jump_s <= -SET_BACK_MIN_S {
            *self.counts.entry(SET_BACK).or_default() += 1;
        }
        Ok(is_caused)
    }

    /// Keeps a disk full for a while, and on until its program says so. A store that has room in its own files
    /// notices late.
    async fn full_disk(&mut self, whose: &'static str, span: Duration) -> anyhow::Result<bool> {
        let Some(disk) = self.disks.get(whose) else { return Ok(false) };
        let program = match whose {
            PLATFORM => &self.world.platform,
            _ => {
                let factory = self.world.factories.iter().find(|factory| factory.id == whose);
                factory.and_then(|factory| factory.connector.as_ref()).context("a connector")?
            }
        };
        let before = disk::complaints(program.log());
        let is_felt = disk.fill_until_felt(program.log(), span).await?;
        disk.free()?;
        self.filled.insert(whose, FilledDisk { until: Instant::now(), complaints: before });
        Ok(is_felt)
    }

    fn connector(&mut self, factory: &str) -> anyhow::Result<&mut Daemon> {
        self.world.factory(factory)?.connector.as_mut().context("the connector was started")
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
