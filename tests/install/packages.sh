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
for package in "$server" "$control" "$library"; do
  says "$package" Version '^[0-9]+\.[0-9]+\.[0-9]+-1~deb12 ?$'
  says "$package" Maintainer '^[^<>]+ <[^<> ]+@[^<> ]+> ?$'
  says "$package" Description '^[^ ].* .+'
  # An address of somebody else, or of nobody who says so.
  ! dpkg-deb -f "$package" Maintainer | grep -E '@example\.(com|org|net)' || die "$package is from a placeholder"
  name=$(dpkg-deb -f "$package" Package)
  holds "$package" "usr/share/doc/$name/copyright" "usr/share/doc/$name/changelog.gz" \
    "usr/share/doc/$name/changelog.Debian.gz"
done
for package in "$control" "$library"; do
  ! dpkg-deb -f "$package" Depends | grep -E 'cholmod|openblas' || die "$package brings a solver"
done
holds "$server" usr/bin/arapd lib/systemd/system/arapd.service etc/arapd/arapd.toml \
  usr/lib/sysusers.d/arapd.conf usr/share/doc/arapd/operations.md usr/share/man/man1/arapd.1.gz
holds "$control" usr/bin/arapctl usr/share/man/man1/arapctl.1.gz usr/share/man/man1/arapctl-bake.1.gz \
  usr/share/bash-completion/completions/arapctl usr/share/zsh/vendor-completions/_arapctl \
  usr/share/fish/vendor_completions.d/arapctl.fish
holds "$library" usr/include/arap/client/client.h usr/include/arap/c/arap_c.h \
  'usr/lib/([^ ]*/)?cmake/arap/arap-config.cmake' 'usr/lib/([^ ]*/)?pkgconfig/arap-client.pc'
dpkg-deb --ctrl-tarfile "$server" | tar -xO ./conffiles | grep -qx /etc/arapd/arapd.toml ||
  die "the configuration is no conffile"

# What Debian's own judge calls an error or a warning.
if command -v lintian >/dev/null; then
  lintian --allow-root --fail-on error,warning --tag-display-limit 0 "$server" "$control" "$library" \
    >"$work/lintian" 2>&1 || die "$(cat "$work/lintian")"
fi

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
# One finds the other beside itself.
"$root/usr/bin/arapctl" info --spawn >"$work/info" 2>&1 || die "$(cat "$work/info")"
grep -q '^max_vertices' "$work/info" || die "arapctl info says something else: $(cat "$work/info")"
# shellcheck disable=SC1091   # made by the package
(. "$root/usr/share/bash-completion/completions/arapctl" && complete -p arapctl >/dev/null) || die "bash completes nothing"
if command -v man >/dev/null; then
  for page in arapd arapctl arapctl-bake; do
    man --warnings -l "$root/usr/share/man/man1/$page.1.gz" >"$work/page" 2>"$work/page.err"
    grep -q '^NAME' "$work/page" || die "there is no page $page"
    [ ! -s "$work/page.err" ] || die "$page: $(cat "$work/page.err")"
  done
fi
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
