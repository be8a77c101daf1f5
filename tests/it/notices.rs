//! Both programs print what others wrote of them.

use std::{collections::BTreeSet, process::Command};

use verbund_tests::harness::binary;

#[test]
fn both_daemons_print_what_others_wrote_without_a_configuration() {
    for program in ["platform", "factory-connector"] {
        let out = Command::new(binary(program).unwrap()).arg("notices").output().unwrap();
        let text = String::from_utf8(out.stdout).unwrap();
        assert!(out.status.success(), "{program}");
        let packages: BTreeSet<&str> = text
            .lines()
            .filter(|line| line.contains("; text "))
            .filter_map(|line| line.split(' ').next())
            .collect();
        for package in ["tokio", "rustls", "async-opcua-server", "svelte", "std"] {
            assert!(packages.contains(package), "{program} does not name {package}");
        }
        assert!(text.contains("Mozilla Public License"), "{program} has no texts");
    }
}
