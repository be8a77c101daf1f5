//! Documents of people and partners as the connector reads them, for the fuzz target and for the test that
//! replays its corpus.

use std::sync::Arc;

use asi_model::{BuiltInType, DataValue, DateTime};
use disclosure::{DisclosurePolicy, Gate, GateState, NamedPolicy, Rule, gate_from_json};
use ledger::{LedgerEntry, RevocationReceipt};
use mapping::{
    Mapping,
    exchange::{MappingFile, MappingTemplate, read_table, write_table},
    transform::{Transform, compile},
};
use transparency_log::{Checkpoint, SignedNote};

/// Reads bytes as a document. The first one says of which kind.
pub fn document(bytes: &[u8]) {
    let Some((kind, rest)) = bytes.split_first() else { return };
    let Ok(text) = std::str::from_utf8(rest) else { return };
    match kind % 9 {
        0 => policy(text),
        1 => drop(serde_json::from_str::<Rule>(text).map(|rule| rule.faults())),
        2 => mapping(text),
        3 => drop(MappingFile::read(text)),
        4 => {
            // What was read is written so that it is read again.
            if let Ok(mappings) = read_table(text) {
                let written = write_table(&mappings);
                assert_eq!(read_table(&written).as_ref(), Ok(&mappings), "{written}");
            }
        }
        5 => drop(SignedNote::parse(text).map(|note| note.text().parse::<Checkpoint>())),
        6 => drop(gate_from_json(text)),
        7 => drop(serde_json::from_str::<LedgerEntry>(text)),
        _ => {
            drop(serde_json::from_str::<MappingTemplate>(text));
            drop(serde_json::from_str::<RevocationReceipt>(text));
        }
    }
}

fn policy(text: &str) {
    let policy: DisclosurePolicy = match serde_json::from_str::<NamedPolicy>(text) {
        Ok(named) => named.disclosure,
        Err(_) => match serde_json::from_str(text) {
            Ok(policy) => policy,
            Err(_) => return,
        },
    };
    for field_type in BuiltInType::ALL {
        for is_array in [false, true] {
            drop(policy.faults(field_type, is_array));
            // Only a policy without faults may get into a gate.
            let fitted = policy.fitted_to(field_type, is_array);
            if !fitted.faults(field_type, is_array).is_empty() {
                continue;
            }
            assert!(fitted.allows_all_of(&fitted), "{fitted:?}");
            drop(fitted.strictest(&policy));
            let mut gate = Gate::new(Arc::new(fitted), field_type, GateState::default(), at(0));
            for second in 1..4 {
                gate.on(at(second), DataValue::good(i64::from(second) * 1_000, at(second)));
                gate.on_time(gate.due().unwrap_or(at(second)).min(at(second + 1)));
            }
        }
    }
}

fn mapping(text: &str) {
    let Ok(mapping) = serde_json::from_str::<Mapping>(text) else { return };
    let inputs = mapping.inputs.len();
    let (plan, _) = compile(&Arc::new(mapping));
    let Some(plan) = plan else { return };
    let mut transform = Transform::new(Arc::new(plan), None, None);
    drop(transform.start(at(0), None));
    for (second, input) in (1..).zip((0..inputs).cycle()).take(8) {
        let value = DataValue::good(f64::from(second) * 1.5, at(second));
        drop(transform.on(at(second), input, value, None));
        drop(transform.on_timer(at(second), None));
    }
}

fn at(second: i32) -> DateTime {
    DateTime::from_unix_micros(1_799_625_600_000_000 + i64::from(second) * 1_000_000)
}
