#!/usr/bin/env bash
# Installs the foreign peers that the tests talk to: asyncua (Python) and node-opcua, rhea (Node), the validator of
# OpenAPI documents and joserfc (Python); open62541 is built by those who need it. Prints nothing when they are there already. Python with its packages and Proton is
# then at target/foreign/python/bin/python; the Node scripts of this folder find their packages by themselves.
set -euo pipefail
cd "$(dirname "$0")"
venv=$(cd ../.. && pwd)/target/foreign/python
mkdir -p "$(dirname "$venv")"
exec 9>"$venv.lock" && flock 9
# The distribution's Python, so that its Proton package can be imported.
if ! cmp -s requirements.txt "$venv/requirements.txt"; then
  /usr/bin/python3 -m venv --clear --system-site-packages "$venv"
  "$venv/bin/pip" install --quiet --disable-pip-version-check -r requirements.txt
  cp requirements.txt "$venv/requirements.txt"
fi
if ! cmp -s package-lock.json node_modules/.installed-lock.json; then
  npm ci --no-audit --no-fund --loglevel=error >/dev/null
  cp package-lock.json node_modules/.installed-lock.json
fi
