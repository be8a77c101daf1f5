//! Removals by commands: what ends is said, and what is in force is in the way, as on the pages.

use anyhow::Context;
use platform::{
    audit::MachineUser,
    clock::Clock,
    config::PlatformConfig,
    leaving,
    store::{AuditOutcome, Leaver, RemovalEffects},
};

use super::{
    administration::open,
    output::{note, print},
};

/// Removes it, or only says what would end and what is in force. `operation` is its id in the
/// description of the API.
pub(super) async fn remove(
    config: &PlatformConfig,
    operation: &'static str,
    leaver: &Leaver,
    is_preview: bool,
) -> anyhow::Result<()> {
    let store = open(config).await?;
    let mut work = store.begin(MachineUser::of_process(), operation).await?;
    let subject = work.removals().subject(leaver).await?;
    let subject = subject.with_context(|| format!("there is no {}", leaver.path()))?;
    let effects = work.removals().preview(leaver).await?;
    for line in lines(&effects) {
        print(&line)?;
    }
    if is_preview {
        return Ok(());
    }
    anyhow::ensure!(
        effects.in_force.is_empty(),
        "{} stays, since something of it is in force",
        leaver.path()
    );
    leaving::leave(&mut work, leaver, &subject, &effects, Clock::system().now()).await?;
    work.commit(subject, AuditOutcome::Done).await?;
    print(&format!("{} is removed.", leaver.path()))?;
    note(
        "A platform that runs cuts its connections when it is started again; the pages do so at once.",
    )
}

/// Returns what a removal ends and what is in its way, each kind on a line.
fn lines(effects: &RemovalEffects) -> Vec<String> {
    let listed = |what: &str, items: &[String]| {
        (!items.is_empty()).then(|| format!("{what}: {}", items.join(", ")))
    };
    let counted = |what: &str, count: u64| (count > 0).then(|| format!("{what}: {count}"));
    [
        listed("in force, to be ended first", &effects.in_force),
        listed("accounts that end", &effects.people),
        counted("sessions that end", effects.sessions),
        counted("credentials of the broker that end", effects.credentials),
        listed("requests whose reports no tool gets any more", &effects.requests),
    ]
    .into_iter()
    .flatten()
    .collect()
}
