#!/usr/bin/env bash
# Builds open62541 (needs a C compiler; libclang and, where there is none, CMake come from the Python registry) and lets
# it read what asi-model writes in 1.05.
set -euo pipefail
cd "$(dirname "$0")"
folder=$(cd ../../../.. && pwd)/target/foreign/open62541
mkdir -p "$folder"
if [[ ! -e "$folder/python/.installed" ]]; then
  python3 -m venv --clear "$folder/python"
  "$folder/python/bin/pip" install --quiet --disable-pip-version-check libclang==18.1.1 cmake==3.31.6
  touch "$folder/python/.installed"
fi
if ! command -v cmake >/dev/null; then
  export PATH="$PATH:$folder/python/bin"
fi
if [[ -z "${LIBCLANG_PATH:-}" ]]; then
  LIBCLANG_PATH=$("$folder/python/bin/python" -c 'import clang, pathlib; print(pathlib.Path(clang.__file__).parent / "native")')
  export LIBCLANG_PATH
fi
# The wheel brings no compiler headers; those of the C compiler do.
export BINDGEN_EXTRA_CLANG_ARGS="${BINDGEN_EXTRA_CLANG_ARGS:-} -I$(cc -print-file-name=include)"
CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$folder/cargo} cargo run --locked --quiet
