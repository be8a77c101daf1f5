#!/usr/bin/env bash
# Breaks one rule of the disclosure gate after the other; the tests of the gate, the state, the
# coordinator, the twin and the logs have to notice each. README.md beside the patches says which
# member of a policy each of them breaks.
#
#   tests/mutants/gate.sh [NAME...]
#
# Each patch in tests/mutants/gate is one mutant. A first line `Found by: ...` names the tests that are
# played before all others, or that are not among them. It is played in a copy of the committed tree, below
# target, so that the tree itself stays as it is. GATE_TARGET is the folder of what is built for it.
set -euo pipefail
cd "$(dirname "$0")/../.."
root=$PWD copy=$PWD/target/mutants-gate/tree
export CARGO_TARGET_DIR=${GATE_TARGET:-$PWD/target/mutants-gate/build}
names=("$@")
if [ ${#names[@]} = 0 ]; then
  for patch in tests/mutants/gate/*.patch; do names+=("$(basename "$patch" .patch)"); done
fi
rm -rf "$copy" && mkdir -p "$copy"
git archive HEAD | tar -x -C "$copy"
# The pages are built into the connector; what they show does not matter here.
mkdir -p "$copy/web/dist" && [ ! -d web/dist ] || cp -r web/dist "$copy/web/"
cd "$copy"

# Cheap ones first: most mutants are found by the crate that they are in.
tests=(
  "-p disclosure --lib"
  "-p connector-state --lib"
  "-p factory-connector --lib coordinator::tests::replacement"
  "-p factory-connector --lib coordinator::tests::message_times"
  "-p factory-connector --lib coordinator::tests::knowledge"
)
survivors=()
for name in "${names[@]}"; do
  patch=$root/tests/mutants/gate/$name.patch log=$root/target/mutants-gate/$name.log
  patch --quiet -p1 <"$patch"
  result=survived
  mapfile -t first < <(sed -n 's/^Found by: //p' "$patch")
  for test in "${first[@]}" "${tests[@]}"; do
    # shellcheck disable=SC2086
    if ! cargo test --quiet --locked $test >"$log" 2>&1; then
      # A mutant that does not compile proves nothing.
      if grep -q '^test result: FAILED\|^failures:' "$log"; then
        result="found: $(grep -oE '^    [a-z_:]+$' "$log" | head -1 | tr -d ' ')"
      else
        result="not judged: $(grep -m1 '^error' "$log" | cut -c1-120)"
      fi
      break
    fi
  done
  patch --quiet --reverse -p1 <"$patch"
  echo "$name: $result"
  [[ $result == found* ]] || survivors+=("$name")
done
[ ${#survivors[@]} = 0 ] || { echo "Not found: ${survivors[*]} (logs in target/mutants-gate)"; exit 1; }
