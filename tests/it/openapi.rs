//! The descriptions of both APIs, validated by a validator that is not ours.

use std::time::Duration;

use tokio::process::Command;
use verbund_tests::harness::{python, repository};

/// Time for reading and validating both documents.
const VALIDATION_TIMEOUT: Duration = Duration::from_secs(120);

#[tokio::test]
async fn both_descriptions_are_valid_openapi() {
    let root = repository().unwrap();
    let installed = Command::new(root.join("tests/foreign/setup.sh")).status().await.unwrap();
    assert!(installed.success(), "tests/foreign/setup.sh failed");
    let documents = ["factory-connector", "platform"]
        .map(|daemon| root.join(daemon).join("openapi.json").display().to_string());
    let arguments = documents.each_ref().map(String::as_str);
    let (lines, is_success) =
        python("openapi/validate.py", &arguments, VALIDATION_TIMEOUT).await.unwrap();
    assert!(is_success, "the validator ended with an error");
    assert_eq!(lines.len(), documents.len(), "one line per document: {lines:#?}");
    let errors: Vec<String> = lines
        .iter()
        .flat_map(|line| line["errors"].as_array().expect("errors"))
        .map(|error| error.as_str().expect("a text").to_owned())
        .collect();
    assert!(errors.is_empty(), "{} errors:\n{}", errors.len(), errors.join("\n"));
}
