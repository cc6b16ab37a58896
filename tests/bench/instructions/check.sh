#!/usr/bin/env bash
# Counts the instructions of each case under callgrind and compares them with the recorded ones: more or fewer by
# over 3 % fails, so that what a change costs is seen in the change. Time plays no part.
#
# Usage: check.sh PROGRAM [--record]       --record writes the counts as the new ones, to be looked at and committed
set -euo pipefail
program=$1
recorded=$(dirname "${BASH_SOURCE[0]}")/recorded.txt
command -v valgrind >/dev/null || {
  echo "SKIPPED: there is no valgrind" >&2
  exit 77
}
# The same routines on every processor: those that callgrind knows.
export OPENBLAS_CORETYPE=Haswell OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
export GLIBC_TUNABLES=glibc.cpu.x86_rep_movsb_threshold=1000000000:glibc.cpu.x86_rep_stosb_threshold=1000000000:glibc.cpu.x86_non_temporal_threshold=268435456

# counted CASE: the instructions, alone.
counted() {
  valgrind --tool=callgrind --callgrind-out-file=/dev/null --collect-atstart=no "$program" "$1" 2>&1 |
    sed -n 's/^==[0-9]*== Collected : //p'
}

failed=0 counts=''
printf '%-18s %13s %13s %8s\n' case recorded counted change
for name in $("$program" --list); do
  now=$(counted "$name")
  [ -n "$now" ] || {
    printf '%-18s ends without a count\n' "$name"
    exit 1
  }
  counts+=$(printf '%-18s %13s' "$name" "$now")$'\n'
  before=$(awk -v name="$name" '$1 == name { print $2 }' "$recorded" 2>/dev/null || true)
  awk -v name="$name" -v before="${before:-0}" -v now="$now" 'BEGIN {
    change = before > 0 ? (now / before - 1) * 100 : 100
    far = change > 3 || change < -3
    printf "%-18s %13d %13d %+7.1f %%%s\n", name, before, now, change, far ? "  <<" : ""
    exit far
  }' || failed=1
done
if [ "${2-}" = --record ]; then
  printf '%s' "$counts" >"$recorded"
  exit 0
fi
[ "$failed" -eq 0 ] || {
  echo "Where the change is meant: $0 $program --record, and say so in the commit." >&2
  exit 1
}
