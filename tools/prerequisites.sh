#!/usr/bin/env bash
# Makes sure that what a make target needs is on this machine.
#
#   tools/prerequisites.sh demo   a C compiler, curl-free: Rust and Node are the user's to install
#   tools/prerequisites.sh test   and the foreign peers: browser, brokers, Python and Node clients
#
# As root on Debian missing packages are installed and named; elsewhere the one command to run is printed.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() { printf '\n%s\n' "$1" >&2; exit 1; }

need_version() { # command, wanted major.minor, how to get it
  command -v "$1" >/dev/null || fail "$1 is missing. $3"
  local found
  found=$("$1" --version | grep -oE '[0-9]+\.[0-9]+' | head -1)
  [ "$(printf '%s\n%s\n' "$2" "$found" | sort -V | head -1)" = "$2" ] || fail "$1 $found is too old: $2 or newer is needed. $3"
}

need_version cargo 1.95 "Install Rust with rustup (see README, Prerequisites)."
need_version node 20.19 "Install Node.js 20.19 or newer (see README, Prerequisites)."
command -v npm >/dev/null || fail "npm is missing. It comes with Node.js."

packages=(gcc:gcc libc6-dev:/usr/include/stdlib.h util-linux:setpriv)
if [ "${1:-demo}" = test ]; then
  packages+=(chromium:chromium fonts-dejavu-core:/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf
    python3-venv:/usr/share/doc/python3-venv python3-qpid-proton:/usr/lib/python3/dist-packages/proton
    rabbitmq-server:/usr/lib/rabbitmq mosquitto:/usr/sbin/mosquitto
    libfaketime:/usr/share/doc/libfaketime systemd:systemd-analyze
    g++:c++)
fi

missing=()
for entry in "${packages[@]}"; do
  package=${entry%%:*} probe=${entry#*:}
  case $probe in
    /*) [ -e "$probe" ] || missing+=("$package") ;;
    *) command -v "$probe" >/dev/null || missing+=("$package") ;;
  esac
done

if [ ${#missing[@]} -gt 0 ]; then
  install="apt-get update && apt-get install -y --no-install-recommends ${missing[*]}"
  if [ "$(id -u)" = 0 ] && [ -e /etc/debian_version ]; then
    echo "Installing Debian packages: ${missing[*]}"
    # Services of these packages are started by the tests on ports of their own, never by the package.
    printf '#!/bin/sh\nexit 101\n' >/tmp/verbund-policy-rc.d && chmod +x /tmp/verbund-policy-rc.d
    [ -e /usr/sbin/policy-rc.d ] || { cp /tmp/verbund-policy-rc.d /usr/sbin/policy-rc.d; trap 'rm -f /usr/sbin/policy-rc.d' EXIT; }
    export DEBIAN_FRONTEND=noninteractive
    apt-get update -qq
    apt-get install -y -qq --no-install-recommends "${missing[@]}" >/tmp/verbund-apt.log 2>&1 ||
      { tail -20 /tmp/verbund-apt.log >&2; fail "apt-get could not install ${missing[*]}."; }
  else
    fail "These packages are missing: ${missing[*]}
On Debian run as root:  $install"
  fi
fi
