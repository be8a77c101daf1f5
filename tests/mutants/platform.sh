#!/usr/bin/env bash
# Brings one attack on the platform back after the other; its tests have to notice each.
#
#   tests/mutants/platform.sh [NAME...]
#
# Each patch in tests/mutants/platform is one mutant, named in docs/attacks.md with its tests. It is played
# in a copy of the committed tree, below target, so that the tree itself stays as it is. PLATFORM_TARGET is the
# folder of what is built for it.
set -euo pipefail
cd "$(dirname "$0")/../.."
root=$PWD copy=$PWD/target/mutants-platform/tree
export CARGO_TARGET_DIR=${PLATFORM_TARGET:-$PWD/target/mutants-platform/build}
names=("$@")
if [ ${#names[@]} = 0 ]; then
  for patch in tests/mutants/platform/*.patch; do names+=("$(basename "$patch" .patch)"); done
fi
rm -rf "$copy" && mkdir -p "$copy"
git archive HEAD | tar -x -C "$copy"
# The pages are built into the platform; what they show does not matter here.
mkdir -p "$copy/web/dist" && [ ! -d web/dist ] || cp -r web/dist "$copy/web/"
cd "$copy"

# Modules of tests, each with a test for a rule that an attack broke.
modules=(rights:: sight:: isolation:: entitlement:: foreign_requests:: receipts:: audit:: removals:: visibility::)
survivors=()
for name in "${names[@]}"; do
  patch=$root/tests/mutants/platform/$name.patch log=$root/target/mutants-platform/$name.log
  patch --quiet -p1 <"$patch"
  result=survived
  if ! cargo test --quiet --locked --package platform --lib --test it -- "${modules[@]}" >"$log" 2>&1; then
    # A mutant that does not compile proves nothing.
    if grep -q '^test result: FAILED\|^failures:' "$log"; then
      result="found: $(grep -oE '^    [a-z_:]+$' "$log" | sort -u | tr -d ' ' | paste -sd ' ')"
    else
      result="not judged: $(grep -m1 '^error' "$log" | cut -c1-120)"
    fi
  fi
  patch --quiet --reverse -p1 <"$patch"
  echo "$name: $result"
  [[ $result == found* ]] || survivors+=("$name")
done
[ ${#survivors[@]} = 0 ] || { echo "Not found: ${survivors[*]} (logs in target/mutants-platform)"; exit 1; }
