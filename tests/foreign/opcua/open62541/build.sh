#!/usr/bin/env bash
# Builds the server of this folder on open62541, whose sources come with the crate that ../../asi/open62541 names. Needs a C
# compiler and CMake; half a minute, once. The program is target/foreign/open62541/machine.
set -euo pipefail
cd "$(dirname "$0")"
folder=$(cd ../../../.. && pwd)/target/foreign/open62541
mkdir -p "$folder"
manifest=../../asi/open62541/Cargo.toml
if [[ -x "$folder/machine" ]] && cat machine.c build.sh "${manifest%.toml}.lock" | cmp -s - "$folder/machine.of"; then
  exit
fi
export PYTHONDONTWRITEBYTECODE=1
crate=$(cargo metadata --locked --format-version 1 --manifest-path "$manifest" | /usr/bin/python3 -c '
import json, pathlib, sys
packages = json.load(sys.stdin)["packages"]
print(next(pathlib.Path(p["manifest_path"]).parent for p in packages if p["name"] == "open62541-sys"))')
# Without optimisation over all files: the linker has to find the functions that `machine.c` stands before.
cmake -S "$crate/open62541" -B "$folder/library" -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF \
  -DCMAKE_INTERPROCEDURAL_OPTIMIZATION=OFF -DUA_ENABLE_ENCRYPTION=OFF >"$folder/library.log" 2>&1 &&
  cmake --build "$folder/library" --target open62541 --parallel "$(nproc)" >>"$folder/library.log" 2>&1 ||
  { cat "$folder/library.log" >&2; exit 1; }
library=$folder/library
cc -std=c11 -D_DEFAULT_SOURCE -O2 -Wall -Wextra -Werror -isystem "$library/src_generated" -isystem "$crate/open62541/include" \
  -isystem "$crate/open62541/plugins/include" machine.c \
  "$library/bin/libopen62541.a" -Wl,--wrap=sendResponse,--wrap=Service_Read -lm -lpthread -o "$folder/machine.new"
mv "$folder/machine.new" "$folder/machine"
cat machine.c build.sh "${manifest%.toml}.lock" >"$folder/machine.of"
