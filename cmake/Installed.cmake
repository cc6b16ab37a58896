# What is installed of the libraries: static archives, or with BUILD_SHARED_LIBS shared ones, with their
# headers, CMake files and pkg-config files. Components: base, core (needs base), client (needs base).
#
# The programs, tests and rooms of this tree are always linked with the static archives. A shared library
# is made of the same objects; the version script in cmake/exports says what it shows.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
# "cmake --install" takes what is built and does not ask for the rest.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)
if(BUILD_SHARED_LIBS)
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
endif()
set(ARAP_CMAKE_FOLDER ${CMAKE_INSTALL_LIBDIR}/cmake/arap)
# Before 1.0 a minor version may change the interface.
set(ARAP_SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})

# arap_installed(room [COMPONENT component] [HEADERS folder…] [OBJECTS target…] [LINKS library…] [PRIVATE_LINKS library…]):
# the target arap_<room> is installed as arap::<room>. OBJECTS are what a shared library is made of; without
# them there is none. LINKS are what a consumer links with it; for a room of ours, arap_<room>.
function(arap_installed room)
  cmake_parse_arguments(ARG "" "COMPONENT" "HEADERS;OBJECTS;LINKS;PRIVATE_LINKS" ${ARGN})
  set(component ${ARG_COMPONENT})
  if(NOT component)
    set(component ${room})
  endif()
  set(installed arap_${room})
  if(BUILD_SHARED_LIBS)
    if(NOT ARG_OBJECTS)
      return()
    endif()
    set(installed arap_${room}_shared)
    list(TRANSFORM ARG_OBJECTS REPLACE "^(.+)$" "$<TARGET_OBJECTS:\\1>" OUTPUT_VARIABLE objects)
    list(TRANSFORM ARG_LINKS REPLACE "^(arap_.+)$" "\\1_shared")
    list(TRANSFORM ARG_PRIVATE_LINKS REPLACE "^(arap_.+)$" "\\1_shared")
    add_library(${installed} SHARED ${objects})
    target_compile_features(${installed} INTERFACE cxx_std_20)
    target_link_libraries(${installed} PUBLIC ${ARG_LINKS} PRIVATE ${ARG_PRIVATE_LINKS})
    set(script ${PROJECT_SOURCE_DIR}/cmake/exports/${room}.map)
    target_link_options(${installed} PRIVATE -Wl,--version-script=${script} -Wl,--no-undefined)
    set_target_properties(${installed} PROPERTIES
      OUTPUT_NAME arap_${room} LINKER_LANGUAGE CXX LINK_DEPENDS ${script} INSTALL_RPATH $ORIGIN
      VERSION ${PROJECT_VERSION} SOVERSION ${ARAP_SOVERSION})
  endif()
  set_target_properties(${installed} PROPERTIES EXPORT_NAME ${room})
  install(TARGETS ${installed} EXPORT arap-${component}
    LIBRARY COMPONENT ${component} NAMELINK_COMPONENT ${component}
    ARCHIVE COMPONENT ${component}
    INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  if(ARG_HEADERS)
    install(DIRECTORY ${ARG_HEADERS} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/arap
      COMPONENT ${component} FILES_MATCHING PATTERN "*.h")
  endif()
endfunction()

# arap_pkg_config(name component description SHARED library… STATIC library… [NEEDS package…]): a file for
# pkg-config. What NEEDS names is linked with archives; a shared library brings it by itself.
function(arap_pkg_config name component description)
  cmake_parse_arguments(ARG "" "" "SHARED;STATIC;NEEDS" ${ARGN})
  set(requires)
  if(BUILD_SHARED_LIBS)
    list(TRANSFORM ARG_SHARED PREPEND -l OUTPUT_VARIABLE libs)
  else()
    list(TRANSFORM ARG_STATIC PREPEND -l OUTPUT_VARIABLE libs)
    list(JOIN ARG_NEEDS " " requires)
  endif()
  list(JOIN libs " " libs)
  # Found from where the file lies, so that the prefix can be moved.
  file(RELATIVE_PATH up /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/library.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
    COMPONENT ${component})
endfunction()

# The files by which CMake and pkg-config find what is installed.
function(arap_install_package)
  set(components base core)
  if(NOT ARAP_CORE_ONLY)
    list(APPEND components client)
    arap_pkg_config(arap-client client "The C++ client library of arapd"
      SHARED arap_client arap_base STATIC arap_client arap_wire arap_proto arap_base
      NEEDS grpc++ protobuf fmt)
    arap_pkg_config(arap-c client "The client library of arapd for C"
      SHARED arap_c STATIC arap_c NEEDS arap-client)
  endif()
  foreach(component IN LISTS components)
    install(EXPORT arap-${component} NAMESPACE arap:: DESTINATION ${ARAP_CMAKE_FOLDER}
      FILE arap-${component}.cmake COMPONENT ${component})
  endforeach()
  configure_package_config_file(cmake/arap-config.cmake.in ${PROJECT_BINARY_DIR}/arap-config.cmake
    INSTALL_DESTINATION ${ARAP_CMAKE_FOLDER} NO_SET_AND_CHECK_MACRO)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/arap-config-version.cmake
    COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/arap-config.cmake ${PROJECT_BINARY_DIR}/arap-config-version.cmake
    DESTINATION ${ARAP_CMAKE_FOLDER} COMPONENT base)
  install(FILES cmake/FindCHOLMOD.cmake DESTINATION ${ARAP_CMAKE_FOLDER} COMPONENT core)
endfunction()
