//! The pages are embedded at compile time; a build without them yields a connector that says so.

fn main() -> std::io::Result<()> {
    let pages = std::path::Path::new("../web/dist/engineer");
    std::fs::create_dir_all(pages)?;
    println!("cargo::rerun-if-changed={}", pages.display());
    Ok(())
}
