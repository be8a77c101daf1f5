//! Packages: the parsed Rust sources of one folder with a `Cargo.toml`.

use std::{
    collections::BTreeSet,
    fs, io,
    path::{Path, PathBuf},
};

/// Folders that hold no sources of ours: build output, foreign code, installed packages.
pub(crate) const LEFT_OUT: [&str; 3] = ["target", "vendor", "node_modules"];
/// Marker in the first lines of files that a program writes.
pub(crate) const GENERATED: &str = "@generated";

/// The sources of one package. Packages in folders below it are packages of their own.
pub struct Package {
    pub name: String,
    /// Names of the packages that it is built from, without those of its tests.
    pub dependencies: BTreeSet<String>,
    /// Ordered by path.
    pub files: Vec<SourceFile>,
}

/// One parsed source file.
pub struct SourceFile {
    /// Path for findings: the package's folder as it was given, then the path inside.
    pub path: String,
    /// Path inside the package with `/`, for instance `src/link/cursor.rs`.
    pub inner: String,
    pub text: String,
    pub syntax: syn::File,
    pub role: Role,
}

/// Use of a file by Cargo, from where it lies in the package.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    Library,
    Binary,
    /// Integration tests, and in-file tests with a file of their own.
    Test,
    /// Examples, benchmarks and build scripts.
    Other,
}

/// Failure to read a package.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    #[error("reading {} failed", path.display())]
    Io { path: PathBuf, source: io::Error },
    #[error("{path}:{line}: not understood as Rust: {source}")]
    Syntax { path: String, line: usize, source: syn::Error },
    #[error("{} names no package", .0.display())]
    NoName(PathBuf),
}

impl Package {
    /// Reads and parses the package in `folder`, except generated files.
    ///
    /// # Errors
    /// When a file cannot be read or is no Rust.
    pub fn read(folder: &Path) -> Result<Self, ReadError> {
        Self::read_in(Path::new("."), &folder.to_string_lossy())
    }

    /// Reads the package in a folder of `root`. Paths of findings begin with the folder.
    ///
    /// # Errors
    /// When a file cannot be read or is no Rust.
    pub fn read_in(root: &Path, prefix: &str) -> Result<Self, ReadError> {
        let folder = &root.join(prefix);
        let manifest = folder.join("Cargo.toml");
        let text = read_text(&manifest)?;
        let name = package_name(&text).ok_or(ReadError::NoName(manifest))?;
        let mut sources = Vec::new();
        collect(folder, "", &mut sources)?;
        let dependencies = dependencies(&text);
        Ok(Self { dependencies, ..Self::parse(&name, prefix, sources)? })
    }

    /// Parses sources given as (path inside the package, text).
    ///
    /// # Errors
    /// When a source is no Rust.
    pub fn from_sources(name: &str, sources: &[(&str, &str)]) -> Result<Self, ReadError> {
        let sources =
            sources.iter().map(|(inner, text)| ((*inner).to_owned(), (*text).to_owned())).collect();
        Self::parse(name, "", sources)
    }

    fn parse(
        name: &str,
        prefix: &str,
        mut sources: Vec<(String, String)>,
    ) -> Result<Self, ReadError> {
        sources.sort();
        let mut files = Vec::with_capacity(sources.len());
        for (inner, text) in sources {
            if text.lines().take(5).any(|line| line.contains(GENERATED)) {
                continue;
            }
            let path = if prefix.is_empty() || prefix == "." {
                inner.clone()
            } else {
                format!("{}/{inner}", prefix.trim_start_matches("./").trim_end_matches('/'))
            };
            let syntax = syn::parse_file(&text).map_err(|source| ReadError::Syntax {
                path: path.clone(),
                line: source.span().start().line,
                source,
            })?;
            let role = role_of(&inner);
            files.push(SourceFile { path, inner, text, syntax, role });
        }
        Ok(Self { name: name.to_owned(), dependencies: BTreeSet::new(), files })
    }
}

impl SourceFile {
    /// True for a file that Cargo compiles as the root of a library, program or test.
    #[must_use]
    pub fn is_root(&self) -> bool {
        let (folder, name) = self.inner.rsplit_once('/').unwrap_or(("", &self.inner));
        let folder = folder.rsplit('/').next().unwrap_or_default();
        matches!(name, "lib.rs" | "main.rs" | "build.rs")
            || matches!(folder, "bin" | "benches" | "examples" | "fuzz_targets")
            || self.inner.strip_prefix("tests/").is_some_and(|inner| !inner.contains('/'))
    }
}

fn role_of(inner: &str) -> Role {
    let (first, rest) = inner.split_once('/').unwrap_or((inner, ""));
    match first {
        "src" if inner.ends_with("/tests.rs") || rest.split('/').any(|part| part == "tests") => {
            Role::Test
        }
        "src" if rest == "main.rs" || rest.starts_with("bin/") => Role::Binary,
        "src" => Role::Library,
        "tests" | "it" => Role::Test,
        _ => Role::Other,
    }
}

/// Returns the `name` of the `[package]` table. Reading a whole manifest needs a parser of TOML; a
/// package's name is always a plain line.
fn package_name(manifest: &str) -> Option<String> {
    let (_, package) = manifest.split_once("[package]")?;
    let line = package.lines().find(|line| line.starts_with("name"))?;
    line.split('"').nth(1).map(str::to_owned)
}

/// Returns the names in the tables `[dependencies]`, also of single targets.
fn dependencies(manifest: &str) -> BTreeSet<String> {
    let mut is_dependency = false;
    let mut names = BTreeSet::new();
    for line in manifest.lines() {
        if line.starts_with('[') {
            is_dependency = line.trim_end_matches(']').ends_with("dependencies")
                && !line.contains("dev-")
                && !line.contains("build-");
        } else if is_dependency {
            let name = line.split(['.', '=', ' ']).next().unwrap_or_default();
            if !name.is_empty() && !name.starts_with('#') {
                names.insert(name.to_owned());
            }
        }
    }
    names
}

fn collect(
    folder: &Path,
    inner: &str,
    sources: &mut Vec<(String, String)>,
) -> Result<(), ReadError> {
    let failed = |source| ReadError::Io { path: folder.to_owned(), source };
    for entry in fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let inner = if inner.is_empty() { name.clone() } else { format!("{inner}/{name}") };
        if path.is_dir() {
            let is_foreign = name.starts_with('.') || LEFT_OUT.contains(&name.as_str());
            if !is_foreign && !path.join("Cargo.toml").exists() {
                collect(&path, &inner, sources)?;
            }
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            sources.push((inner, read_text(&path)?));
        }
    }
    Ok(())
}

fn read_text(path: &Path) -> Result<String, ReadError> {
    fs::read_to_string(path).map_err(|source| ReadError::Io { path: path.to_owned(), source })
}
