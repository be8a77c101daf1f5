//! The command that starts Deno with the worker's program, and nothing that it could reach.

use std::{fmt::Write as _, path::Path, process::Command};

use script_protocol::{
    PROTOCOL_VERSION, ScriptLimits,
    worker::{Handover, PRELUDE},
};
use serde_json::json;

/// The worker's program: one module, in parts that are read in this order.
const PROGRAM: &str = concat!(
    include_str!("worker/walls.js"),
    include_str!("worker/codec.js"),
    include_str!("worker/values.js"),
    include_str!("worker/faults.js"),
    include_str!("worker/scripts.js"),
    include_str!("worker/watch.js"),
    include_str!("worker/serve.js"),
);
/// Second thread of the program, which ends calls that nothing else ends.
const WATCHDOG: &str = include_str!("worker/watchdog.js");

/// Part of a worker's memory that V8's heap may take; the rest is for code, threads and the contents of buffers.
const HEAP_SHARE: u64 = 8;

/// Returns the command of a worker that runs scripts with these limits.
pub fn worker(deno: &Path, limits: &ScriptLimits, handover: &Handover) -> Command {
    let heap_mib = (limits.address_space_bytes / HEAP_SHARE) >> 20;
    let stack_kib = limits.script_stack_bytes >> 10;
    let mut command = Command::new(deno);
    command
        .arg("run")
        .arg(format!(
            "--v8-flags=--max-old-space-size={heap_mib},--stack-size={stack_kib},\
             --disallow-code-generation-from-strings"
        ))
        // For the last walls, which are calls of the C library; given back before the first script.
        .arg("--allow-ffi")
        .args(["--no-remote", "--no-npm", "--no-config", "--no-lock", "--no-prompt"])
        .args(["--cached-only", "--no-code-cache"])
        .arg(module(PROGRAM))
        .arg(setup(limits, handover))
        // Nothing is kept, and nobody's settings are read.
        .env("DENO_DIR", "/dev/null")
        .env("HOME", "/")
        .env("DENO_NO_UPDATE_CHECK", "1")
        .env("NO_COLOR", "1");
    command
}

/// Returns what the program cannot know by itself, as JSON.
fn setup(limits: &ScriptLimits, handover: &Handover) -> String {
    let filter = handover.filter.iter().fold(String::new(), |mut hex, byte| {
        let _ = write!(hex, "{byte:02x}");
        hex
    });
    json!({
        "version": PROTOCOL_VERSION,
        "landlock": handover.landlock as u8,
        "userId": handover.user_id,
        "hasLimits": handover.has_limits,
        "filter": filter,
        "prelude": PRELUDE,
        "watchdog": module(WATCHDOG),
        // V8 stops no call by itself: what ends it has no interruption before it to wait for, and collecting garbage takes
        // time beside what is computed.
        "overrunMs": limits.call_budget.as_secs_f64() * 1000.0,
        "batchMs": limits.batch_budget.as_secs_f64() * 1000.0,
    })
    .to_string()
}

/// Returns a module's text as an address, so that there is no file to read.
fn module(text: &str) -> String {
    let mut url = String::from("data:application/javascript,");
    for byte in text.bytes() {
        if byte.is_ascii_alphanumeric() {
            url.push(char::from(byte));
        } else {
            let _ = write!(url, "%{byte:02X}");
        }
    }
    url
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use script_protocol::Landlock;

    use super::*;

    #[test]
    fn no_permission_is_given_but_the_one_that_is_given_back() {
        let limits = ScriptLimits {
            script_memory_bytes: 8 << 20,
            script_stack_bytes: 256 << 10,
            call_budget: Duration::from_millis(100),
            overrun_budget: Duration::from_millis(150),
            batch_budget: Duration::from_millis(100),
            address_space_bytes: 4 << 30,
        };
        let handover = Handover {
            landlock: Landlock::Full,
            user_id: 65_534,
            has_limits: true,
            filter: vec![0, 255],
        };
        let command = worker(Path::new("/opt/deno"), &limits, &handover);
        let parameters: Vec<&str> = command.get_args().filter_map(|one| one.to_str()).collect();
        let granted: Vec<&&str> =
            parameters.iter().filter(|one| one.starts_with("--allow") || **one == "-A").collect();
        assert_eq!(granted, [&"--allow-ffi"]);
        assert!(PROGRAM.contains("Deno.permissions.revokeSync({ name: 'ffi' })"));
        assert!(parameters[1].contains("--max-old-space-size=512,--stack-size=256,"));
        for one in ["--no-remote", "--no-npm", "--no-config", "--no-prompt", "--cached-only"] {
            assert!(parameters.contains(&one), "{one}");
        }
        // The kernel takes no longer parameter.
        assert!(parameters.iter().all(|one| one.len() < 128 << 10));
        let setup: serde_json::Value =
            serde_json::from_str(parameters.last().expect("one")).expect("JSON");
        assert_eq!((&setup["filter"], &setup["landlock"]), (&json!("00ff"), &json!(2)));
        assert_eq!(setup["overrunMs"], json!(100.0));
    }

    #[test]
    fn a_module_is_an_address() {
        assert_eq!(module("a = 'ä'\n"), "data:application/javascript,a%20%3D%20%27%C3%A4%27%0A");
    }
}
