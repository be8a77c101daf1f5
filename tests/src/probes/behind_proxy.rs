//! A platform of its own behind a proxy that speaks TLS: its cookies, and guesses that come through the proxy or pretend
//! to.

use std::{
    net::Ipv4Addr,
    path::{Path, PathBuf},
    time::Duration,
};

use futures::{StreamExt as _, stream};
use reqwest::{StatusCode, header::SET_COOKIE};
use serde_json::json;

use super::http::client_from;
use crate::{
    frame_order::BUYER,
    harness::{Daemon, DaemonCommand, binary, eventually, write_private},
    world::{ADMIN, PASSWORD},
};

/// Address of the proxy, and one that is no proxy.
const PROXY: Ipv4Addr = Ipv4Addr::new(127, 4, 0, 1);
const NO_PROXY: Ipv4Addr = Ipv4Addr::new(127, 4, 0, 2);
/// Header in which a proxy names its client.
const CLIENT: &str = "x-forwarded-for";
/// Guesses from one place, and the most of them that may be checked.
const GUESSES: usize = 90;
const CHECKED_MAX: usize = 60;
/// Guesses that are on their way at the same time.
const AT_ONCE: usize = 8;
const PATIENCE: Duration = Duration::from_secs(60);

/// A platform for a probe alone.
struct Behind {
    platform: Daemon,
    port: u16,
}

impl Behind {
    async fn start(folder: &Path) -> anyhow::Result<Self> {
        std::fs::create_dir_all(folder)?;
        let [port, broker] = free_ports::reserve()?;
        let config = folder.join("platform.toml");
        let text = format!(
            "data_directory = \"{}\"\n[web]\nlisten = \"127.0.0.1:{port}\"\n\
             public_url = \"https://platform.example\"\ntrusted_proxies = [\"{PROXY}\"]\n\
             [broker]\nlisten = \"127.0.0.1:{broker}\"\n\
             [admin]\nuser_name = \"{ADMIN}\"\npassword = \"{PASSWORD}\"\norganisation_id = \"{BUYER}\"\n",
            folder.join("data").display()
        );
        write_private(&config, &text)?;
        let platform = Daemon::start(DaemonCommand {
            name: "platform-behind-a-proxy".to_owned(),
            program: binary("platform")?,
            arguments: ["serve", "--config", &config.display().to_string()]
                .map(str::to_owned)
                .into(),
            environment: Vec::new(),
            log: folder.join("platform.log"),
        })?;
        let started = Self { platform, port };
        let ready = eventually("the platform serves", PATIENCE, || async {
            let asked = client_from(PROXY).map_err(|error| format!("{error:#}"))?;
            let asked = asked.get(started.address("/healthz")).send().await;
            let answer = asked.map_err(|error| error.to_string())?;
            answer.error_for_status().map(drop).map_err(|error| error.to_string())
        });
        ready.await.map_err(|error| error.context(started.platform.log_tail(20)))?;
        Ok(started)
    }

    fn address(&self, path: &str) -> String {
        format!("http://127.0.0.1:{}{path}", self.port)
    }

    /// Signs in from an address, in the name of a client where there is one.
    async fn sign_in(
        &self,
        from: Ipv4Addr,
        client: &str,
        (user, password): (&str, &str),
    ) -> anyhow::Result<reqwest::Response> {
        let body = json!({ "userName": user, "password": password });
        let request = client_from(from)?.post(self.address("/api/v1/session")).json(&body);
        Ok(request.header(CLIENT, client).send().await?)
    }

    /// Guesses, each time another name in the name of another client. Returns how many were checked.
    async fn guesses(
        &self,
        from: Ipv4Addr,
        client: impl Fn(usize) -> String,
    ) -> anyhow::Result<usize> {
        let calls = (0..GUESSES).map(|number| {
            let client = client(number);
            async move {
                let user = format!("guessed-{number}");
                let answer = self.sign_in(from, &client, (&user, "a guess like others")).await?;
                anyhow::Ok(answer.status())
            }
        });
        let answers: Vec<_> = stream::iter(calls).buffer_unordered(AT_ONCE).collect().await;
        let mut checked = 0;
        for status in answers {
            match status? {
                StatusCode::UNAUTHORIZED => checked += 1,
                StatusCode::TOO_MANY_REQUESTS | StatusCode::SERVICE_UNAVAILABLE => {}
                other => anyhow::bail!("answered {other}"),
            }
        }
        Ok(checked)
    }
}

