#!/usr/bin/env bash
# What is installed, used by others: takes what is built, builds nothing of it.
#
# Usage: consumers.sh PART SOURCE BUILD WORK
#   PART    prefix      installs the components of libraries into WORK/prefix, and into others one by one
#           headers     every header compiles alone, and shows none but public ones
#           client core c     a project beside this file, found by CMake
#           pkgconfig   the programs of `client` and `c`, found by pkg-config
#           readme      the example in C++ of README.md, against the arapd of BUILD
#           shell       the commands of README.md that play with arapctl
#   SOURCE  the repository;  BUILD  its build tree;  WORK  a folder for all that is made
# Of the environment: CC, CXX, and ARAP_SANITIZE as the tree was configured.
set -euo pipefail
part=$1 source=$2 build=$3 work=$4
here=$source/tests/install
prefix=$work/prefix
CC=${CC:-cc}
CXX=${CXX:-c++}
mkdir -p "$work"

die() {
  printf '%s\n' "$*" >&2
  exit 1
}

install_to() {
  local to=$1 component
  shift
  rm -rf "$to"
  for component in "$@"; do
    cmake --install "$build" --prefix "$to" --component "$component" >/dev/null
  done
}

# no_solver PROGRAM: it loads neither CHOLMOD nor what that needs.
no_solver() {
  local loaded
  loaded=$(ldd "$1" | grep -E 'cholmod|openblas|lapack|suitesparse' || true)
  [ -z "$loaded" ] || die "$1 brings a solver with it: $loaded"
}

# consume NAME PREFIX [DEFINITION…]: configures, builds and runs a project against a prefix.
consume() {
  local name=$1 from=$2
  shift 2
  rm -rf "${work:?}/$name"
  cmake -S "$here/$name" -B "$work/$name" -G Ninja -DCMAKE_PREFIX_PATH="$from" \
    -DCMAKE_C_COMPILER="$CC" -DCMAKE_CXX_COMPILER="$CXX" "$@" >"$work/$name.log" 2>&1 ||
    die "$(cat "$work/$name.log")"
  cmake --build "$work/$name" >"$work/$name.log" 2>&1 || die "$(cat "$work/$name.log")"
  "$work/$name/consumer"
}

# No folder of the repository is on the command line of whoever uses what is installed.
nothing_of_ours() {
  ! grep -F -- "$source/" "$work/$1/compile_commands.json" | grep -vF "$work/$1" |
    grep -E -- "-(I|isystem) ?$source/(core|client|proto|server)" ||
    die "$1: the build tree is on the path"
}

