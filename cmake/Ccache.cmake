# Compiles through ccache when it is there.
find_program(ARAP_CCACHE ccache)
if(ARAP_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${ARAP_CCACHE})
endif()
