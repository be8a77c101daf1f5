//! `factory-connector certificate`.

use std::{io::Write, path::PathBuf};

use anyhow::Context as _;
use asi_model::FactoryId;
use clap::Subcommand;
use factory_connector::{config::ConnectorConfig, store::Store};
use twin::{ApplicationCertificate, InstalledCertificate, RequestedSubject, TwinError};

use super::output::print;

/// Author of a change, in the log.
const COMMAND_LINE: &str = "command line";

#[derive(Debug, Subcommand)]
pub(super) enum CertificateCommand {
    /// Show the OPC UA server's own certificate.
    Show,
    /// Print a request for a certificate (PKCS #10), to be given to an authority. The key stays
    /// here.
    Request {
        /// The common name to ask for; authorities may put another one in its place.
        #[arg(long)]
        common_name: Option<String>,
        /// The organisation to ask for.
        #[arg(long)]
        organization: Option<String>,
        /// Make a new key, used from the installation on; without it the request is for the present
        /// key.
        #[arg(long)]
        new_key: bool,
        /// Write the request to this file instead of standard output.
        #[arg(long, short)]
        output: Option<PathBuf>,
    },
    /// Install the certificate that an authority made of the request. A running connector uses it
    /// from the next connection on.
    Install {
        /// The certificate, and those of its authorities up to the root unless the trust list has
        /// them: PEM or DER, in any order.
        #[arg(required = true)]
        files: Vec<PathBuf>,
    },
}

pub(super) async fn run(
    command: CertificateCommand,
    config: &ConnectorConfig,
) -> anyhow::Result<()> {
    let mut session = Store::connect(&config.data_directory).await?;
    let enrolled = session
        .enrolments()
        .current()
        .await?
        .context("this connector is not enrolled yet, so that its OPC UA server has no name: run `enrol` first")?;
    drop(session);
    let own =
        ApplicationCertificate::new(&FactoryId::new(&enrolled.factory_id)?, config.twin_config());
    match command {
        CertificateCommand::Show => show(&own.show()?),
        CertificateCommand::Request { common_name, organization, new_key, output } => {
            let request = own.request(&RequestedSubject {
                common_name,
                organization,
                with_new_key: new_key,
            })?;
            let Some(path) = output else { return print(request.trim_end()) };
            std::fs::write(&path, request)
                .with_context(|| format!("writing {}", path.display()))?;
            print(&format!("The request is in {}. Give it to the authority.", path.display()))
        }
        CertificateCommand::Install { files } => {
            match own.install(&together(&files)?, COMMAND_LINE) {
                Ok(installed) => {
                    print("Installed. A running connector uses it from the next connection on.")?;
                    show(&installed)
                }
                Err(TwinError::Refused { faults }) => {
                    let sentences: Vec<_> = faults.into_iter().map(|fault| fault.message).collect();
                    anyhow::bail!("the certificate cannot be used:\n  {}", sentences.join("\n  "))
                }
                Err(other) => Err(other.into()),
            }
        }
    }
}

/// Joins several files as PEM; a single one is returned as it is.
fn together(files: &[PathBuf]) -> anyhow::Result<Vec<u8>> {
    let mut contents = Vec::new();
    for path in files {
        contents.push(std::fs::read(path).with_context(|| format!("reading {}", path.display()))?);
    }
    if contents.len() == 1 {
        return Ok(contents.swap_remove(0));
    }
    let texts = contents.into_iter().map(|content| match String::from_utf8(content) {
        Ok(text) if text.contains("-----BEGIN") => text,
        Ok(text) => pem(text.as_bytes()),
        Err(binary) => pem(binary.as_bytes()),
    });
    Ok(texts.collect::<Vec<_>>().join("\n").into_bytes())
}

fn pem(der: &[u8]) -> String {
    use base64::{Engine as _, engine::general_purpose::STANDARD};
    format!("-----BEGIN CERTIFICATE-----\n{}\n-----END CERTIFICATE-----\n", STANDARD.encode(der))
}

fn show(certificate: &InstalledCertificate) -> anyhow::Result<()> {
    let mut output = std::io::stdout().lock();
    let by = if certificate.is_self_signed { "itself" } else { certificate.issuer.as_str() };
    writeln!(output, "subject      {}", certificate.subject)?;
    writeln!(output, "issued by    {by}")?;
    writeln!(output, "application  {}", certificate.application_uri.as_deref().unwrap_or("-"))?;
    writeln!(output, "hosts        {}", certificate.host_names.join(", "))?;
    writeln!(output, "valid        {} to {}", certificate.not_before, certificate.not_after)?;
    writeln!(output, "key          RSA {}", certificate.key_bits)?;
    writeln!(output, "fingerprint  {} (SHA-256)", certificate.fingerprint)?;
    writeln!(output, "thumbprint   {} (SHA-1)", certificate.thumbprint)?;
    Ok(())
}
