#!/usr/bin/env bash
# Compiles what open62541 reads and writes JSON with, and nothing else of it: seconds instead of the minutes of the whole
# stack. Its sources come from the Rust registry (open62541-sys); CMake and a C compiler are needed. The program is then
# target/foreign/open62541/through.
set -euo pipefail
cd "$(dirname "$0")"
folder=$(cd ../../../.. && pwd)/target/foreign/open62541
mkdir -p "$folder"
exec 9>"$folder.lock" && flock 9
if cat Cargo.lock build.sh through.c | cmp -s - "$folder/built-from"; then exit 0; fi
sources=$(cargo metadata --locked --quiet --format-version 1 | python3 -c '
import json, pathlib, sys
packages = json.load(sys.stdin)["packages"]
print(next(pathlib.Path(p["manifest_path"]).parent for p in packages if p["name"] == "open62541-sys") / "open62541")')
# Types are generated; options leave out what generates more.
cmake -S "$sources" -B "$folder/cmake" -DUA_NAMESPACE_ZERO=MINIMAL -DUA_ENABLE_JSON_ENCODING=ON -DUA_ENABLE_PUBSUB=OFF \
  -DUA_ENABLE_SUBSCRIPTIONS=OFF -DUA_ENABLE_METHODCALLS=OFF -DUA_ENABLE_HISTORIZING=OFF -DUA_ENABLE_DISCOVERY=OFF \
  -DUA_ENABLE_NODEMANAGEMENT=OFF -DUA_MULTITHREADING=0 >"$folder/cmake.log" 2>&1 || { cat "$folder/cmake.log"; exit 1; }
env -u MAKEFLAGS -u MAKELEVEL make -C "$folder/cmake" open62541-generator-types open62541-generator-ids-ns0 open62541-generator-statuscode \
  open62541-generator-transport >/dev/null
cc -std=c99 -D_GNU_SOURCE -O0 -w -ffunction-sections -fdata-sections -Wl,--gc-sections \
  -I"$folder/cmake/src_generated" -I"$sources/include" -I"$sources/plugins/include" -I"$sources/deps" -I"$sources/src" \
  through.c "$sources"/src/ua_types{,_definition,_encoding_binary,_encoding_json,_encoding_json_105}.c \
  "$sources"/src/util/ua_{types_lex,util}.c "$folder"/cmake/src_generated/open62541/{types_generated,statuscodes}.c \
  "$sources"/deps/{base64,cj5,dtoa,itoa,libc_time,mp_printf,parse_num,pcg_basic,utf8,ziptree}.c -lm -o "$folder/through"
cat Cargo.lock build.sh through.c >"$folder/built-from"
