//! Ports for the programs that tests start: free, and drawn by no other test.
//!
//! A program gets its port as an argument before it binds it, and one that was killed binds it
//! again later. In between the port must stay its own: a lock of the file system, held until this
//! process ends, excludes other tests, and a range from which the operating system takes nothing
//! excludes outgoing connections.

use std::{
    env,
    fs::{self, File, TryLockError},
    io,
    net::{Ipv4Addr, TcpListener},
    ops::Range,
};

use parking_lot::Mutex;
use rand::Rng as _;

/// Below those that the operating system gives to outgoing connections (Linux: from 32768).
const PORTS: Range<u16> = 12_000..32_000;
const ATTEMPTS_MAX: usize = 10_000;

/// Given back by the operating system at the end of the process, however it ends.
static RESERVED: Mutex<Vec<File>> = Mutex::new(Vec::new());

/// Reserves `N` different loopback ports until this process ends.
///
/// # Errors
/// When the machine has no free ports left, or the folder for temporary files cannot be written.
pub fn reserve<const N: usize>() -> io::Result<[u16; N]> {
    let mut ports = [0; N];
    for port in &mut ports {
        *port = reserve_one()?;
    }
    Ok(ports)
}

fn reserve_one() -> io::Result<u16> {
    let folder = env::temp_dir().join("verbund-ports");
    fs::create_dir_all(&folder)?;
    let mut random = rand::rng();
    for _ in 0..ATTEMPTS_MAX {
        let port = random.random_range(PORTS);
        let file = File::options().create(true).append(true).open(folder.join(port.to_string()))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => continue,
            Err(TryLockError::Error(problem)) => return Err(problem),
        }
        if TcpListener::bind((Ipv4Addr::LOCALHOST, port)).is_ok() {
            RESERVED.lock().push(file);
            return Ok(port);
        }
    }
    Err(io::ErrorKind::AddrNotAvailable.into())
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn nobody_else_draws_what_is_reserved() {
        let mine: HashSet<u16> = reserve::<200>().expect("free ports").into_iter().collect();
        assert_eq!(mine.len(), 200);
        for port in mine {
            let lock = File::options()
                .append(true)
                .open(env::temp_dir().join("verbund-ports").join(port.to_string()));
            assert!(
                matches!(lock.expect("a file").try_lock(), Err(TryLockError::WouldBlock)),
                "{port}"
            );
            assert!(
                TcpListener::bind((Ipv4Addr::LOCALHOST, port)).is_ok(),
                "{port} is free to be bound"
            );
        }
    }
}
