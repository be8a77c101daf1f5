//! A copy of a connector's data directory, as a clone of its machine would have it.

use std::path::PathBuf;

use anyhow::Context as _;

use super::{ENGINEER, PASSWORD, World, daemon, ready};
use crate::harness::{Api, Daemon, write_private};

impl World {
    /// Copies a connector's data directory beside it. The connector must not run.
    ///
    /// # Errors
    /// When it cannot be copied.
    pub fn copy_connector(&self, factory_id: &str) -> anyhow::Result<()> {
        let [original, copy] = self.original_and_copy(factory_id);
        let copied =
            std::process::Command::new("cp").arg("-a").args([&original, &copy]).status()?;
        anyhow::ensure!(copied.success(), "copying {} failed", original.display());
        Ok(())
    }

    /// Starts the copy on ports of its own; how it is reached.
    ///
    /// # Errors
    /// When it was not copied or does not start.
    pub fn start_copy(&self, factory_id: &str) -> anyhow::Result<(Daemon, Api)> {
        let folder = &self.places.folder;
        let [original, copy] = self.original_and_copy(factory_id);
        let [web, twin] = free_ports::reserve()?;
        let known = self.places.factory(factory_id)?;
        let text = std::fs::read_to_string(folder.join(format!("connector-{factory_id}.toml")))?
            .replace(&format!("\"{}\"", original.display()), &format!("\"{}\"", copy.display()))
            .replace(&format!("127.0.0.1:{}", known.connector_web), &format!("127.0.0.1:{web}"))
            .replace(&format!("127.0.0.1:{}", known.twin), &format!("127.0.0.1:{twin}"));
        let config = folder.join(format!("connector-{factory_id}-copy.toml"));
        write_private(&config, &text).with_context(|| format!("writing {}", config.display()))?;
        let config = config.display().to_string();
        let name = format!("connector-{factory_id}-copy");
        let running = daemon(&name, "factory-connector", &["run", "--config", &config], folder)?;
        Ok((running, Api::new(format!("http://127.0.0.1:{web}"))?))
    }

    /// Signs in at a copy once it answers.
    ///
    /// # Errors
    /// When it does not become ready.
    pub async fn copy_is_ready(api: &mut Api, copy: &mut Daemon) -> anyhow::Result<()> {
        ready(api, copy).await?;
        api.sign_in(ENGINEER, PASSWORD).await
    }

    fn original_and_copy(&self, factory_id: &str) -> [PathBuf; 2] {
        let name = format!("connector-{factory_id}");
        [self.places.folder.join(&name), self.places.folder.join(format!("{name}-copy"))]
    }
}
