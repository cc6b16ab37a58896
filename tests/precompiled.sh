#!/usr/bin/env bash
# Two checkouts that share a cache, and a generated header that changes in each: what a program is
# compiled from is the header that is there, precompiled or not, and equal ones are compiled once.
#
# Usage: precompiled.sh CCACHE COMPILER
set -euo pipefail
ccache=$1
compiler=$2
launcher=$(cd "$(dirname "$0")/../cmake" && pwd)/ccache.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export CCACHE_DIR=$work/cache

# compile CHECKOUT ARGUMENT…: as the build does, in its folder.
compile() {
  local checkout=$work/$1
  shift
  (cd "$checkout/build" && sh "$launcher" "$checkout" "$ccache" "$compiler" -I"$checkout" -std=c++20 -fpch-preprocess \
    -Winvalid-pch -include "$checkout/build/pch.hxx" -MD "$@")
}

# step CHECKOUT VERSION: the header becomes this one and all is built anew.
step() {
  local checkout=$work/$1
  if [ ! -d "$checkout" ]; then
    mkdir -p "$checkout/build"
    printf '#include <cstdio>\n#include <generated.h>\n' >"$checkout/build/pch.hxx"
    printf '/* nothing */\n' >"$checkout/build/pch.hxx.cxx"
    printf '#include <generated.h>\nint main() { std::printf("%%d\\n", version()); }\n' >"$checkout/main.cc"
  fi
  printf '#ifndef GENERATED\n#define GENERATED\ninline int version() { return %s; }\n#endif\n' "$2" >"$checkout/generated.h"
  compile "$1" -x c++-header -MF pch.d -o pch.hxx.gch -c "$checkout/build/pch.hxx.cxx"
  compile "$1" -MF main.d -o main.o -c "$checkout/main.cc"
  "$compiler" -o "$checkout/main" "$checkout/build/main.o"
  local printed
  printed=$("$checkout/main")
  [ "$printed" = "$2" ] || { echo "$1: the header says $2, the program $printed" >&2; exit 1; }
}

misses() { "$ccache" --print-stats | sed -n 's/^cache_miss\t//p'; }

step one 1
step two 1
[ "$(misses)" = 2 ] || { echo "what is equal was compiled again" >&2; "$ccache" -s >&2; exit 1; }
step one 2
step two 3
step two 2
step one 1
