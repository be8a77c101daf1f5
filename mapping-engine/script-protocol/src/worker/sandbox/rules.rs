//! Rules of Landlock.

use std::path::Path;

use landlock::{
    ABI, Access as _, AccessFs, AccessNet, Ruleset, RulesetAttr as _, RulesetCreated,
    RulesetCreatedAttr as _, RulesetError, RulesetStatus, Scope, path_beneath_rules,
};

use crate::Landlock;

/// Folders of the libraries that a program is linked to, and of the loader that starts it.
const LIBRARIES: &[&str] =
    &["/lib", "/lib64", "/usr/lib", "/usr/lib64", "/usr/local/lib", "/etc/ld.so.cache"];
/// Facts of the kernel about the machine and the process itself.
const KERNEL: &[&str] = &["/proc", "/sys", "/dev/null", "/dev/urandom"];

/// Newest rules that are asked for; an older kernel enforces those that it knows.
const NEWEST: ABI = ABI::V6;

/// Denies everything that Landlock knows: with no exception, or with those that a program needs to start.
pub fn enforce(program: Option<&Path>) -> Landlock {
    let enforced = Ruleset::default()
        .handle_access(AccessFs::from_all(NEWEST))
        .and_then(|rules| rules.handle_access(AccessNet::from_all(NEWEST)))
        .and_then(|rules| rules.scope(Scope::from_all(NEWEST)))
        .and_then(Ruleset::create)
        .and_then(|rules| match program {
            Some(program) => except(rules, program),
            None => Ok(rules),
        })
        .and_then(RulesetCreated::restrict_self);
    match enforced.map(|status| status.ruleset) {
        Ok(RulesetStatus::FullyEnforced) => Landlock::Full,
        Ok(RulesetStatus::PartiallyEnforced) => Landlock::Partial,
        Ok(RulesetStatus::NotEnforced) | Err(_) => Landlock::None,
    }
}

/// Allows to read and run a program with its libraries. What is not there is left out.
fn except(rules: RulesetCreated, program: &Path) -> Result<RulesetCreated, RulesetError> {
    let run = AccessFs::from_read(NEWEST);
    rules
        .add_rules(path_beneath_rules([program], run))?
        .add_rules(path_beneath_rules(LIBRARIES, run))?
        .add_rules(path_beneath_rules(KERNEL, AccessFs::ReadFile | AccessFs::ReadDir))
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
            let reported = enforce(None);
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

    #[test]
    fn a_program_that_a_worker_becomes_reads_its_libraries_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a folder");
        let (program, other) = (folder.path().join("program"), folder.path().join("other"));
        for file in [&program, &other] {
            std::fs::write(file, "").expect("written");
        }
        let allowed = program.clone();
        let confined = std::thread::spawn(move || {
            let reported = enforce(Some(&allowed));
            (reported, File::open(&allowed).is_ok(), is_denied(File::open(&other)))
        });
        let (reported, opens_itself, is_closed) = confined.join().expect("it ends");
        assert!(opens_itself, "{reported:?}");
        assert_eq!(is_closed, landlock_of_the_kernel().is_some(), "{reported:?}");
        assert_eq!(is_closed, reported != Landlock::None);
    }
}
