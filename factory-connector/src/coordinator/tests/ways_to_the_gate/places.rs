//! Places in the sources at which a value may get to a gate, or past it.

use std::path::Path;

/// Texts in sources that stand for a way of a value to a gate, for a gate, or for what is neither a
/// gate's nor its own. Whatever leaves is of a type that a gate alone makes (`disclosure::Released`,
/// whose documentation is tested for what does not compile); so all that remains to be counted is
/// who has a gate, and what a gate believes: its stored state.
const PLACES: [(&str, &[&str]); 17] = [
    // Written values come one by one.
    ("receive_candidate(", &["state/src/use_cases/values.rs 2"]),
    // Mappings bring candidates to the coordinator, which reads its channel in a function of
    // the same name; operators' entries and what was kept for a request use the same function.
    (
        "receive_candidates(",
        &[
            "src/coordinator.rs 2",
            "src/coordinator/candidates.rs 1",
            "state/src/use_cases/enter.rs 1",
            "state/src/use_cases/validity.rs 1",
            "state/src/use_cases/values.rs 2",
        ],
    ),
    (
        "write_value(",
        &[
            "src/coordinator/handle.rs 2",
            "src/twin_adapter.rs 1",
            "state/src/use_cases/values.rs 1",
        ],
    ),
    // The gate of a preview, and the one way in.
    // Beside offered values, those of a failed transaction which their own state withholds. Bodies of requests are judged
    // as a preview judges them, and nothing of them is kept.
    (
        "gate.on(",
        &["src/api/bodies.rs 1", "src/api/preview.rs 1", "state/src/use_cases/values.rs 2"],
    ),
    // Those of the fields, and the drafts of a preview, whose values are not released ones.
    (
        "Gate::new(",
        &[
            "disclosure/src/draft_gate.rs 1",
            "state/src/fields/field.rs 2",
            "state/src/queries/disclosed.rs 1",
        ],
    ),
    // Read from the store.
    ("gate_from_json(", &["disclosure/src/gate/document.rs 1", "state/src/load.rs 1"]),
    // Released by a gate, read from the store, and coarsened by another policy.
    (
        "Released::by_gate",
        &[
            "disclosure/src/gate.rs 2",
            "disclosure/src/gate/document.rs 1",
            "disclosure/src/gate/gate_state.rs 1",
            "disclosure/src/gate/transition.rs 1",
        ],
    ),
    // The message of a preview, which cannot be queued.
    ("draft_report(", &["disclosure/src/report_frame.rs 2", "state/src/queries/report_frame.rs 1"]),
    ("draft_frame(", &["src/api/preview.rs 1", "state/src/queries/report_frame.rs 1"]),
    // Messages of the contract and descriptions of data sets; no other body is queued.
    ("queue_control(", &["state/src/state.rs 2", "state/src/transaction/refresh.rs 1"]),
    (
        "ControlBody::of",
        &[
            "state/src/control_body.rs 1",
            "state/src/state.rs 1",
            "state/src/transaction/refresh.rs 1",
        ],
    ),
    ("KeepAliveBody::of(", &["state/src/use_cases/keep_alive.rs 1"]),
    // Values of machines and of drafts, shown to engineers.
    (
        "ShownValue::before_gate(",
        &[
            "src/api/preview.rs 3",
            "src/api/sources.rs 1",
            "src/api/suggestions.rs 1",
            "src/api/values.rs 2",
        ],
    ),
    // Never replaced: intervals and rates go on, also for another type.
    (".gate =", &[]),
    (".change_type(", &["state/src/fields/field_mut.rs 1"]),
    (".change_policy(", &["state/src/use_cases/decide.rs 1", "state/src/use_cases/policies.rs 1"]),
    (
        "through_gate(",
        &[
            "state/src/dependencies.rs 4",
            "state/src/gates.rs 1",
            "state/src/use_cases/decide.rs 1",
            "state/src/use_cases/policies.rs 1",
            "state/src/use_cases/values.rs 4",
        ],
    ),
];

/// Texts that make a gate or what only a gate makes. Outside of the packages of [`PLACES`] they have no place.
const MAKERS: [&str; 5] =
    ["Gate::new(", "gate_from_json(", "Released::by_gate", ".change_policy(", "Gate as "];

/// The listed ways alone bring values to a gate, and nothing but the gate decides what is
/// disclosed.
#[test]
fn there_is_no_way_around_the_gate() {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let of = |folder: &'static str| {
        let named = move |(name, text)| (format!("{folder}/{name}"), text);
        sources(&package.join(folder)).into_iter().map(named)
    };
    let texts: Vec<(String, String)> =
        ["src", "state/src", "disclosure/src"].into_iter().flat_map(of).collect();
    // Under another name it would be found nowhere below.
    for other_name in ["Gate as ", "= Gate;", "= disclosure::Gate;", "<Gate>", "<disclosure::Gate>"]
    {
        let is_named = |(_, text): &&(String, String)| text.contains(other_name);
        let found = texts.iter().find(is_named).map(|(name, _)| name);
        assert_eq!(found, None, "a gate has its own name everywhere, not `{other_name}`");
    }
    for (name, text) in ["twin/src", "ledger/src"].into_iter().flat_map(of) {
        let maker = MAKERS.iter().find(|maker| text.contains(**maker));
        assert_eq!(maker, None, "{name} makes no gate and nothing that only a gate makes");
    }
    for (pattern, places) in PLACES {
        let count = |(name, text): &(String, String)| {
            let count = text.matches(pattern).count();
            (count > 0).then(|| format!("{name} {count}"))
        };
        let mut found: Vec<String> = texts.iter().filter_map(count).collect();
        found.sort();
        assert_eq!(found, places, "places that contain `{pattern}`");
    }
}

/// Returns the sources below a folder without their tests.
fn sources(folder: &Path) -> Vec<(String, String)> {
    let (mut folders, mut sources) = (vec![folder.to_owned()], Vec::new());
    while let Some(below) = folders.pop() {
        for entry in std::fs::read_dir(below).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let name = path.strip_prefix(folder).expect("below it").to_string_lossy();
            let name = name.replace('\\', "/");
            if name.split('/').any(|part| ["tests", "tests.rs"].contains(&part))
                || name == "scene.rs"
            {
                continue;
            }
            let text = std::fs::read_to_string(&path).expect("a source");
            let mut parts = text.splitn(2, "#[cfg(test)]\nmod tests {\n");
            let code = parts.next().unwrap_or_default();
            let mut below =
                parts.next().unwrap_or_default().lines().skip_while(|line| *line != "}");
            assert_eq!(below.nth(1), None, "{name}: tests stand at the end of a file");
            sources.push((name, code.to_owned()));
        }
    }
    sources
}
