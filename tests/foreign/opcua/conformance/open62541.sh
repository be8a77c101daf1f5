#!/usr/bin/env bash
# Builds open62541_player with the sources of open62541 and mbed TLS that the crate open62541-sys brings, and prints where it is.
# Needs a C compiler and CMake (tools/prerequisites.sh test). The first time takes a minute or two of a processor.
set -euo pipefail
cd "$(dirname "$0")"
here=$PWD
folder=$(cd ../../../.. && pwd)/target/foreign/open62541-client
mkdir -p "$folder"
exec 9>"$folder.lock" && flock 9
manifest=$here/../../asi/open62541/Cargo.toml
cargo fetch --quiet --locked --manifest-path "$manifest"
sources=$(cargo metadata --format-version 1 --offline --locked --manifest-path "$manifest" | python3 -c '
import json, pathlib, sys
found = [one for one in json.load(sys.stdin)["packages"] if one["name"] == "open62541-sys"]
print(pathlib.Path(found[0]["manifest_path"]).parent)')
if [[ "$(cat "$folder/.built" 2>/dev/null || true)" != "$sources" ]]; then
  # Its generators would write beside the sources of the registry otherwise.
  export PYTHONDONTWRITEBYTECODE=1
  installed=$folder/installed
  {
    cmake -S "$sources/mbedtls" -B "$folder/mbedtls" -DCMAKE_BUILD_TYPE=Release -DENABLE_PROGRAMS=OFF -DENABLE_TESTING=OFF \
      -DMBEDTLS_FATAL_WARNINGS=OFF -DCMAKE_INSTALL_PREFIX="$installed" -DCMAKE_INSTALL_LIBDIR=lib
    cmake --build "$folder/mbedtls" -j2 --target install
    cmake -S "$sources/open62541" -B "$folder/open62541" -DCMAKE_BUILD_TYPE=Release -DUA_ENABLE_ENCRYPTION=MBEDTLS \
      -DCMAKE_INSTALL_PREFIX="$installed" -DCMAKE_INSTALL_LIBDIR=lib -DCMAKE_INTERPROCEDURAL_OPTIMIZATION=OFF \
      -DMBEDTLS_FOLDER_INCLUDE="$installed/include" -DMBEDTLS_FOLDER_LIBRARY="$installed/lib" \
      -DMBEDTLS_INCLUDE_DIRS="$installed/include" -DMBEDTLS_LIBRARY="$installed/lib/libmbedtls.a" \
      -DMBEDX509_INCLUDE_DIRS="$installed/include" -DMBEDX509_LIBRARY="$installed/lib/libmbedx509.a" \
      -DMBEDCRYPTO_INCLUDE_DIRS="$installed/include" -DMBEDCRYPTO_LIBRARY="$installed/lib/libmbedcrypto.a"
    cmake --build "$folder/open62541" -j2 --target install
  } >"$folder/build.log" 2>&1 || { tail -40 "$folder/build.log" >&2; exit 1; }
  echo "$sources" >"$folder/.built"
fi
player=$folder/open62541_player
if [[ open62541_player.c -nt "$player" || "$folder/.built" -nt "$player" ]]; then
  # Beside it first: another test may be running the one that is there.
  cc -Wall -Wextra -Wno-unused-parameter -Werror -O1 -I"$folder/installed/include" open62541_player.c -o "$player.new" \
    -L"$folder/installed/lib" -lopen62541 -lmbedtls -lmbedx509 -lmbedcrypto -lm
  mv "$player.new" "$player"
fi
echo "$player"
