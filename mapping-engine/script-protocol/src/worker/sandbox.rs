//! Rights that a worker gives up before it gets the first script.
//!
//! The engine is C and has had memory errors; the process is the wall. It keeps its memory, its two
//! streams and the clock. There is no parent-death signal: it is bound to the *thread* that started
//! the worker, and a host's thread may end before the host; the closed stream ends the worker, and
//! the watchdog ends a call that would keep it from seeing that.

#[cfg(target_os = "linux")]
mod filter;
#[cfg(target_os = "linux")]
mod rules;

use std::{io, path::Path};

use rustix::process::{
    DumpableBehavior, Resource, Rlimit, getrlimit, getuid, set_dumpable_behavior, setrlimit,
};

use crate::{Landlock, Sandbox, ScriptLimits};

/// Open files: the three standard streams and the two copies of them.
const FILES_MAX: u64 = 8;

/// First step into the sandbox, made by [`confine`].
#[derive(Debug)]
pub struct Confined {
    landlock: Landlock,
}

/// Gives up all access to files, network and other processes' names, as far as the kernel has Landlock.
/// Called before anything starts a thread: threads inherit it, and those that run already would not.
#[must_use]
pub fn confine() -> Confined {
    #[cfg(target_os = "linux")]
    let landlock = rules::enforce(None);
    #[cfg(not(target_os = "linux"))]
    let landlock = Landlock::None;
    Confined { landlock }
}

/// Enters the sandbox and returns the walls that hold from here on.
pub(super) fn enter(limits: &ScriptLimits, confined: &Confined) -> io::Result<Sandbox> {
    let has_limits = bounded(&[
        (Resource::As, limits.address_space_bytes),
        (Resource::Core, 0),
        (Resource::Fsize, 0),
        (Resource::Nofile, FILES_MAX),
        (Resource::Nproc, 0),
    ])?;
    let user_id = getuid().as_raw();
    #[cfg(target_os = "linux")]
    let is_filtered = {
        set_dumpable_behavior(DumpableBehavior::NotDumpable)?;
        rustix::thread::set_no_new_privs(true)?;
        filter::install()
    };
    #[cfg(not(target_os = "linux"))]
    let is_filtered = false;
    Ok(Sandbox { is_filtered, landlock: confined.landlock, user_id, has_limits })
}

/// Walls around a program that the worker becomes, up to those that it has to enter by itself.
#[derive(Debug)]
pub struct Handover {
    /// Rules that hold already.
    pub landlock: Landlock,
    /// User that the program runs as.
    pub user_id: u32,
    /// True where the bounds that are set already read back as they were set.
    pub has_limits: bool,
    /// Filter that the program installs once its threads run: instructions of eight bytes, as the kernel takes them.
    /// Empty where there is none.
    pub filter: Vec<u8>,
}

/// Gives up what a program does not need to start: it reads itself, its libraries and what the kernel says of this
/// machine, and starts threads. Its own bounds on files and processes, and the filter, are its last step. `program` is the
/// executable.
///
/// # Errors
/// Those of the bounds.
pub fn hand_over(program: &Path, limits: &ScriptLimits) -> io::Result<Handover> {
    // An engine reserves address space that it never uses: what it may write to is bounded.
    let bounds =
        [(Resource::Data, limits.address_space_bytes), (Resource::Core, 0), (Resource::Fsize, 0)];
    let has_limits = bounded(&bounds)?;
    #[cfg(target_os = "linux")]
    let (landlock, filter) = {
        rustix::thread::set_no_new_privs(true)?;
        (rules::enforce(Some(program)), filter::handed_over())
    };
    #[cfg(not(target_os = "linux"))]
    let (landlock, filter) = {
        let _ = program;
        (Landlock::None, Vec::new())
    };
    Ok(Handover { landlock, user_id: getuid().as_raw(), has_limits, filter })
}

/// Sets bounds that nothing raises again, and returns whether they read back as they were set.
fn bounded(bounds: &[(Resource, u64)]) -> io::Result<bool> {
    let bound = |value| Rlimit { current: Some(value), maximum: Some(value) };
    for (resource, value) in bounds {
        setrlimit(*resource, bound(*value))?;
    }
    Ok(bounds.iter().all(|(resource, value)| getrlimit(*resource) == bound(*value)))
}
