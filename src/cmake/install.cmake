# What an installation holds, in components that can be installed apart (cmake --install BUILD --component NAME):
#   headers   the variants and what they stand on; what find_package(rlslab) and pkg-config rlslab find
#   kernels   the compiled kernels of float and double: shorter compilation, the same bits
#   native    every dense variant in float and double by name, compiled: needs no library
#   gpu       fleets on a GPU, where clang 16 made their kernels
#   library   librlslab.so.1, what a program that calls C needs to run
#   c         what it needs to be compiled: rlslab.h, librlslab.so, librlslab.a (rlslab::c, rlslab::c_static)
#   core      the compiled reference, multiprecision, data files
#   catalogue every variant in every arithmetic by name, compiled
#   studies   the engine of studies, for studies of one's own
#   bench     rlslab_bench, and the sources of rlslab_add_bench, which times a class of one's own
#   sparse    where the sparse variants are found (SuiteSparse: GPL-2+)
#   program   rlslab, its manual page and completions
#   python    the Python package (bindings/python/CMakeLists.txt)
#   python_reference   its extension for the certified solution, which needs the core's libraries
# One export per component, so that a consumer of the headers is never asked for Arb or SuiteSparse.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/rlslab)
set(pkgconfig_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# In the tree rlslab/variants, rlslab/fast, rlslab/catalogue and rlslab/studies are links: they are installed from where
# they are.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/rlslab/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/rlslab COMPONENT headers
  FILES_MATCHING PATTERN "*.hpp" PATTERN formats EXCLUDE PATTERN variants EXCLUDE PATTERN fast EXCLUDE
  PATTERN catalogue EXCLUDE PATTERN studies EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/catalogue ${PROJECT_SOURCE_DIR}/variants/fast
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/rlslab COMPONENT headers FILES_MATCHING PATTERN "*.hpp")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/variants DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/rlslab COMPONENT headers
  FILES_MATCHING PATTERN "*.hpp" PATTERN fast EXCLUDE)
if(TARGET rlslab_program)
  install(TARGETS rlslab_program DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
  # A cross-compiled program that cannot run here has written none of these.
  set(written ${PROJECT_BINARY_DIR}/program)
  install(FILES ${written}/rlslab.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program OPTIONAL)
  install(FILES ${written}/rlslab.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME rlslab
    COMPONENT program OPTIONAL)
  install(FILES ${written}/_rlslab DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions COMPONENT program OPTIONAL)
endif()

if(TARGET rlslab_bench)
  install(TARGETS rlslab_bench DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT bench)
  install(FILES ${PROJECT_SOURCE_DIR}/bench/add_bench.cmake DESTINATION ${package_dir} COMPONENT bench)
  foreach(file own_main.cpp run.cpp choice.cpp choice.hpp scenario.cpp scenario.hpp update.cpp rows.hpp
      peer_eigen.cpp peer_mine.cpp)
    install(FILES ${PROJECT_SOURCE_DIR}/bench/${file} DESTINATION ${package_dir}/bench COMPONENT bench)
  endforeach()
endif()

set(components headers)
set(found_by_pkgconfig rlslab)
if(TARGET rlslab_core)
  list(APPEND components kernels native core)
  list(APPEND found_by_pkgconfig rlslab-kernels rlslab-native rlslab-core)
  # A static library does not carry what it calls: whoever links an installed core needs fmt as well.
  target_link_libraries(rlslab_core PRIVATE $<INSTALL_INTERFACE:fmt::fmt>)
endif()
if(TARGET rlslab_catalogue_archive)
  list(APPEND components catalogue)
  list(APPEND found_by_pkgconfig rlslab-catalogue)
endif()
if(TARGET rlslab_studies_archive)
  list(APPEND components studies)
  foreach(header study table interval judgements scenarios checkpoints study_main)
    install(FILES ${PROJECT_SOURCE_DIR}/src/lab/engine/${header}.hpp DESTINATION
        ${CMAKE_INSTALL_INCLUDEDIR}/rlslab/studies COMPONENT studies)
  endforeach()
  install(FILES ${PROJECT_SOURCE_DIR}/src/lab/report/formulas.cmake ${PROJECT_SOURCE_DIR}/src/lab/report/formulas.lua
    DESTINATION ${package_dir} COMPONENT studies)
endif()
foreach(component gpu sparse)
  if(TARGET rlslab_${component})
    list(APPEND components ${component})
  endif()
endforeach()
foreach(component IN LISTS components)
  set(target rlslab_${component})
  if(TARGET ${target}_archive)    # in the tree, objects
    set(target ${target}_archive)
  endif()
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${component})
  install(TARGETS ${target} EXPORT rlslab-${component} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT
      ${component})
  install(EXPORT rlslab-${component} NAMESPACE rlslab:: DESTINATION ${package_dir} COMPONENT ${component})
endforeach()

if(TARGET rlslab_c)
  install(TARGETS rlslab_c rlslab_c_static EXPORT rlslab-c ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT c
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT c)
  install(FILES ${PROJECT_SOURCE_DIR}/bindings/c/rlslab.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT c)
  list(APPEND found_by_pkgconfig rlslab-c)
  install(EXPORT rlslab-c NAMESPACE rlslab:: DESTINATION ${package_dir} COMPONENT c)
endif()

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/rlslabConfig.cmake.in
  ${PROJECT_BINARY_DIR}/rlslabConfig.cmake INSTALL_DESTINATION ${package_dir} NO_SET_AND_CHECK_MACRO)
# Before 1.0 a minor version may change an interface. Headers serve every processor; rlslabConfig.cmake looks whether
# the core does.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/rlslabConfigVersion.cmake COMPATIBILITY SameMinorVersion
    ARCH_INDEPENDENT)
install(FILES
  ${PROJECT_BINARY_DIR}/rlslabConfig.cmake ${PROJECT_BINARY_DIR}/rlslabConfigVersion.cmake
  ${CMAKE_CURRENT_LIST_DIR}/FindArb.cmake ${CMAKE_CURRENT_LIST_DIR}/FindSuiteSparse.cmake
  DESTINATION ${package_dir} COMPONENT headers)

# pkg-config: the same two targets. What the core is linked with has the names that were found here (FLINT 3 has Arb
# inside).
set(core_libraries "")
foreach(part arb flint mpfr gmp)
  if(Arb_${part}_LIBRARY)
    get_filename_component(name ${Arb_${part}_LIBRARY} NAME_WE)
    string(REGEX REPLACE "^lib" " -l" name ${name})
    string(APPEND core_libraries ${name})
  endif()
endforeach()
file(RELATIVE_PATH up /${pkgconfig_dir} /)    # an installation may be moved
string(REGEX REPLACE "/$" "" up "${up}")
foreach(name IN LISTS found_by_pkgconfig)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/${name}.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  set(component headers)
  if(name MATCHES "rlslab-(.*)")
    set(component ${CMAKE_MATCH_1})
  endif()
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${pkgconfig_dir} COMPONENT ${component})
endforeach()

include(${CMAKE_CURRENT_LIST_DIR}/packages.cmake)
