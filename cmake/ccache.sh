#!/bin/sh
# Compiles through ccache: `sh ccache.sh SOURCE_FOLDER CCACHE COMPILER ARGUMENT…`.
export CCACHE_BASEDIR="$1" CCACHE_NOHASHDIR=1 CCACHE_MAXSIZE=10G \
  CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_ctime,include_file_mtime
shift
# Who makes a precompiled header anew must not find the old one: ccache would take it for all that the new
# one is made of, and hand out what another checkout has made of other headers. And what it is made of
# counts byte by byte, not as it is without comments, for g++ knows its headers by their bytes.
before=
for word; do
  case $before:$word in
    -o:*.gch)
      rm -f "$word"
      export CCACHE_DEPEND=1
      ;;
  esac
  before=$word
done
exec "$@"
