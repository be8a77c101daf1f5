//! Values of a machine's variables over time, and their changes.

use std::{collections::HashMap, sync::Arc, time::Duration};

use asi_model::{DataValue, DateTime, StatusCode, Variant};

use crate::{
    MachineConfig,
    blueprint::{Blueprint, Class, Source},
    clock::now,
    server::MachineServer,
    signals::Moment,
};

pub(super) struct Engine {
    blueprint: Arc<Blueprint>,
    seed: u64,
    speed: f64,
    epoch: DateTime,
    changes_per_second: f64,
    counters: Vec<usize>,
    /// Changes of the bank's counters so far.
    counted: u64,
    /// Last published values, by node of the blueprint.
    last: HashMap<usize, (Variant, StatusCode)>,
    held: HashMap<String, (Variant, StatusCode)>,
    statuses: HashMap<String, StatusCode>,
    status: StatusCode,
    clock_ahead_ms: i64,
    stands_still: bool,
}

impl Engine {
    pub(super) fn new(
        config: &MachineConfig,
        blueprint: Arc<Blueprint>,
        seed: u64,
        speed: f64,
        epoch: DateTime,
    ) -> Self {
        let is_counter = |class: &Class| matches!(class, Class::Variable(plan) if matches!(plan.source, Source::Counter));
        let nodes = blueprint.nodes.iter().enumerate();
        let counters =
            nodes.filter(|(_, node)| is_counter(&node.class)).map(|(index, _)| index).collect();
        Self {
            blueprint,
            seed: config.seed(seed),
            speed,
            epoch,
            changes_per_second: config.changes_per_second,
            counters,
            counted: 0,
            last: HashMap::new(),
            held: HashMap::new(),
            statuses: HashMap::new(),
            status: StatusCode::GOOD,
            clock_ahead_ms: 0,
            stands_still: false,
        }
    }

    /// Publishes what changed until now.
    pub(super) fn update(&mut self, server: &MachineServer) {
        if self.stands_still {
            return;
        }
        let now = now();
        let moment =
            Moment { seed: self.seed, seconds: now.since(self.epoch).as_secs_f64() * self.speed };
        let at = self.machine_time(now);
        let mut changed = self.changed_signals(moment);
        changed.extend(self.changed_counters(moment));
        let blueprint = Arc::clone(&self.blueprint);
        server.publish(changed.into_iter().map(|(index, value, status)| {
            (blueprint.nodes[index].key.as_str(), data_value(value, status, at))
        }));
    }

    /// Holds a variable at a value; returns what is to be published.
    pub(super) fn hold(&mut self, key: &str, value: Variant, status: StatusCode) -> DataValue {
        self.held.insert(key.to_owned(), (value.clone(), status));
        if let Some(index) = self.index_of(key) {
            self.last.insert(index, (value.clone(), status));
        }
        data_value(value, status, self.machine_time(now()))
    }

    /// Lets a variable run again.
    pub(super) fn release(&mut self, key: &str) {
        self.held.remove(key);
    }

    /// A new server knows nothing yet.
    pub(super) fn forget(&mut self) {
        self.last.clear();
        self.counted = 0;
    }

    pub(super) fn stand_still(&mut self, stands_still: bool) {
        self.stands_still = stands_still;
    }

    pub(super) fn have_status(&mut self, key: Option<String>, status: StatusCode) {
        match key {
            Some(key) => {
                self.statuses.insert(key, status);
            }
            None => self.status = status,
        }
    }

    pub(super) fn set_clock(&mut self, ahead_ms: i64) {
        self.clock_ahead_ms = ahead_ms;
        // All values are told again, with the new time.
        self.last.clear();
    }

    pub(super) fn heal(&mut self) {
        self.stands_still = false;
        self.statuses.clear();
        self.status = StatusCode::GOOD;
        self.clock_ahead_ms = 0;
    }

    fn index_of(&self, key: &str) -> Option<usize> {
        self.blueprint
            .nodes
            .iter()
            .position(|node| node.key == key && matches!(node.class, Class::Variable(_)))
    }

    fn changed_signals(&mut self, moment: Moment) -> Vec<(usize, Variant, StatusCode)> {
        let mut changed = Vec::new();
        for (index, node) in self.blueprint.nodes.iter().enumerate() {
            let Class::Variable(plan) = &node.class else { continue };
            let held = self.held.get(&node.key);
            let (value, status) = match (held, &plan.source) {
                (Some(held), _) => held.clone(),
                (None, Source::Signal(signal)) => (signal(moment), StatusCode::GOOD),
                (None, Source::Time(time)) => (self.time_of(time(moment)).into(), StatusCode::GOOD),
                (None, Source::Written(_) | Source::Counter) => continue,
            };
            let status = self.status_of(&node.key, status);
            let is_same =
                self.last.get(&index).is_some_and(|last| last.0 == value && last.1 == status);
            if !is_same {
                self.last.insert(index, (value.clone(), status));
                changed.push((index, value, status));
            }
        }
        changed
    }

    /// Change number `n` sets counter `n % counters` to `n / counters + 1`; at first all are told
    /// their present value.
    fn changed_counters(&mut self, moment: Moment) -> Vec<(usize, Variant, StatusCode)> {
        let counters = self.counters.len() as u64;
        if counters == 0 {
            return Vec::new();
        }
        let total = (moment.seconds * self.changes_per_second) as u64;
        let first = if self.counted == 0 { total.saturating_sub(counters) } else { self.counted };
        // After a long pause only the newest value of each is told.
        let first = first.max(total.saturating_sub(counters));
        let value = |change: u64| i64::try_from(change / counters + 1).unwrap_or(i64::MAX);
        let mut changed = Vec::with_capacity(usize::try_from(total - first).unwrap_or(0));
        if self.counted == 0 {
            for counter in total..counters {
                changed.push((self.counters[counter as usize], 0_i64.into(), self.status));
            }
        }
        for change in first..total {
            changed.push((
                self.counters[(change % counters) as usize],
                value(change).into(),
                self.status,
            ));
        }
        self.counted = total.max(1);
        changed
    }

    fn status_of(&self, key: &str, own: StatusCode) -> StatusCode {
        let injected = self.statuses.get(key).copied().unwrap_or(self.status);
        if injected == StatusCode::GOOD { own } else { injected }
    }

    /// Time of the machine's clock at a simulated time.
    fn time_of(&self, seconds: f64) -> DateTime {
        let passed = Duration::try_from_secs_f64((seconds / self.speed).round());
        self.machine_time(self.epoch.after(passed.unwrap_or_default()))
    }

    /// Returns the present time by the machine's clock.
    pub(super) fn time(&self) -> DateTime {
        self.machine_time(now())
    }

    fn machine_time(&self, now: DateTime) -> DateTime {
        let ahead = Duration::from_millis(self.clock_ahead_ms.unsigned_abs());
        if self.clock_ahead_ms >= 0 {
            now.after(ahead)
        } else {
            DateTime::from_ticks(
                now.ticks() - i64::try_from(ahead.as_nanos() / 100).unwrap_or(i64::MAX),
            )
        }
    }
}

fn data_value(value: Variant, status: StatusCode, at: DateTime) -> DataValue {
    DataValue {
        value: if status.is_bad() { Variant::Null } else { value },
        status,
        source_timestamp: Some(at),
        server_timestamp: Some(at),
        ..DataValue::default()
    }
}
