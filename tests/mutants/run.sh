#!/usr/bin/env bash
# Breaks one guarantee after the other and plays chaos: a run that proves anything has to notice.
#
#   [BROKER=rabbitmq] tests/mutants/run.sh [MINUTES] [SEED] [NAME...]
#
# Each patch here is one mutant. Its first line may say by what it has to be found: "Fault: REGEX". It is looked for
# among the faults of the judge alone (target/mutants/NAME.faults), whatever the log of the run says. The tree must be
# clean; it is clean again afterwards, whatever happens.
set -euo pipefail
cd "$(dirname "$0")/../.."
minutes=${1:-5} seed=${2:-7} broker=${BROKER:-embedded}
shift $(($# < 2 ? $# : 2))
[ -z "$(git status --porcelain --untracked-files=no)" ] || { echo "Commit or stash first: the mutants change files." >&2; exit 1; }
mkdir -p target/mutants
names=("$@")
if [ ${#names[@]} = 0 ]; then
  for patch in tests/mutants/*.patch; do names+=("$(basename "$patch" .patch)"); done
fi

# Without a mutant nothing may be found: what fails by itself would find all of them.
cargo build --quiet --locked --workspace --bins
if ! target/debug/chaos --minutes "$minutes" --seed "$seed" --broker "$broker" >target/mutants/none.log 2>&1; then
  echo "The run fails without a mutant (log in target/mutants/none.log): $(tail -1 target/mutants/none.log | cut -c1-160)" >&2
  exit 1
fi

survivors=()
for name in "${names[@]}"; do
  patch=tests/mutants/$name.patch log=target/mutants/$name.log faults=target/mutants/$name.faults
  rm -f "$faults"
  git apply "$patch" || { echo "$name: does not apply"; survivors+=("$name"); continue; }
  trap 'git apply --reverse "$patch"' EXIT
  fault=$(sed -n '1s/^Fault: //p' "$patch")
  # With the features of the whole workspace, as `make test` builds it: only what the patch changes is built again.
  if ! cargo build --quiet --locked --workspace --bins; then
    result="does not compile"
  # A fault that the run reports is a mutant found; a run that broke off elsewhere proves nothing.
  elif target/debug/chaos --minutes "$minutes" --seed "$seed" --broker "$broker" --faults "$faults" >"$log" 2>&1; then
    result=survived
  elif [ -s "$faults" ]; then
    if [ -n "$fault" ] && ! grep -qE -e "$fault" "$faults"; then
      result="not found by \"$fault\": $(head -1 "$faults" | cut -c1-120)"
    else
      result="found: $(wc -l <"$faults") faults: $(grep -m1 -E -e "$fault" "$faults" | cut -c1-120)"
    fi
  else
    result="not judged: $(tail -1 "$log" | cut -c1-160)"
  fi
  git apply --reverse "$patch"
  trap - EXIT
  echo "$name: $result"
  [[ $result == found* ]] || survivors+=("$name")
done
[ ${#survivors[@]} = 0 ] || { echo "Not found: ${survivors[*]} (logs in target/mutants)"; exit 1; }
