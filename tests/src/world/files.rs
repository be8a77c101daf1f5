//! The configuration files of a world: written once, then the user's to change; but machines that work off orders are
//! given those of each start.

use std::path::Path;

use anyhow::Context as _;

use super::{
    ExternalBroker, Places,
    accounts::{ADMIN, ENGINEER, OBSERVER, OBSERVER_PASSWORD, PASSWORD},
    counters,
};
use crate::{
    course::{Pace, Timing},
    frame_order::{BUYER, HAMBURG, MUNICH},
    harness::{make_private, write_private},
};

/// Writes what is not there yet.
pub(super) fn write_all(places: &Places, external: Option<&ExternalBroker>) -> anyhow::Result<()> {
    if let Some(external) = external {
        external.write_passwords(&places.folder)?;
    }
    write_once(&places.folder.join("platform.toml"), &platform(places, external))?;
    for factory_id in [MUNICH, HAMBURG] {
        write_once(
            &places.folder.join(format!("connector-{factory_id}.toml")),
            &connector(places, factory_id)?,
        )?;
        let (file, text) = (
            places.folder.join(format!("machines-{factory_id}.toml")),
            machines(places, factory_id)?,
        );
        if places.course.is_some() {
            // Orders begin with each start.
            write_private(&file, &text).with_context(|| format!("writing {}", file.display()))?;
        } else {
            write_once(&file, &text)?;
        }
    }
    Ok(())
}

fn write_once(file: &Path, text: &str) -> anyhow::Result<()> {
    if file.exists() {
        // A former version wrote it for everybody.
        return make_private(file).with_context(|| format!("protecting {}", file.display()));
    }
    write_private(file, text).with_context(|| format!("writing {}", file.display()))
}

/// The embedded broker, with a user of other programs.
fn own_broker(places: &Places) -> String {
    let Places { broker_tls, broker_plain, broker_detour, broker_websocket, .. } = places;
    let websocket = broker_websocket
        .map(|port| format!("websocket_listen = \"127.0.0.1:{port}\"\n"))
        .unwrap_or_default();
    let detour = broker_detour
        .map(|port| format!("public_url = \"amqps://127.0.0.1:{port}\"\n"))
        .unwrap_or_default();
    format!(
        r#"[broker]
listen = "127.0.0.1:{broker_tls}"
plain_listen = "127.0.0.1:{broker_plain}"
{websocket}{detour}
[[broker.users]]
user_name = "{OBSERVER}"
password = "{OBSERVER_PASSWORD}"
consume = ["factory.*.ingress", "dead-letters", "tool.*.reports"]
produce = ["factory.*.requests", "factory.*.leases", "tool.*.requests"]
"#
    )
}

fn platform(places: &Places, external: Option<&ExternalBroker>) -> String {
    let Places { platform_web, broker_detour, folder, .. } = places;
    let broker = external.map_or_else(
        || own_broker(places),
        |external| external.configuration(folder, *broker_detour),
    );
    format!(
        r#"data_directory = "{folder}/platform"

[web]
listen = "127.0.0.1:{platform_web}"

{broker}
[admin]
user_name = "{ADMIN}"
password = "{PASSWORD}"
organisation_id = "{BUYER}"

[receipts]
interval_ms = 1000
"#,
        folder = folder.display()
    )
}

fn connector(places: &Places, factory_id: &str) -> anyhow::Result<String> {
    let factory = places.factory(factory_id)?;
    Ok(format!(
        r#"data_directory = "{folder}/connector-{factory_id}"

[web]
listen = "127.0.0.1:{web}"
# Passkeys need a domain.
public_url = "http://localhost:{web}"

[twin]
listen = "127.0.0.1:{twin}"

# The demo's OPC UA clients come and go; a real factory approves each client's certificate on the connector's page.
[twin.security]
trust_unknown_certificates = true

# Where a broker loses its store, what waits for a receipt is asked for after this time; a run need not wait a minute.
[spool]
resend_after_s = 10

[admin]
user_name = "{ENGINEER}"
password = "{PASSWORD}"
{scripts}"#,
        folder = places.folder.display(),
        web = factory.connector_web,
        twin = factory.twin,
        scripts = if has_one_user() { "\n[mapping.script]\nuserId = 0\n" } else { "" },
    ))
}

/// Returns true in a namespace of users that has one alone: its root is an ordinary user of the machine, and there is
/// no other user who could run scripts.
fn has_one_user() -> bool {
    let map = std::fs::read_to_string("/proc/self/uid_map").unwrap_or_default();
    let sizes = map.lines().filter_map(|line| line.split_whitespace().nth(2)?.parse::<u32>().ok());
    sizes.sum::<u32>() == 1
}

fn machines(places: &Places, factory_id: &str) -> anyhow::Result<String> {
    let factory = places.factory(factory_id)?;
    let [first, second, third] = factory.machines;
    let rhythm = |timing: fn(&Pace) -> Timing, fails: bool, otherwise: &str| match &places.course {
        Some(course) => course.configuration(timing(course.pace), fails),
        None => otherwise.to_owned(),
    };
    let (seed, mut machines) = if factory_id == MUNICH {
        let made = rhythm(|pace| pace.make, true, "cycle_seconds = 5.0");
        let shipped = rhythm(|pace| pace.ship, false, "cycle_seconds = 7.0");
        let machines = vec![
            format!("name = \"MillingCell1\"\nkind = \"milling-cell\"\nport = {first}\n{made}"),
            format!("name = \"Conveyor1\"\nkind = \"conveyor\"\nport = {second}\n{shipped}"),
            format!(
                "name = \"Robot1\"\nkind = \"robot\"\nport = {third}\nasset_id = \"GRU_Robot_eDO_1\""
            ),
        ];
        (4711, machines)
    } else {
        let inspected = rhythm(|pace| pace.inspect, false, "cycle_seconds = 9.0");
        let assembled = rhythm(|pace| pace.assemble, false, "");
        let machines = vec![
            format!("name = \"Press1\"\nkind = \"press\"\nport = {first}\n{inspected}"),
            format!("name = \"Conveyor2\"\nkind = \"conveyor\"\nport = {second}\n{assembled}"),
            format!(
                "name = \"Robot2\"\nkind = \"robot\"\nport = {third}\nasset_id = \"HAM_Robot_1\""
            ),
        ];
        (4712, machines)
    };
    if let Some([munich, hamburg]) = places.counters {
        let port = if factory_id == MUNICH { munich } else { hamburg };
        machines.push(counters::configuration(port));
    }
    let epoch = match &places.course {
        Some(course) => course.epoch(),
        None => time::OffsetDateTime::now_utc().replace_nanosecond(0)?,
    };
    let epoch = epoch.format(&time::format_description::well_known::Rfc3339)?;
    Ok(format!(
        "seed = {seed}\nepoch = \"{epoch}\"\nhost = \"127.0.0.1\"\ncontrol = \"127.0.0.1:{control}\"\n\
         pki_directory = \"{folder}/machines-{factory_id}\"\nupdate_interval_ms = 20\n\n[[machines]]\n{machines}\n",
        control = factory.machines_control,
        folder = places.folder.display(),
        machines = machines.join("\n\n[[machines]]\n"),
    ))
}
