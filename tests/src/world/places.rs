//! Folder and ports of a world.

use std::{net::TcpListener, path::PathBuf};

use anyhow::Context as _;
use serde::{Deserialize, Serialize};

use crate::{
    course::Course,
    frame_order::{HAMBURG, MUNICH},
};

/// Folder and ports of one world, stored in the folder for further starts.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Places {
    /// Configuration, data and logs.
    #[serde(skip)]
    pub folder: PathBuf,
    /// The platform's pages and API.
    pub platform_web: u16,
    /// Its broker, with TLS.
    pub broker_tls: u16,
    /// Its broker without TLS, loopback only.
    pub broker_plain: u16,
    /// Port at which connectors find the broker when a proxy stands in between.
    #[serde(default)]
    pub broker_detour: Option<u16>,
    /// Its broker in WebSockets, with TLS, where a world has that.
    #[serde(default)]
    pub broker_websocket: Option<u16>,
    /// Counters of Munich and of Hamburg, which change at a steady rate, where a world has them.
    #[serde(default)]
    pub counters: Option<[u16; 2]>,
    /// Orders that the machines work off from this start on, where a world has them; else they produce without end.
    #[serde(skip)]
    pub course: Option<Course>,
    pub munich: FactoryPlaces,
    pub hamburg: FactoryPlaces,
}

/// The ports of one factory.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct FactoryPlaces {
    /// The connector's pages and API.
    pub connector_web: u16,
    pub twin: u16,
    /// The machines' control interface.
    pub machines_control: u16,
    /// The machines' OPC UA servers.
    pub machines: [u16; 3],
}

const FILE: &str = "ports.json";

impl Places {
    /// The places of an earlier start in this folder; for the first start well-known ports where
    /// they are free.
    ///
    /// # Errors
    /// When the folder cannot be made or its notes cannot be read.
    pub fn in_folder(folder: PathBuf) -> anyhow::Result<Self> {
        std::fs::create_dir_all(&folder)
            .with_context(|| format!("making the folder {}", folder.display()))?;
        let folder = folder.canonicalize()?;
        let file = folder.join(FILE);
        let mut places: Self = match std::fs::read(&file) {
            Ok(notes) => serde_json::from_slice(&notes)
                .with_context(|| format!("reading {}", file.display()))?,
            Err(_) => {
                let places = Self { folder: folder.clone(), ..Self::well_known()? };
                places.note()?;
                places
            }
        };
        places.folder = folder;
        Ok(places)
    }

    /// Notes the ports in the folder, for further starts.
    ///
    /// # Errors
    /// When they cannot be written.
    pub fn note(&self) -> anyhow::Result<()> {
        let file = self.folder.join(FILE);
        std::fs::write(&file, serde_json::to_vec_pretty(self)?)
            .with_context(|| format!("writing {}", file.display()))
    }

    fn well_known() -> anyhow::Result<Self> {
        let ports: [u16; 15] = [
            8080, 5671, 5672, 8091, 4841, 8191, 4851, 4852, 4853, 8092, 4842, 8192, 4861, 4862,
            4863,
        ];
        let all_free = ports
            .iter()
            .map(|&p| TcpListener::bind(("127.0.0.1", p)))
            .collect::<Result<Vec<_>, _>>();
        Ok(Self::from_ports(if all_free.is_ok() { ports } else { free_ports::reserve()? }))
    }

    /// Places in a folder with ports that nobody uses.
    ///
    /// # Errors
    /// When there are no free ports.
    pub fn anywhere(folder: PathBuf) -> anyhow::Result<Self> {
        Ok(Self { folder: folder.canonicalize()?, ..Self::from_ports(free_ports::reserve()?) })
    }

    fn from_ports(ports: [u16; 15]) -> Self {
        let factory = |p: &[u16]| FactoryPlaces {
            connector_web: p[0],
            twin: p[1],
            machines_control: p[2],
            machines: [p[3], p[4], p[5]],
        };
        Self {
            folder: PathBuf::new(),
            platform_web: ports[0],
            broker_tls: ports[1],
            broker_plain: ports[2],
            broker_detour: None,
            broker_websocket: None,
            counters: None,
            course: None,
            munich: factory(&ports[3..9]),
            hamburg: factory(&ports[9..15]),
        }
    }

    /// Returns the ports of a factory.
    ///
    /// # Errors
    /// When there is no such factory.
    pub fn factory(&self, factory_id: &str) -> anyhow::Result<&FactoryPlaces> {
        match factory_id {
            MUNICH => Ok(&self.munich),
            HAMBURG => Ok(&self.hamburg),
            other => anyhow::bail!("there is no factory {other}"),
        }
    }
}
