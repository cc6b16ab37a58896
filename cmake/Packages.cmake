# Debian packages, by `cpack -G DEB` in the build tree (script/package): arapd with its service, arapctl,
# and libarap-client-dev with the C++ and C client libraries. They take what is built.
set(packaging ${PROJECT_SOURCE_DIR}/cmake/debian)
include(${packaging}/identity.cmake)

set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
# They stand on Debian 12's libraries.
set(CPACK_DEBIAN_PACKAGE_RELEASE 1~deb12)

# What only a package has, at places of the system: not for `cmake --install`. One component per package.
# arap_package_files(component package): copyright and changelogs.
configure_file(${packaging}/changelog.in ${PROJECT_BINARY_DIR}/changelog.Debian @ONLY)
function(arap_package_files component package)
  set(folder /usr/share/doc/${package})
  install(FILES LICENSE DESTINATION ${folder} RENAME copyright COMPONENT ${component} EXCLUDE_FROM_ALL)
  install(FILES CHANGELOG.md DESTINATION ${folder} RENAME changelog COMPONENT ${component} EXCLUDE_FROM_ALL)
  install(FILES ${PROJECT_BINARY_DIR}/changelog.Debian DESTINATION ${folder}
    COMPONENT ${component} EXCLUDE_FROM_ALL)
endfunction()
arap_package_files(arapd-deb arapd)
arap_package_files(arapctl-deb arapctl)
arap_package_files(client-deb libarap-client-dev)
install(FILES ${packaging}/libarap-client-dev.lintian-overrides DESTINATION /usr/share/lintian/overrides
  RENAME libarap-client-dev COMPONENT client-deb EXCLUDE_FROM_ALL)
install(FILES ${packaging}/arapd.service DESTINATION /lib/systemd/system
  COMPONENT arapd-deb EXCLUDE_FROM_ALL)
install(FILES ${packaging}/arapd.sysusers DESTINATION /usr/lib/sysusers.d RENAME arapd.conf
  COMPONENT arapd-deb EXCLUDE_FROM_ALL)
install(FILES ${packaging}/arapd.toml DESTINATION /etc/arapd COMPONENT arapd-deb EXCLUDE_FROM_ALL)
install(FILES docs/operations.md docker/alerts.yaml docker/grafana-dashboard.json
  DESTINATION /usr/share/doc/arapd COMPONENT arapd-deb EXCLUDE_FROM_ALL)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME arapd)
set(CPACK_PACKAGE_VENDOR "${ARAP_VENDOR}")
set(CPACK_PACKAGE_CONTACT "${ARAP_PACKAGE_MAINTAINER}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_DEBIAN_PACKAGE_HOMEPAGE "${ARAP_HOMEPAGE}")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_PRE_BUILD_SCRIPTS ${packaging}/pack.cmake)
# Files at absolute places go into the package and not onto this machine.
set(CPACK_SET_DESTDIR ON)
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_COMPONENTS_ALL arapd arapd-deb arapctl arapctl-deb base client client-deb)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE gzip)

set(CPACK_DEBIAN_SERVER_PACKAGE_NAME arapd)
set(CPACK_DEBIAN_SERVER_PACKAGE_SECTION net)
set(CPACK_DEBIAN_SERVER_PACKAGE_SHLIBDEPS ON)
# The pthread OpenBLAS makes CHOLMOD's factorisation a fast one.
set(CPACK_DEBIAN_SERVER_PACKAGE_DEPENDS
  "systemd | systemd-standalone-sysusers | systemd-sysusers")
set(CPACK_DEBIAN_SERVER_PACKAGE_RECOMMENDS libopenblas0-pthread)
set(CPACK_DEBIAN_SERVER_PACKAGE_SUGGESTS "arapctl, haproxy, redis-server")
set(CPACK_DEBIAN_SERVER_PACKAGE_CONTROL_EXTRA
  ${packaging}/postinst ${packaging}/prerm ${packaging}/postrm ${packaging}/conffiles)
set(CPACK_COMPONENT_SERVER_DESCRIPTION
"Clients register a mesh, name a few handles on it and stream where they go;
the server streams back the shape, as rigid as possible. Surfaces are laid
flat, true to size. gRPC, with TLS, tokens, quotas, metrics and sessions that
survive.")

set(CPACK_DEBIAN_CONTROL_PACKAGE_NAME arapctl)
set(CPACK_DEBIAN_CONTROL_PACKAGE_SECTION net)
set(CPACK_DEBIAN_CONTROL_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_CONTROL_PACKAGE_SUGGESTS arapd)
set(CPACK_COMPONENT_CONTROL_DESCRIPTION
"This is the command line client of arapd. It bends and flattens meshes in
files of many formats, draws patterns as SVG, DXF and PDF, makes meshes of
images, and measures servers.")

set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libarap-client-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
# gRPC's CMake file asks for its plugin.
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS
  "libgrpc++-dev, libprotobuf-dev, libexpected-dev, libfmt-dev, protobuf-compiler, protobuf-compiler-grpc")
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION
"These are the client libraries of arapd for C++ and C: headers, static
libraries, and what CMake and pkg-config find them by.")

include(CPack)
cpack_add_component_group(server)
cpack_add_component_group(control)
cpack_add_component_group(library)
cpack_add_component(arapd GROUP server)
cpack_add_component(arapd-deb GROUP server)
cpack_add_component(arapctl GROUP control)
cpack_add_component(arapctl-deb GROUP control)
cpack_add_component(base GROUP library)
cpack_add_component(client GROUP library)
cpack_add_component(client-deb GROUP library)
