# What makes building faster.
#
# Precompiled headers: what is slow to parse and never changes while one works. Only headers of other
# people and generated ones: with one of ours in it, every change would build everything again.

# arap_precompile(target HEADER…): parses them once for the target.
function(arap_precompile target)
  list(TRANSFORM ARGN REPLACE "^(.+)$" "<\\1>" OUTPUT_VARIABLE headers)
  target_precompile_headers(${target} PRIVATE ${headers})
  # What depends on the compiler's place or time is not in these headers; ccache may say so.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -fpch-preprocess)
  endif()
endfunction()

# arap_unity(target FILES): compiles so many files as one where each of them makes the same inline code of
# a library again, which costs more than the file itself. Names in their unnamed namespaces must differ.
# ARAP_UNITY=OFF compiles every file by itself, as clang-tidy reads them.
function(arap_unity target files)
  if(ARAP_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${files})
  endif()
endfunction()

set(ARAP_STD_HEADERS
  algorithm array chrono cmath complex cstdint functional map memory mutex optional span string
  string_view utility variant vector)
set(ARAP_CORE_HEADERS ${ARAP_STD_HEADERS} Eigen/Core Eigen/Geometry tl/expected.hpp)
set(ARAP_WIRE_HEADERS ${ARAP_STD_HEADERS} tl/expected.hpp grpcpp/grpcpp.h
  grpcpp/support/server_callback.h
  arap/v1/deformation_service.grpc.pb.h arap/v1/flattening_service.grpc.pb.h
  arap/v1/server_service.grpc.pb.h google/rpc/error_details.pb.h google/rpc/status.pb.h)
