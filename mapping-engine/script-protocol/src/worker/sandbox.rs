//! Rights that a worker gives up before it gets the first script.
//!
//! The engine is C and has had memory errors; the process is the wall. It keeps its memory, its two
//! streams and the clock. There is no parent-death signal: it is bound to the *thread* that started
//! the worker, and a host's thread may end before the host; the closed stream ends the worker, and
//! the watchdog ends a call that would keep it from seeing that.

use std::io;

use rustix::process::{DumpableBehavior, Resource, Rlimit, set_dumpable_behavior, setrlimit};

use crate::ScriptLimits;

/// Open files: the three standard streams and the two copies of them.
const FILES_MAX: u64 = 8;

/// Enters the sandbox. True if the kernel filters system calls from here on.
pub(super) fn enter(limits: &ScriptLimits) -> io::Result<bool> {
    let bound = |value| Rlimit { current: Some(value), maximum: Some(value) };
    setrlimit(Resource::As, bound(limits.address_space_bytes))?;
    setrlimit(Resource::Core, bound(0))?;
    setrlimit(Resource::Fsize, bound(0))?;
    setrlimit(Resource::Nofile, bound(FILES_MAX))?;
    setrlimit(Resource::Nproc, bound(0))?;
    #[cfg(target_os = "linux")]
    {
        set_dumpable_behavior(DumpableBehavior::NotDumpable)?;
        rustix::thread::set_no_new_privs(true)?;
        Ok(filter::install())
    }
    #[cfg(not(target_os = "linux"))]
    Ok(false)
}

#[cfg(target_os = "linux")]
mod filter {
    use seccompiler::{BpfMap, TargetArch, apply_filter_all_threads, compile_from_json};

    /// System calls of an engine without I/O: memory, its streams, the clock, its watchdog, and
    /// exit. Anything else fails with EPERM, which libraries that look for a file or a time zone
    /// take for an answer.
    const ALLOWED: &[&str] = &[
        "brk",
        "clock_getres",
        "clock_gettime",
        "clock_nanosleep",
        "close",
        "exit",
        "exit_group",
        "futex",
        "getpid",
        "getrandom",
        "gettid",
        "gettimeofday",
        "madvise",
        "membarrier",
        "mmap",
        "mprotect",
        "mremap",
        "munmap",
        "nanosleep",
        "read",
        "readv",
        "restart_syscall",
        "rseq",
        "rt_sigaction",
        "rt_sigprocmask",
        "rt_sigreturn",
        "sched_getaffinity",
        "sched_yield",
        "set_robust_list",
        "sigaltstack",
        "tgkill",
        "write",
        "writev",
    ];

    /// False where the kernel has no filters or this processor is not known: the worker then has
    /// the other walls.
    pub fn install() -> bool {
        let names: Vec<String> =
            ALLOWED.iter().map(|name| format!("{{\"syscall\":\"{name}\"}}")).collect();
        let rules = format!(
            "{{\"worker\":{{\"mismatch_action\":{{\"errno\":1}},\"match_action\":\"allow\",\"filter\":[{}]}}}}",
            names.join(",")
        );
        let Ok(arch) = TargetArch::try_from(std::env::consts::ARCH) else { return false };
        let filters: Result<BpfMap, _> = compile_from_json(rules.as_bytes(), arch);
        let Ok(filters) = filters else { return false };
        filters.get("worker").is_some_and(|filter| apply_filter_all_threads(filter).is_ok())
    }
}
