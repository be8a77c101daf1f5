//! Parts of the product that are measured.

/// Part of the product that is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Subject {
    /// Reports as text, encoded and decoded.
    Reports,
    /// The whole path: from the machine to the buyer's page.
    Path,
    /// The OPC UA server alone, and beside one written with node-opcua.
    Twin,
    /// Mappings of one connector alone, and beside the same job done with node-opcua.
    Mappings,
    /// Gate, ledger and spool, and beside bare SQLite.
    Ledger,
    /// The link to each kind of broker, and beside bare clients.
    Links,
}
