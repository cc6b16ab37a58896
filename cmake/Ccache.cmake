# Compiles through ccache when it is there. The base directory makes checkouts in different places
# share what they have compiled; cmake/ccache.sh has the rest.
find_program(ARAP_CCACHE ccache)
if(ARAP_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER sh ${CMAKE_CURRENT_LIST_DIR}/ccache.sh ${CMAKE_SOURCE_DIR} ${ARAP_CCACHE})
endif()
