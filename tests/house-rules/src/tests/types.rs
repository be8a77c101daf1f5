//! Size of types.

use super::{package, texts};
use crate::{Exemption, Rule, check_type_sizes};

#[test]
fn types_have_bounds_but_those_of_the_wire() {
    let fields = |count: usize| (0..count).map(|n| format!("f{n}: u8,")).collect::<String>();
    let methods = (0..41).map(|n| format!("fn m{n}() {{}}")).collect::<String>();
    let source = format!(
        "struct Fits {{ {} }}\nstruct Large {{ {} }}\n#[derive(Debug, serde::Serialize)]\n\
         struct Wire {{ {} }}\nstruct Busy;\nimpl Busy {{ {methods} }}",
        fields(12),
        fields(13),
        fields(13)
    );
    let package = package(&[("src/lib.rs", &source)]);
    let sizes =
        |exemptions: &[Exemption]| texts(check_type_sizes(&package, exemptions), Rule::TypeSize);
    let exempt = |type_name| Exemption { package: "demo", type_name, reason: "a test" };
    assert_eq!(
        sizes(&[]),
        [
            "src/lib.rs:1 `Busy` has 41 methods, at most 40 are allowed",
            "src/lib.rs:2 `Large` has 13 fields, at most 12 are allowed"
        ]
    );
    assert_eq!(
        sizes(&[exempt("Busy"), exempt("Large"), exempt("Wire")]),
        ["src/lib.rs:1 `Wire` needs no exemption"]
    );
}

#[test]
fn only_plain_data_is_of_the_wire() {
    let fields = |count: usize| (0..count).map(|n| format!("f{n}: u8,")).collect::<String>();
    let source = format!(
        "#[derive(Serialize)]\nstruct Changed {{ {many} }}\nimpl Changed {{ fn put(&mut self) {{}} }}\n\
         #[derive(Args)]\nstruct Iterated {{ {many} }}\n\
         impl Iterator for Iterated {{ fn next(&mut self) {{}} }}\n\
         #[derive(Serialize)]\nstruct Shared {{ {many} last: Arc<parking_lot::Mutex<u8>> }}\n\
         #[derive(Serialize)]\nstruct Built {{ {many} }}\n\
         impl Built {{ fn with(mut self) -> Self {{ self }} fn sum(&self) {{}} }}",
        many = fields(13)
    );
    let findings = check_type_sizes(&package(&[("src/lib.rs", &source)]), &[]);
    assert_eq!(
        texts(findings, Rule::TypeSize),
        [
            "src/lib.rs:2 `Changed` has 13 fields, at most 12 are allowed",
            "src/lib.rs:5 `Iterated` has 13 fields, at most 12 are allowed",
            "src/lib.rs:8 `Shared` has 14 fields, at most 12 are allowed"
        ]
    );
}
