//! Ports that nobody uses.

use std::net::{Ipv4Addr, TcpListener};

/// Reserves `N` different loopback ports at once and frees them for the programs about to start. Another process may
/// take one in between; that is rare, and the program that then fails to bind says so.
///
/// # Errors
/// When the machine has no free ports left.
pub fn free_ports<const N: usize>() -> std::io::Result<[u16; N]> {
    let listeners: Vec<TcpListener> =
        (0..N).map(|_| TcpListener::bind((Ipv4Addr::LOCALHOST, 0))).collect::<Result<_, _>>()?;
    let mut ports = [0; N];
    for (port, listener) in ports.iter_mut().zip(&listeners) {
        *port = listener.local_addr()?.port();
    }
    Ok(ports)
}
