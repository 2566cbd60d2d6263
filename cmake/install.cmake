# What an installation holds: the headers, the core, the program, and a package that find_package(rlslab) finds.
# One export per component, so that a consumer of the headers is never asked for Arb or SuiteSparse.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/rlslab)

# In the tree rlslab/variants is a link: the variants are installed from where they are. The catalogue is not installed.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/rlslab/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/rlslab
  FILES_MATCHING PATTERN "*.hpp" PATTERN doors EXCLUDE PATTERN variants EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/variants/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/rlslab/variants
  FILES_MATCHING PATTERN "*.hpp")
install(TARGETS rlslab_program DESTINATION ${CMAKE_INSTALL_BINDIR})
# A cross-compiled program that cannot run here has written none of these.
set(written ${PROJECT_BINARY_DIR}/program)
install(FILES ${written}/rlslab.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 OPTIONAL)
install(FILES ${written}/rlslab.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME rlslab OPTIONAL)
install(FILES ${written}/_rlslab DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions OPTIONAL)

# A static library does not carry what it calls: whoever links an installed core needs fmt as well.
target_link_libraries(rlslab_core PRIVATE $<INSTALL_INTERFACE:fmt::fmt>)

set(components headers core)
if(TARGET rlslab_sparse)
  list(APPEND components sparse)
endif()
foreach(component IN LISTS components)
  set_target_properties(rlslab_${component} PROPERTIES EXPORT_NAME ${component})
  install(TARGETS rlslab_${component} EXPORT rlslab-${component} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT rlslab-${component} NAMESPACE rlslab:: DESTINATION ${package_dir})
endforeach()

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/rlslabConfig.cmake.in
  ${PROJECT_BINARY_DIR}/rlslabConfig.cmake INSTALL_DESTINATION ${package_dir} NO_SET_AND_CHECK_MACRO)
# Before 1.0 a minor version may change an interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/rlslabConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/rlslabConfig.cmake ${PROJECT_BINARY_DIR}/rlslabConfigVersion.cmake
  ${CMAKE_CURRENT_LIST_DIR}/FindArb.cmake ${CMAKE_CURRENT_LIST_DIR}/FindSuiteSparse.cmake
  DESTINATION ${package_dir})
