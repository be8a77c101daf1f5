#!/usr/bin/env bash
# Output of asi-model, read by other people's stacks: node-opcua-json decodes every value of `digicor`, node-opcua
# and asyncua load the NodeSet2 files, open62541 decodes every value of 1.05. Installs what it needs into ignored
# folders. With `--with-open62541` the last is included (a C compiler works for some minutes the first time).
set -euo pipefail
cd "$(dirname "$0")/../../.."
tests/foreign/setup.sh
cargo test --locked -p asi-model --test it -- foreign
if [[ "${1:-}" == --with-open62541 ]]; then
  tests/foreign/asi/open62541/run.sh
fi
