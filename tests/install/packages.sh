#!/usr/bin/env bash
# The Debian packages of what is built: what they say, what they hold, and how they come and go in an empty
# system. Ends with 77 where dpkg-deb or cpack is not there.
#
# Usage: packages.sh BUILD WORK
#   BUILD  the build tree;  WORK  a folder for all that is made
set -euo pipefail
build=$1 work=$2
root=$work/root

die() {
  printf '%s\n' "$*" >&2
  exit 1
}

command -v cpack >/dev/null && command -v dpkg-deb >/dev/null && command -v dpkg-shlibdeps >/dev/null ||
  exit 77
rm -rf "$work"
mkdir -p "$work"
(cd "$build" && cpack -G DEB -B "$work") >"$work/cpack.log" 2>&1 || die "$(cat "$work/cpack.log")"
server=$(echo "$work"/arapd_*.deb)
control=$(echo "$work"/arapctl_*.deb)
library=$(echo "$work"/libarap-client-dev_*.deb)

# says PACKAGE FIELD REGEX
says() {
  dpkg-deb -f "$1" "$2" | tr '\n' ' ' | grep -qE -- "$3" || die "$1: $2 is not $3: $(dpkg-deb -f "$1" "$2")"
}
# holds PACKAGE PATH…: as files of root
holds() {
  local package=$1 path
  shift
  dpkg-deb -c "$package" >"$work/contents"
  for path in "$@"; do
    grep -qE -- "^-[rwx-]+ root/root .* \./$path\$" "$work/contents" ||
      die "$package has no $path: $(cat "$work/contents")"
  done
}

says "$server" Depends 'libgrpc\+\+.*systemd-sysusers|systemd-sysusers.*libgrpc\+\+'
says "$server" Depends libcholmod
says "$control" Depends 'libpng'
says "$control" Depends 'libprotobuf'
says "$library" Depends 'libgrpc\+\+-dev'
# arapctl and the client library know no solver.
for package in "$control" "$library"; do
  ! dpkg-deb -f "$package" Depends | grep -E 'cholmod|openblas' || die "$package brings a solver"
done
holds "$server" usr/bin/arapd lib/systemd/system/arapd.service etc/arapd/arapd.toml \
  usr/lib/sysusers.d/arapd.conf usr/share/doc/arapd/copyright
holds "$control" usr/bin/arapctl usr/share/doc/arapctl/copyright usr/share/man/man1/arapctl-bake.1 \
  usr/share/bash-completion/completions/arapctl usr/share/zsh/vendor-completions/_arapctl
holds "$library" usr/include/arap/client/client.h usr/include/arap/c/arap_c.h \
  'usr/lib/([^ ]*/)?cmake/arap/arap-config.cmake' 'usr/lib/([^ ]*/)?pkgconfig/arap-client.pc'
dpkg-deb --ctrl-tarfile "$server" | tar -xO ./conffiles | grep -qx /etc/arapd/arapd.toml ||
  die "the configuration is no conffile"

# Only root installs, and the user is made by a part of systemd; elsewhere what is inside runs at least.
installs=false
if [ "$(id -u)" -eq 0 ] && command -v systemd-sysusers >/dev/null; then installs=true; fi
if ! $installs; then
  for package in "$server" "$control"; do dpkg-deb -x "$package" "$root"; done
else
  mkdir -p "$root"/var/lib/dpkg/{info,updates} "$root/etc"
  : >"$root/var/lib/dpkg/status"
  : >"$root/var/lib/dpkg/available"
  in_root() {
    dpkg --root="$root" --force-script-chrootless --force-depends --log="$work/dpkg.log" "$@" \
      >"$work/dpkg.out" 2>&1 || die "$(cat "$work/dpkg.out")"
  }
  in_root --install "$server" "$control"
  grep -q '^arapd:' "$root/etc/passwd" || die "there is no user arapd"
  # What an administrator has changed stays.
  echo '# mine' >>"$root/etc/arapd/arapd.toml"
  in_root --install "$server"
  grep -q '^# mine' "$root/etc/arapd/arapd.toml" || die "the configuration is gone"
fi

"$root/usr/bin/arapd" --version
"$root/usr/bin/arapctl" --version
STATE_DIRECTORY=$work/state "$root/usr/bin/arapd" --config "$root/etc/arapd/arapd.toml" --check-config
if command -v systemd-analyze >/dev/null; then
  sed "s#/usr/bin/arapd#$root/usr/bin/arapd#" "$root/lib/systemd/system/arapd.service" >"$work/arapd.service"
  systemd-analyze verify "$work/arapd.service" 2>"$work/verify" || die "$(cat "$work/verify")"
  ! grep -F arapd.service "$work/verify" || die "the unit is not as it should be"
fi

if $installs; then
  mkdir -p "$root/var/lib/arapd"
  in_root --remove arapd
  [ -e "$root/etc/arapd/arapd.toml" ] || die "a removal keeps the configuration"
  [ -d "$root/var/lib/arapd" ] || die "a removal keeps the sessions"
  in_root --purge arapd arapctl
  for path in etc/arapd var/lib/arapd usr/bin/arapd usr/bin/arapctl; do
    [ ! -e "$root/$path" ] || die "a purge leaves $path"
  done
fi
