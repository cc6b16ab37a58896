# arap_target_options(target): our warnings, sanitizers and floating-point rules, per target, so that
# nothing leaks into generated code or into whoever links us.
function(arap_target_options target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  # No fused multiply-add: the same input gives the same bytes on every CPU of a kind.
  target_compile_options(${target} PRIVATE -ffp-contract=off)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wnon-virtual-dtor
    -Wold-style-cast -Woverloaded-virtual -Wcast-align)
  # g++ 12 sees overruns in inlined string and vector code where there are none (its bugs 105329, 105651);
  # the sanitizers look for real ones.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE
      -Wno-array-bounds -Wno-restrict -Wno-stringop-overflow -Wno-stringop-overread)
  endif()
  # "GCC ivdep" is for g++, which vectorises what is measured.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    target_compile_options(${target} PRIVATE -Wno-unknown-pragmas)
  endif()
  if(ARAP_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  arap_sanitize(${target})
endfunction()

# arap_sanitize(target): instruments generated code too; a sanitizer has to see the whole program.
function(arap_sanitize target)
  if("thread" IN_LIST ARAP_SANITIZE AND "address" IN_LIST ARAP_SANITIZE)
    message(FATAL_ERROR "ARAP_SANITIZE: thread and address cannot be combined")
  endif()
  foreach(sanitizer IN LISTS ARAP_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${sanitizer} -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${sanitizer})
    if(sanitizer STREQUAL "undefined")
      target_compile_options(${target} PRIVATE -fno-sanitize-recover=undefined)
    endif()
  endforeach()
endfunction()
