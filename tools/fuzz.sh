#!/usr/bin/env bash
# Feeds random input to every edge of the programs and prints what came of it.
#
#   tools/fuzz.sh SECONDS|HOURSh|keep [TARGET...]
#
# Each folder `fuzz` of a package has targets for libFuzzer and, below `corpus/TARGET`, what former runs found worth
# keeping; the tests of the package replay it. A target that takes more than 256 MB has found something: an input
# has 4 KB at most, of `chunks` 70 KB. A target gets SECONDS, or its part of HOURS; as many run at a time as
# there are processors. `keep` stores what was grown, short inputs that together reach all that all of them reach,
# as `corpus/TARGET.base64`, a line each; a run begins with them. New inputs go to target/fuzz/corpus, and what broke a target
# to target/fuzz/found. With RECORD=1 the run of each target is written into its row of docs/fuzzing.md, for a commit. Needs
# the Rust and C++ compilers only: the instrumentation is by stable options of the compiler.
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD seconds=$1
shift
host=$(rustc -vV | sed -n 's/^host: //p')
export CARGO_TARGET_DIR=$root/target/fuzz/build
flags="--cfg fuzzing -Cpasses=sancov-module -Cdebug-assertions -Coverflow-checks"
for argument in level=4 inline-8bit-counters pc-table trace-compares; do
  flags+=" -Cllvm-args=-sanitizer-coverage-$argument"
done

targets=()
for manifest in asi-model/fuzz platform/broker/fuzz opcua-stack/fuzz mapping-engine/script-protocol/fuzz \
  messaging/fuzz messaging/websocket/fuzz daemon/fuzz platform/fuzz factory-connector/fuzz factory-connector/twin/fuzz; do
  for source in "$manifest"/fuzz_targets/*.rs; do
    name=$(basename "$source" .rs)
    [ $# = 0 ] || [[ " $* " == *" $name "* ]] || continue
    # With a target triple the flags are for the fuzzed code only, not for build scripts.
    RUSTFLAGS=$flags cargo build --quiet --release --locked --target "$host" --manifest-path "$manifest/Cargo.toml" \
      --bin "$name"
    targets+=("$manifest $name")
  done
done
[ ${#targets[@]} != 0 ] || { echo "No target is called $*." >&2; exit 2; }

# Stores what was grown beside the committed corpus.
keep() {
  local folder=$1 name=$2 merged=$root/target/fuzz/merged/$2
  rm -rf "$merged" && mkdir -p "$merged"
  "$CARGO_TARGET_DIR/$host/release/$name" -merge=1 -max_len=4096 -rss_limit_mb=2048 "$merged" "$root/target/fuzz/corpus/$name" \
    "$root/$folder/corpus/$name" >"$root/target/fuzz/$name.merge.log" 2>&1
  for input in "$merged"/*; do base64 -w0 "$input" && echo; done | LC_ALL=C sort >"$root/$folder/corpus/$name.base64"
  echo "$name: $(wc -l <"$root/$folder/corpus/$name.base64") inputs kept"
}

# Lets a run begin with what was kept.
unpack() {
  local folder=$1 name=$2 corpus=$root/target/fuzz/corpus/$2 number=0
  mkdir -p "$corpus"
  [ -z "$(ls -A "$corpus")" ] || return 0
  while read -r line; do
    number=$((number + 1))
    base64 -d <<<"$line" >"$corpus/kept-$number"
  done <"$root/$folder/corpus/$name.base64"
}

if [ "$seconds" = keep ]; then
  for target in "${targets[@]}"; do
    # shellcheck disable=SC2086
    keep $target
  done
  exit
fi
for target in "${targets[@]}"; do
  # shellcheck disable=SC2086
  unpack $target
done

if [[ $seconds == *h ]]; then
  seconds=$((${seconds%h} * 3600 * $(nproc) / ${#targets[@]}))
fi

# Writes what came of a target into its row; several may end at once.
record() {
  local name=$1 run=$2 table=$root/docs/fuzzing.md
  exec 9>"$root/target/fuzz/record.lock" && flock 9
  awk -v name="$name" -v run="$run" 'BEGIN { FS = " [|] " }
    index($0, "| `" name "` | ") == 1 { print $1 " | " $2 " | " $3 " | " run " |"; found = 1; next }
    { print }
    END { exit !found }' "$table" >"$table.new" && mv "$table.new" "$table" || {
    rm -f "$table.new"
    echo "docs/fuzzing.md has no row for $name." >&2
    return 1
  }
}

play() {
  local folder=$1 name=$2 log=$root/target/fuzz/$2.log
  local corpus=$root/target/fuzz/corpus/$name found=$root/target/fuzz/found/$name seeds=()
  mkdir -p "$corpus" "$found"
  [ ! -d "$root/$folder/corpus/$name" ] || seeds+=("$root/$folder/corpus/$name")
  local result="nothing found" length=4096
  # A whole chunk, and the beginning of the next.
  [ "$name" != chunks ] || length=70000
  # Memory that is claimed and never written is not resident: a claim of gigabytes fails at this bound of addresses.
  (ulimit -v 3145728 && exec "$CARGO_TARGET_DIR/$host/release/$name" "$corpus" "${seeds[@]}" -max_total_time="$seconds" -timeout=30 -max_len="$length" \
    -rss_limit_mb=256 -artifact_prefix="$found/" -print_final_stats=1) >"$log" 2>&1 || result="FOUND: $found, $log"
  local count most
  count=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  most=$(sed -n 's/^stat::peak_rss_mb: *//p' "$log")
  # A target that plays nothing finds nothing.
  [ "${count:-0}" -ge 1000 ] || [ "$result" != "nothing found" ] || result="FOUND: only ${count:-no} inputs"
  local run="${count:-0} | $seconds | ${most:-?} | $commit"
  echo "| \`$name\` | $run | $result |"
  if [ "${RECORD:-}" = 1 ]; then
    # Logs are of this machine.
    record "$name" "$run | $(date -u +%F) | ${result%%:*}"
  fi
  [ "$result" = "nothing found" ]
}
commit=$(git describe --always --dirty --abbrev=8 --exclude '*')
export -f play record
export root seconds host commit
echo "| Target | Inputs | Seconds | Most MB | Commit | Found |"
echo "|---|---|---|---|---|---|"
printf '%s\n' "${targets[@]}" | xargs -P "$(nproc)" -L 1 bash -c 'play "$0" "$1"'
