//! Filter of system calls.

use seccompiler::{
    BpfMap, BpfProgram, TargetArch, apply_filter_all_threads, compile_from_json, sock_filter,
};

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

/// Calls of V8 beyond these: it asks how its own threads are scheduled, and guards its code by keys of memory.
const OF_V8: &[&str] = &["pkey_mprotect", "sched_getparam", "sched_getscheduler"];

/// False where the kernel has no filters or this processor is not known: the worker then has
/// the other walls.
pub fn install() -> bool {
    program(&[]).is_some_and(|filter| apply_filter_all_threads(&filter).is_ok())
}

/// Returns the filter for a program with V8 that this process becomes; empty where this processor is not known.
pub fn handed_over() -> Vec<u8> {
    program(OF_V8).unwrap_or_default().iter().flat_map(bytes).collect()
}

fn program(more: &[&str]) -> Option<BpfProgram> {
    let arch = TargetArch::try_from(std::env::consts::ARCH).ok()?;
    let rules = rules(std::process::id(), more);
    let filters: Option<BpfMap> = compile_from_json(rules.as_bytes(), arch).ok();
    filters?.remove("worker")
}

/// Returns an instruction as the kernel takes it.
fn bytes(instruction: &sock_filter) -> [u8; 8] {
    let [a, b] = instruction.code.to_ne_bytes();
    let [c, d, e, f] = instruction.k.to_ne_bytes();
    [a, b, instruction.jt, instruction.jf, c, d, e, f]
}

/// Returns the rules for a process, with calls beyond those of every worker. It may signal itself, as `abort` does, and
/// nobody else.
fn rules(process_id: u32, more: &[&str]) -> String {
    let mut names: Vec<String> =
        ALLOWED.iter().chain(more).map(|name| format!("{{\"syscall\":\"{name}\"}}")).collect();
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
            compile_from_json(rules(4711, &[]).as_bytes(), arch).expect("the rules are valid");
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
        for more in [&[] as &[&str], OF_V8] {
            let rules = rules(4711, more);
            let filters: BpfMap =
                compile_from_json(rules.as_bytes(), arch).expect("the rules are valid");
            for (name, call) in ways_out() {
                assert_eq!(decision(&filters["worker"], call, 0), DENY, "{name}");
            }
        }
        // Neither do calls of these families that have no number above.
        const FAMILIES: [&str; 12] = [
            "open", "creat", "link", "socket", "connect", "accept", "send", "recv", "exec", "fork",
            "clone", "ptrace",
        ];
        for name in ALLOWED.iter().chain(OF_V8) {
            let family = FAMILIES.iter().find(|family| name.contains(*family));
            assert_eq!(family, None, "{name} is allowed");
        }
        // A call that is added to the list has to be one of memory, streams, clock or exit.
        let listed = (ALLOWED.len(), OF_V8.len());
        assert_eq!(listed, (32, 3), "think about what the new call lets a script do");
    }

    #[test]
    fn the_filter_of_a_program_is_handed_over_as_the_kernel_takes_it() {
        let instructions: Vec<sock_filter> = handed_over()
            .chunks_exact(8)
            .map(|chunk| sock_filter {
                code: u16::from_ne_bytes([chunk[0], chunk[1]]),
                jt: chunk[2],
                jf: chunk[3],
                k: u32::from_ne_bytes([chunk[4], chunk[5], chunk[6], chunk[7]]),
            })
            .collect();
        let own = u64::from(std::process::id());
        assert_eq!(decision(&instructions, GETPID, 0), ALLOW);
        assert_eq!(decision(&instructions, TGKILL, own), ALLOW);
        assert_eq!(decision(&instructions, TGKILL, own + 1), DENY);
        for (name, call) in ways_out() {
            assert_eq!(decision(&instructions, call, 0), DENY, "{name}");
        }
    }
}
