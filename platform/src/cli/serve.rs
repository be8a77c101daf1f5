//! Running the platform, or its broker alone.

use std::time::Duration;

use anyhow::Context;
use daemon::{lifecycle::Lifecycle, telemetry};
use platform::{clock::Clock, config::PlatformConfig, service::Platform};

/// Time for all tasks together to finish after the first signal.
const DRAIN_TIMEOUT: Duration = Duration::from_secs(15);

/// Serves until a signal.
pub async fn serve(config: PlatformConfig) -> anyhow::Result<()> {
    telemetry::install_logs(&config.log)?;
    daemon::descriptors::raise_limit();
    let lifecycle = Lifecycle::new();
    let program = std::env::current_exe().context("finding the platform's own program")?;
    let (platform, handle) = Platform::open(config, Clock::system(), &lifecycle, &program).await?;
    platform.start(&lifecycle);
    tracing::info!(
        web.url = handle.application.enrolment_address.public_url, web.address = %handle.web_address,
        broker.url = handle.application.broker_endpoint.url, "The platform is up."
    );
    lifecycle.run(DRAIN_TIMEOUT).await?;
    handle.application.store.close().await;
    tracing::info!("The platform has stopped.");
    Ok(())
}

/// Runs the embedded broker alone until a signal; users and queues are those of the platform's
/// database.
pub async fn broker(config: PlatformConfig) -> anyhow::Result<()> {
    telemetry::install_logs(&config.log)?;
    daemon::descriptors::raise_limit();
    let lifecycle = Lifecycle::new();
    let addresses =
        platform::service::start_broker_alone(&config, &Clock::system(), &lifecycle).await?;
    tracing::info!(?addresses, "The broker is up.");
    Ok(lifecycle.run(DRAIN_TIMEOUT).await?)
}
