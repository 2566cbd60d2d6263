# Run by cpack on what it is about to pack: manual pages and changelogs lie compressed, without a date.
file(GLOB_RECURSE pages ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/*.1 ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/changelog)
list(FILTER pages INCLUDE REGEX "/man1/|/changelog$")    # not librlslab.so.1
foreach(page IN LISTS pages)
  execute_process(COMMAND gzip -9n ${page} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
