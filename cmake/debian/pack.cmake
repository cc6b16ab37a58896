# Run by CPack before it makes packages of what is staged: manuals and changelogs are packed, as Debian wants them.
file(GLOB_RECURSE texts ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/*)
list(FILTER texts INCLUDE REGEX "/share/(man/.*\\.[1-9]|doc/.*/changelog(\\.Debian)?)$")
foreach(text IN LISTS texts)
  execute_process(COMMAND gzip -9nf ${text} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
