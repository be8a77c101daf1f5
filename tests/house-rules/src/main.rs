//! Prints the findings below folders: `cargo run -q -p house-rules -- [FOLDER...]`. Without a folder
//! all packages and texts below the working directory are checked.
#![allow(clippy::print_stdout, clippy::print_stderr)]

use std::{
    fs, io,
    path::{Path, PathBuf},
    process::ExitCode,
};

use house_rules::{DeclaredTypes, Finding, Package};

#[path = "../../it/house/tables.rs"]
mod tables;

fn main() -> ExitCode {
    let folders: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let folders = if folders.is_empty() { vec![PathBuf::from(".")] } else { folders };
    let mut findings = Vec::new();
    for folder in &folders {
        if let Err(error) = check_folder(folder, &mut findings) {
            eprintln!("{}: {error}", folder.display());
            return ExitCode::from(2);
        }
    }
    for finding in &findings {
        println!("{finding}");
    }
    if findings.is_empty() {
        return ExitCode::SUCCESS;
    }
    eprintln!("{} findings", findings.len());
    ExitCode::FAILURE
}

fn check_folder(
    folder: &Path,
    findings: &mut Vec<Finding>,
) -> Result<(), Box<dyn std::error::Error>> {
    let mut types = Vec::new();
    check_below(folder, findings, &mut types)?;
    // Only the whole workspace shows which packages meet.
    if folder.join("Cargo.lock").exists() {
        findings.extend(house_rules::check_type_names(&types, tables::SHARED_NAMES));
    }
    let prefix = folder.to_string_lossy();
    let prefix = prefix.trim_start_matches("./").trim_end_matches('/');
    for mut finding in house_rules::check_texts(folder)? {
        if !matches!(prefix, "" | ".") {
            finding.file = format!("{prefix}/{}", finding.file);
        }
        findings.push(finding);
    }
    Ok(())
}

/// Checks the package in `folder`, when it has a manifest, and those in folders below.
fn check_below(
    folder: &Path,
    findings: &mut Vec<Finding>,
    types: &mut Vec<DeclaredTypes>,
) -> Result<(), Box<dyn std::error::Error>> {
    if is_package(folder)? {
        let package = Package::read(folder)?;
        findings.extend(house_rules::check(&package));
        findings.extend(house_rules::check_walls(&package, &tables::walls()));
        if tables::CONNECTOR.contains(&package.name.as_str()) {
            findings.extend(house_rules::check_type_sizes(&package, tables::LARGE_TYPES));
        }
        if !tables::TEST_PACKAGES.contains(&package.name.as_str()) {
            types.push(DeclaredTypes::of(&package));
        }
    }
    let mut below: Vec<PathBuf> =
        fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>()?;
    below.sort();
    for path in below {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let is_foreign =
            name.starts_with('.') || matches!(&*name, "target" | "vendor" | "node_modules");
        if path.is_dir() && !is_foreign {
            check_below(&path, findings, types)?;
        }
    }
    Ok(())
}

/// True for a manifest of a package, not of a workspace alone.
fn is_package(folder: &Path) -> io::Result<bool> {
    match fs::read_to_string(folder.join("Cargo.toml")) {
        Ok(manifest) => Ok(manifest.contains("[package]")),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}