# with_server COMMAND…: starts arapd and runs the command with its address in $address.
with_server() {
  local line status=0
  coproc SERVER { exec "$build/bin/arapd" --listen 127.0.0.1:0 --store memory --no-admin \
    2>"$work/arapd.log"; }
  local pid=$SERVER_PID
  # shellcheck disable=SC2064   # expanded now: the variable is local
  trap "kill $pid 2>/dev/null || true" EXIT
  read -r -t 60 line <&"${SERVER[0]}" || die "arapd does not listen: $(cat "$work/arapd.log")"
  address=${line#arapd listening on }
  "$@" || status=$?
  kill "$pid"
  wait "$pid" || true
  trap - EXIT
  return "$status"
}

readme_example() {
  local folder=$work/readme
  rm -rf "$folder"
  mkdir -p "$folder"
  # What stands between ```cmake and ```, and between ```cpp and ```; the first of each.
  awk '/^```cmake$/ {on = 1; next} /^```$/ {if (on) exit} on' "$source/README.md" \
    >"$folder/CMakeLists.txt"
  awk '/^```cpp$/ {on = 1; next} /^```$/ {if (on) exit} on' "$source/README.md" >"$folder/main.cc"
  grep -q localhost:50051 "$folder/main.cc" || die "README.md: no example in C++ for localhost:50051"
  sed -i "s/localhost:50051/$address/" "$folder/main.cc"
  cmake -S "$folder" -B "$folder/build" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_CXX_COMPILER="$CXX" \
    >"$work/readme.log" 2>&1 || die "$(cat "$work/readme.log")"
  cmake --build "$folder/build" >"$work/readme.log" 2>&1 || die "$(cat "$work/readme.log")"
  "$folder/build/first_shape" | tee "$work/readme.out"
  # A vertex on a line.
  [ "$(grep -cE '^[-0-9.e]+ [-0-9.e]+$' "$work/readme.out")" -eq 4 ] || die "these are not 4 vertices"
}

# Every line of README.md that begins with arapctl, in an empty folder, smaller where it measures; no speed is asked of
# this machine.
shell_examples() {
  local folder=$work/shell
  rm -rf "$folder"
  mkdir -p "$folder"
  awk '/^```sh$/ {on = 1; next} /^```$/ {on = 0} on && /^arapctl /' "$source/README.md" |
    sed -E "s/127.0.0.1:50051/$address/; s/--seconds 10/--seconds 1/; s/--vertices 10000/--vertices 500/; \
      s/p99<20ms/p99<60s/" \
      >"$folder/commands"
  [ "$(wc -l <"$folder/commands")" -ge 10 ] || die "README.md has lost its commands"
  /usr/bin/python3 "$here/figure.py" "$folder/figure.png"
  cd "$folder"
  "$build/bin/arapctl" load --spawn --seconds 0.2 --vertices 100 --json before.json >output 2>log || die "$(cat output log)"
  PATH=$build/bin:$PATH bash -eux commands >output 2>log || die "$(cat output log)"
}

case $part in
  prefix)
    install_to "$prefix" base core client
    install_to "$work/client-prefix" base client
    install_to "$work/core-prefix" base core
    ;;
  headers)
    cd "$prefix/include"
    # Those of C++ have no ending.
    strange=$(grep -rHoE '#include *[<"][^>"]*[.][^>"]*' arap |
      grep -vE '[<"](arap/|tl/expected.hpp$|std(def|int).h$)' || true)
    [ -z "$strange" ] || die "headers that are not public: $strange"
    # shellcheck disable=SC2016   # the other shell expands it
    find arap -name '*.h' | sort | xargs -I{} sh -c \
      'echo "#include <{}>" | "$0" -std=c++20 -Wall -Wextra -Werror -I. -fsyntax-only -x c++ - || exit 255' "$CXX"
    echo '#include <arap/c/arap_c.h>' |
      "$CC" -std=c11 -Wall -Wextra -Wpedantic -Werror -I. -fsyntax-only -x c -
    ;;
  client)
    consume client "$work/client-prefix"
    no_solver "$work/client/consumer"
    nothing_of_ours client
    # What is not there is said.
    ! cmake -S "$here/core" -B "$work/core-missing" -G Ninja -DCMAKE_CXX_COMPILER="$CXX" \
      -DCMAKE_PREFIX_PATH="$work/client-prefix" >"$work/missing.log" 2>&1 || die "core is not installed"
    grep -q 'component core of arap is not in' "$work/missing.log" || die "$(cat "$work/missing.log")"
    ;;
  core)
    consume core "$work/core-prefix"
    nothing_of_ours core
    ! ldd "$work/core/consumer" | grep -E 'grpc|protobuf' || die "the core brings the wire with it"
    ;;
  c)
    consume c "$work/client-prefix"
    no_solver "$work/c/consumer"
    ;;
  pkgconfig)
    export PKG_CONFIG_PATH=$work/client-prefix/lib/pkgconfig
    sanitize=${ARAP_SANITIZE:+-fsanitize=$ARAP_SANITIZE}
    # shellcheck disable=SC2046,SC2086   # lists of words
    "$CXX" -std=c++20 $(pkg-config --cflags arap-client) "$here/client/main.cc" -o "$work/by-pkgconfig" \
      $sanitize $(pkg-config --libs arap-client) -Wl,-rpath,"$work/client-prefix/lib"
    "$work/by-pkgconfig"
    no_solver "$work/by-pkgconfig"
    # shellcheck disable=SC2046
    "$CC" -std=c11 $(pkg-config --cflags arap-c) -c "$here/c/main.c" -o "$work/by-pkgconfig.o"
    # shellcheck disable=SC2046,SC2086
    "$CXX" "$work/by-pkgconfig.o" -o "$work/c-by-pkgconfig" \
      $sanitize $(pkg-config --libs arap-c) -Wl,-rpath,"$work/client-prefix/lib"
    "$work/c-by-pkgconfig"
    ;;
  readme) with_server readme_example ;;
  shell) with_server shell_examples ;;
  *) die "unknown part '$part'" ;;
esac
