# Builds the project beside this file against the client library and looks at what it got with it:
# directories of installed headers, and no solver.
#   SOURCE, WORK        this folder, and a folder for the build
#   ROOT, BUILD         the repository, and its build tree
#   COMPILER            as for the library
function(run)
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE output ERROR_VARIABLE output
                  RESULT_VARIABLE result TIMEOUT 300)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}: ${result}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK} -G Ninja
    -DARAP_TARGETS=${BUILD}/arap-client.cmake -DARAP_README=${ROOT}/README.md
    -DCMAKE_CXX_COMPILER=${COMPILER})
run(${CMAKE_COMMAND} --build ${WORK})
run(${WORK}/consumer)

run(ldd ${WORK}/consumer)
if(output MATCHES "[^\n]*(cholmod|openblas|lapack|suitesparse)[^\n]*")
  message(FATAL_ERROR "the client library brings a solver with it:${CMAKE_MATCH_0}")
endif()

file(READ ${WORK}/compile_commands.json commands)
string(REGEX MATCHALL "(-I|-isystem) *[^ \"]+" paths "${commands}")
foreach(path IN LISTS paths)
  string(REGEX REPLACE "^(-I|-isystem) *" "" path "${path}")
  string(FIND "${path}" "${ROOT}" ours)
  if(ours EQUAL 0 AND NOT path MATCHES "/include$")
    message(FATAL_ERROR "the client library puts more than headers on the path: ${path}")
  endif()
endforeach()
if(NOT commands MATCHES "client/include")
  message(FATAL_ERROR "the client library's own headers are not on the path:\n${commands}")
endif()