/// Signs in through the proxy. The cookie is for this host and for TLS alone.
pub(super) async fn cookies(folder: PathBuf, pages: [u16; 2]) -> anyhow::Result<String> {
    let mut behind = Behind::start(&folder.join("cookies-behind-a-proxy")).await?;
    let answer = behind.sign_in(PROXY, "192.0.2.7", (ADMIN, PASSWORD)).await?;
    anyhow::ensure!(answer.status().is_success(), "answered {}", answer.status());
    let cookie = cookie_of(&answer)?;
    behind.platform.stop(Duration::from_secs(15))?;
    let attributes = ["; HttpOnly", "; SameSite=Strict", "; Path=/"];
    let is_bound = |cookie: &str, names: &[&str]| {
        names.iter().all(|name| cookie.contains(name)) && !cookie.contains("Domain")
    };
    anyhow::ensure!(
        cookie.starts_with("__Host-") && is_bound(&cookie, &["; Secure"]),
        "the cookie over TLS is {cookie}"
    );
    anyhow::ensure!(is_bound(&cookie, &attributes), "the cookie over TLS is {cookie}");
    // Daemons on one host: cookies know no ports.
    let mut names = vec![name_of(&cookie)];
    for (port, user) in pages.into_iter().zip([ADMIN, crate::world::ENGINEER]) {
        let body = json!({ "userName": user, "password": PASSWORD });
        let address = format!("http://127.0.0.1:{port}/api/v1/session");
        let answer = client_from(Ipv4Addr::LOCALHOST)?.post(address).json(&body).send().await?;
        let cookie = cookie_of(&answer)?;
        anyhow::ensure!(is_bound(&cookie, &attributes), "the cookie on this machine is {cookie}");
        names.push(name_of(&cookie));
    }
    names.sort();
    names.dedup();
    anyhow::ensure!(names.len() == 3, "daemons share a cookie: {names:?}");
    Ok(format!("{} of this host and TLS alone, each daemon has its own", name_of(&cookie)))
}

fn cookie_of(answer: &reqwest::Response) -> anyhow::Result<String> {
    let cookie = answer.headers().get(SET_COOKIE).and_then(|value| value.to_str().ok());
    cookie.map(str::to_owned).ok_or_else(|| anyhow::anyhow!("{} sets no cookie", answer.status()))
}

fn name_of(cookie: &str) -> String {
    cookie.split('=').next().unwrap_or_default().to_owned()
}

/// Guesses from many addresses of one network of IPv6 through the proxy, and from one address that makes up clients:
/// both count as one place. Another client of the same proxy is served.
pub(super) async fn places(folder: PathBuf) -> anyhow::Result<String> {
    let mut behind = Behind::start(&folder.join("guesses-behind-a-proxy")).await?;
    let of_network = behind.guesses(PROXY, |number| format!("2001:db8:7:7::{number:x}")).await?;
    let made_up = behind.guesses(NO_PROXY, |number| format!("198.51.100.{number}")).await?;
    let honest = behind.sign_in(PROXY, "203.0.113.9", (ADMIN, PASSWORD)).await?;
    behind.platform.stop(Duration::from_secs(15))?;
    for (place, checked) in [("a /64", of_network), ("one that is no proxy", made_up)] {
        anyhow::ensure!(checked <= CHECKED_MAX, "{checked} guesses of {place} were checked");
        anyhow::ensure!(checked > 0, "no guess of {place} was checked");
    }
    anyhow::ensure!(honest.status().is_success(), "another client gets {}", honest.status());
    Ok(format!("{of_network} and {made_up} of {GUESSES} checked, another client served"))
}
