# shellcheck shell=bash
# Sourced by every script here: the repository root, talking, failing, building.

ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
export ROOT

# say WORDS…: what is going on, on stderr, so that stdout stays the script's answer.
say() { printf '\n== %s\n' "$*" >&2; }

die() {
  printf '%s: %s\n' "${0##*/}" "$*" >&2
  exit 1
}

# as_root COMMAND…: runs it as root, by sudo when we are somebody else.
as_root() {
  if [ "$(id -u)" -eq 0 ]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    die "needs root or sudo for: $*"
  fi
}

# build_preset PRESET [TARGET…]: configures and builds into build/PRESET. Warnings are errors in the daily
# build only: g++ warns of things that are not so under -O3 and under sanitizers.
build_preset() {
  local preset=$1 werror=OFF
  shift
  [ "$preset" != dev ] || werror=ON
  say "Configure preset $preset"
  (cd "$ROOT" && cmake --preset "$preset" -DARAP_WERROR=$werror) >&2
  say "Build preset $preset"
  (cd "$ROOT" && cmake --build --preset "$preset" --parallel "$(nproc)" ${1:+--target "$@"}) >&2
}
