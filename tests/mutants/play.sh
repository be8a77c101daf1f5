#!/usr/bin/env bash
# Breaks one rule after the other, or brings one attack back; the tests have to notice each.
#
#   tests/mutants/play.sh gate|ledger|platform|edges [NAME...]
#
# Each patch in the folder is one mutant. The folder's file `tests` has the tests that are played against it, as arguments
# of `cargo test`, a line each. A first line `Found by: ...` of a patch names the tests that are played before them, or
# that are not among them. A mutant that docs/attacks.md names has to be found by a test of its row. Mutants are played in a copy of the committed tree, below target, so that the tree itself stays
# as it is. MUTANTS_TARGET is the folder of what is built for it.
set -euo pipefail
cd "$(dirname "$0")/../.."
part=${1:?which folder of tests/mutants} && shift
root=$PWD logs=$PWD/target/mutants/$part copy=$PWD/target/mutants/$part/tree
# A history that fails is not made smaller, which takes minutes.
export VERBUND_KNOWLEDGE_SHRINKS=0
export CARGO_TARGET_DIR=${MUTANTS_TARGET:-$PWD/target/mutants/build}
names=("$@")
if [ ${#names[@]} = 0 ]; then
  for patch in "tests/mutants/$part"/*.patch; do names+=("$(basename "$patch" .patch)"); done
fi
rm -rf "$copy" && mkdir -p "$copy"
git archive HEAD | tar -x -C "$copy"
# The pages are built into the daemons; what they show does not matter here.
mkdir -p "$copy/web/dist" && [ ! -d web/dist ] || cp -r web/dist "$copy/web/"
cd "$copy"

mapfile -t tests < <(grep -v '^#' "$root/tests/mutants/$part/tests")
# A failure that is there without any mutant would find them all.
mapfile -t own < <(for name in "${names[@]}"; do sed -n 's/^Found by: //p' "$root/tests/mutants/$part/$name.patch"; done | sort -u)
for test in "${tests[@]}" "${own[@]}"; do
  # shellcheck disable=SC2086
  cargo test --quiet --locked $test >"$logs/none.log" 2>&1 || { echo "The tests fail without a mutant: $logs/none.log"; exit 1; }
done
# Tests of the rows of docs/attacks.md that name a mutant, without their packages.
named() { { grep -F "tests/mutants/$part/$1.patch" "$root/docs/attacks.md" || true; } | grep -oE '`[a-z-]+::[a-z_0-9]+`' | sed 's/.*:://; s/`//' | sort -u; }

survivors=()
for name in "${names[@]}"; do
  patch=$root/tests/mutants/$part/$name.patch log=$logs/$name.log
  patch --quiet -p1 <"$patch"
  result=survived failed=
  mapfile -t first < <(sed -n 's/^Found by: //p' "$patch")
  mapfile -t expected < <(named "$name")
  for test in "${first[@]}" "${tests[@]}"; do
    # shellcheck disable=SC2086
    cargo test --quiet --locked --no-fail-fast $test >"$log" 2>&1 && continue
    # A mutant that does not compile proves nothing.
    if ! grep -q '^test result: FAILED\|^failures:' "$log"; then
      result="not judged: $(grep -m1 '^error' "$log" | cut -c1-120)"
      break
    fi
    failed+=" $(grep -oE '^    [a-z_0-9:]+$' "$log" | sort -u | tr -d ' ' | paste -sd ' ')"
    result="found by tests of other rows only:$failed"
    if [ ${#expected[@]} = 0 ] || grep -qE "(^|:)($(IFS='|'; echo "${expected[*]}"))$" <(tr ' ' '\n' <<<"$failed"); then
      result="found:$failed"
      break
    fi
  done
  patch --quiet --reverse -p1 <"$patch"
  echo "$name: $result"
  [[ $result == found:* ]] || survivors+=("$name")
done
[ ${#survivors[@]} = 0 ] || { echo "Not found: ${survivors[*]} (logs in target/mutants/$part)"; exit 1; }
