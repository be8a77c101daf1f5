#!/usr/bin/env bash
# Output of asi-model, read by other people's stacks: node-opcua-json decodes every value of `digicor`, node-opcua
# and asyncua load the NodeSet2 files, open62541 reads every value of 1.05 and writes it again. Installs what it needs into
# ignored folders. These tests are among those of `make test`, too.
set -euo pipefail
cd "$(dirname "$0")/../../.."
tests/foreign/setup.sh
cargo test --locked -p asi-model --test it -- foreign
