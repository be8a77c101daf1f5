//! Rights that a worker gives up before it gets the first script.
//!
//! The engine is C and has had memory errors; the process is the wall. It keeps its memory, its two
//! streams and the clock. There is no parent-death signal: it is bound to the *thread* that started
//! the worker, and a host's thread may end before the host; the closed stream ends the worker, and
//! the watchdog ends a call that would keep it from seeing that.

use std::io;

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
    let landlock = rules::enforce();
    #[cfg(not(target_os = "linux"))]
    let landlock = Landlock::None;
    Confined { landlock }
}

/// Enters the sandbox and returns the walls that hold from here on.
pub(super) fn enter(limits: &ScriptLimits, confined: &Confined) -> io::Result<Sandbox> {
    let bound = |value| Rlimit { current: Some(value), maximum: Some(value) };
    let bounds = [
        (Resource::As, bound(limits.address_space_bytes)),
        (Resource::Core, bound(0)),
        (Resource::Fsize, bound(0)),
        (Resource::Nofile, bound(FILES_MAX)),
        (Resource::Nproc, bound(0)),
    ];
    for (resource, limit) in &bounds {
        setrlimit(*resource, *limit)?;
    }
    let has_limits = bounds.iter().all(|(resource, limit)| getrlimit(*resource) == *limit);
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

#[cfg(target_os = "linux")]
mod rules {
    use landlock::{
        ABI, Access as _, AccessFs, AccessNet, Ruleset, RulesetAttr as _, RulesetStatus, Scope,
    };

    use crate::Landlock;

    /// Newest rules that are asked for; an older kernel enforces those that it knows.
    const NEWEST: ABI = ABI::V6;

    /// Denies everything that Landlock knows, with no exception.
    pub fn enforce() -> Landlock {
        let enforced = Ruleset::default()
            .handle_access(AccessFs::from_all(NEWEST))
            .and_then(|rules| rules.handle_access(AccessNet::from_all(NEWEST)))
            .and_then(|rules| rules.scope(Scope::from_all(NEWEST)))
            .and_then(Ruleset::create)
            .and_then(landlock::RulesetCreated::restrict_self);
        match enforced.map(|status| status.ruleset) {
            Ok(RulesetStatus::FullyEnforced) => Landlock::Full,
            Ok(RulesetStatus::PartiallyEnforced) => Landlock::Partial,
            Ok(RulesetStatus::NotEnforced) | Err(_) => Landlock::None,
        }
    }

    #[cfg(test)]
    mod tests {
        use std::{
            ffi::{c_long, c_uint, c_void},
            fs::File,
            io,
            net::{TcpListener, TcpStream},
            os::{
                linux::net::SocketAddrExt as _,
                unix::net::{SocketAddr, UnixListener, UnixStream},
            },
            ptr,
        };

        use rustix::process::{getppid, test_kill_process};

        use super::*;

        /// Returns the version of Landlock that the kernel has, if any.
        #[allow(unsafe_code)]
        fn landlock_of_the_kernel() -> Option<i32> {
            // The same number on all processors.
            const LANDLOCK_CREATE_RULESET: c_long = 444;
            const LANDLOCK_CREATE_RULESET_VERSION: c_uint = 1;
            unsafe extern "C" {
                fn syscall(number: c_long, ...) -> c_long;
            }
            let nothing: *const c_void = ptr::null();
            // SAFETY: asked for its version, the kernel reads and writes no memory of this process.
            let version = unsafe {
                syscall(LANDLOCK_CREATE_RULESET, nothing, 0_usize, LANDLOCK_CREATE_RULESET_VERSION)
            };
            i32::try_from(version).ok().filter(|version| *version > 0)
        }

        fn is_denied<T>(result: io::Result<T>) -> bool {
            result.is_err_and(|error| error.kind() == io::ErrorKind::PermissionDenied)
        }

        #[test]
        fn what_is_reported_of_landlock_is_what_the_kernel_denies() {
            let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
            let address = listener.local_addr().expect("bound");
            let name = format!("verbund-landlock-{}", std::process::id());
            let socket = SocketAddr::from_abstract_name(name).expect("a name");
            let _listener = UnixListener::bind_addr(&socket).expect("a socket");
            // To the process that started this one, where it is in sight.
            let signal = || match getppid() {
                Some(parent) => test_kill_process(parent).map_err(io::Error::from),
                None => Ok(()),
            };
            let is_free = signal().is_ok() && getppid().is_some();
            let to = socket.clone();
            // Rules hold for the thread that asks for them.
            let confined = std::thread::spawn(move || {
                let reported = enforce();
                let file = is_denied(File::open("/proc/version"));
                let connection = is_denied(TcpStream::connect(address));
                let others = is_denied(UnixStream::connect_addr(&to));
                (reported, file, connection, others, is_denied(signal()))
            });
            let (reported, file, connection, others, signalled) = confined.join().expect("it ends");
            let kernel = landlock_of_the_kernel();
            let expected = match kernel {
                None => Landlock::None,
                Some(version) if ABI::from(version) < NEWEST => Landlock::Partial,
                Some(_) => Landlock::Full,
            };
            assert_eq!(reported, expected, "the kernel has {kernel:?}");
            assert_eq!(file, kernel.is_some(), "{reported:?}");
            let is_full = reported == Landlock::Full;
            assert!(connection || !is_full, "{reported:?}");
            assert!(others || !is_full, "a socket of no file: {reported:?}");
            assert!(signalled || !is_full || !is_free, "a signal to another process: {reported:?}");
            assert!(File::open("/proc/version").is_ok(), "others are as free as before");
            assert!(UnixStream::connect_addr(&socket).is_ok(), "others are as free as before");
        }
    }
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
        "write",
        "writev",
    ];

    /// False where the kernel has no filters or this processor is not known: the worker then has
    /// the other walls.
    pub fn install() -> bool {
        let Ok(arch) = TargetArch::try_from(std::env::consts::ARCH) else { return false };
        let filters: Result<BpfMap, _> =
            compile_from_json(rules(std::process::id()).as_bytes(), arch);
        let Ok(filters) = filters else { return false };
        filters.get("worker").is_some_and(|filter| apply_filter_all_threads(filter).is_ok())
    }

    /// Returns the rules for a process. It may signal itself, as `abort` does, and nobody else.
    pub(super) fn rules(process_id: u32) -> String {
        let mut names: Vec<String> =
            ALLOWED.iter().map(|name| format!("{{\"syscall\":\"{name}\"}}")).collect();
        names.push(format!(
            "{{\"syscall\":\"tgkill\",\"args\":[{{\"index\":0,\"type\":\"dword\",\"op\":\"eq\",\"val\":{process_id}}}]}}"
        ));
        format!(
            "{{\"worker\":{{\"mismatch_action\":{{\"errno\":1}},\"match_action\":\"allow\",\"filter\":[{}]}}}}",
            names.join(",")
        )
    }

    #[cfg(test)]
    mod tests {
        use seccompiler::sock_filter;

        use super::*;

        /// Numbers that the kernel knows the filter's input by.
        const ARCH: u32 = if cfg!(target_arch = "x86_64") { 0xC000_003E } else { 0xC000_00B7 };
        const TGKILL: u32 = if cfg!(target_arch = "x86_64") { 234 } else { 131 };
        const GETPID: u32 = if cfg!(target_arch = "x86_64") { 39 } else { 172 };
        const KILL: u32 = if cfg!(target_arch = "x86_64") { 62 } else { 129 };

        const ALLOW: u32 = 0x7FFF_0000;
        const DENY: u32 = 0x0005_0001;

        /// Runs a filter as the kernel does, on a system call with its first argument.
        fn decision(program: &[sock_filter], call: u32, argument: u64) -> u32 {
            let mut data = [0; 64];
            data[..4].copy_from_slice(&call.to_ne_bytes());
            data[4..8].copy_from_slice(&ARCH.to_ne_bytes());
            data[16..24].copy_from_slice(&argument.to_ne_bytes());
            let (mut accumulator, mut at) = (0, 0);
            loop {
                let sock_filter { code, jt, jf, k } = program[at].clone();
                at += 1;
                let jump = |is_so: bool| usize::from(if is_so { jt } else { jf });
                match code {
                    0x20 => {
                        let place = k as usize;
                        let word = data[place..place + 4].try_into().expect("a word");
                        accumulator = u32::from_ne_bytes(word);
                    }
                    0x05 => at += k as usize,
                    0x15 => at += jump(accumulator == k),
                    0x25 => at += jump(accumulator > k),
                    0x35 => at += jump(accumulator >= k),
                    0x54 => accumulator &= k,
                    0x06 => return k,
                    other => panic!("instruction {other:#x} is not known here"),
                }
            }
        }

        #[test]
        fn a_worker_may_signal_itself_and_nobody_else() {
            let arch = TargetArch::try_from(std::env::consts::ARCH).expect("a known processor");
            let filters: BpfMap =
                compile_from_json(rules(4711).as_bytes(), arch).expect("the rules are valid");
            let filter = &filters["worker"];
            assert_eq!(decision(filter, GETPID, 0), ALLOW);
            assert_eq!(decision(filter, KILL, 4711), DENY);
            assert_eq!(decision(filter, TGKILL, 4711), ALLOW);
            for other in [1, 4710, 4712, u64::from(u32::MAX)] {
                assert_eq!(decision(filter, TGKILL, other), DENY, "{other}");
            }
        }

        /// Numbers of calls by which a script would leave its process, with their names.
        fn ways_out() -> [(&'static str, u32); 14] {
            let is_x86 = cfg!(target_arch = "x86_64");
            let of = |x86, arm| if is_x86 { x86 } else { arm };
            [
                ("openat", of(257, 56)),
                ("openat2", 437),
                ("unlinkat", of(263, 35)),
                ("mkdirat", of(258, 34)),
                ("socket", of(41, 198)),
                ("connect", of(42, 203)),
                ("sendto", of(44, 206)),
                ("execve", of(59, 221)),
                ("execveat", of(322, 281)),
                ("clone", of(56, 220)),
                ("clone3", 435),
                ("ptrace", of(101, 117)),
                ("process_vm_readv", of(310, 270)),
                ("io_uring_setup", 425),
            ]
        }

        #[test]
        fn a_worker_opens_nothing_starts_nothing_and_reaches_nobody() {
            let arch = TargetArch::try_from(std::env::consts::ARCH).expect("a known processor");
            let filters: BpfMap =
                compile_from_json(rules(4711).as_bytes(), arch).expect("the rules are valid");
            for (name, call) in ways_out() {
                assert_eq!(decision(&filters["worker"], call, 0), DENY, "{name}");
            }
            // Neither do calls of these families that have no number above.
            const FAMILIES: [&str; 12] = [
                "open", "creat", "link", "socket", "connect", "accept", "send", "recv", "exec",
                "fork", "clone", "ptrace",
            ];
            for name in ALLOWED {
                let family = FAMILIES.iter().find(|family| name.contains(*family));
                assert_eq!(family, None, "{name} is allowed");
            }
            // A call that is added to the list has to be one of memory, streams, clock or exit.
            assert_eq!(ALLOWED.len(), 32, "think about what the new call lets a script do");
        }
    }
}
