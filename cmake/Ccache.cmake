# Compiles through ccache when it is there. The base directory makes checkouts in different places
# share what they have compiled; the sloppiness is what precompiled headers need.
find_program(ARAP_CCACHE ccache)
if(ARAP_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1
    CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_ctime,include_file_mtime
    CCACHE_MAXSIZE=10G ${ARAP_CCACHE})
endif()
