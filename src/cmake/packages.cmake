# Debian packages, by `./lab package` or cpack: rlslab (the program), rlslab-bench (the benchmarks), librlslab1 (for
# programs that call C), librlslab-dev (headers, core, what finds them) and python3-rlslab.
set(CPACK_PACKAGE_NAME rlslab)
set(CPACK_PACKAGE_VENDOR "the rlslab authors")
set(RLSLAB_MAINTAINER "the rlslab authors <rlslab@localhost>" CACHE STRING
    "who makes the Debian packages: name <address>")
set(CPACK_PACKAGE_CONTACT ${RLSLAB_MAINTAINER})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Recursive least squares whose digits are measured")
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
    WORLD_READ WORLD_EXECUTE)

# A package is a group of components.
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL ${components})
foreach(component IN LISTS components)
  string(TOUPPER ${component} upper)
  set(CPACK_COMPONENT_${upper}_GROUP dev)
endforeach()
if(TARGET rlslab_program)
  list(APPEND CPACK_COMPONENTS_ALL program)
  set(CPACK_COMPONENT_PROGRAM_GROUP app)
endif()

if(TARGET rlslab_bench)
  list(APPEND CPACK_COMPONENTS_ALL bench)
  set(CPACK_COMPONENT_BENCH_GROUP bench)
endif()
if(TARGET rlslab_c)
  get_target_property(abi rlslab_c SOVERSION)
  set(librlslab librlslab${abi})
  list(APPEND CPACK_COMPONENTS_ALL c library)
  set(CPACK_COMPONENT_C_GROUP dev)
  set(CPACK_COMPONENT_LIBRARY_GROUP shared)
endif()
if(TARGET rlslab_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_COMPONENT_PYTHON_GROUP python)
endif()

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_APP_PACKAGE_NAME rlslab)
set(CPACK_DEBIAN_APP_PACKAGE_SECTION math)
set(CPACK_DEBIAN_APP_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_APP_DESCRIPTION "The program compares the variants of recursive least squares on a record,
in arithmetics from bfloat16 to 257 bits, against a certified reference;
identifies ARX models; and runs the studies that its claims rest on.")

set(CPACK_DEBIAN_BENCH_PACKAGE_NAME rlslab-bench)
set(CPACK_DEBIAN_BENCH_PACKAGE_SECTION math)
set(CPACK_DEBIAN_BENCH_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_BENCH_PACKAGE_SUGGESTS "librlslab-dev (= ${PROJECT_VERSION}), libbenchmark-dev")
set(CPACK_DEBIAN_BENCH_DESCRIPTION "Times an update of every variant of recursive least squares at any size, with
the digits of its answer, and a class of one's own beside them.")

set(CPACK_DEBIAN_SHARED_PACKAGE_NAME "${librlslab}")
set(CPACK_DEBIAN_SHARED_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_SHARED_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
set(CPACK_DEBIAN_SHARED_DESCRIPTION "Recursive least squares behind a C interface: every dense variant in float and
double, guarded, windowed, with a rule of forgetting; fleets. For programs that
are linked with it; its header is in librlslab-dev.")

# Headers need Eigen alone. What only the core and the sparse variants need is recommended: apt installs it unless told
# otherwise.
set(CPACK_DEBIAN_DEV_PACKAGE_NAME librlslab-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libeigen3-dev (>= 3.4)")
if(librlslab)
  string(PREPEND CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "${librlslab} (= ${PROJECT_VERSION}), ")
endif()
set(recommended "")
if(TARGET rlslab_core)
  set(recommended "libboost-dev (>= 1.74), libflint-arb-dev, libflint-dev, libmpfr-dev, libgmp-dev, libfmt-dev (>= 9)")
endif()
if(TARGET rlslab_studies_archive)
  string(APPEND recommended ", libtbb-dev (>= 2021)")
endif()
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS "${recommended}")
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS pandoc)
if(TARGET rlslab_sparse)
  string(APPEND CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS ", libsuitesparse-dev")
endif()
set(CPACK_DEBIAN_DEV_DESCRIPTION "C++20 headers of every textbook variant of recursive least squares, which
need Eigen alone; static libraries: any variant by name in float and double,
or in any arithmetic, the certified reference, and the engine of studies;
rlslab.h for C. Found by CMake (find_package(rlslab)) and pkg-config (rlslab,
rlslab-c, rlslab-native, rlslab-core).")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-rlslab)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.11), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "rlslab, python3-sklearn, python3-pandas, python3-matplotlib")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/python3-rlslab/prerm)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "Recursive least squares in Python: every textbook variant in float32 and
float64, with guards, windows and rules of forgetting, and an estimator for
scikit-learn. The bits are those of the C++ library.")

# Debian wants the licence in every package. The program's is not ours alone where it links SuiteSparse.
file(READ ${PROJECT_SOURCE_DIR}/LICENSE licence)
set(linked_with "")
if(TARGET rlslab_sparse)
  set(linked_with "
/usr/bin/rlslab links SuiteSparse's SPQR and CHOLMOD's Modify module, which are under the GNU General Public License,
version 2 or later (on Debian /usr/share/common-licenses/GPL-2). It as a whole may be passed on under that licence
alone, and so may a program that links the CMake target rlslab::sparse. Nothing else here depends on them.
")
endif()
if(TARGET rlslab_bench AND GSL_LIBRARY)
  string(APPEND linked_with "
/usr/bin/rlslab_bench links the GNU Scientific Library, which is under the GNU General Public License, version 3 or
later (on Debian /usr/share/common-licenses/GPL-3). That program as a whole may be passed on under that licence alone.
")
endif()
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/copyright @ONLY CONTENT "rlslab\n\n@licence@@linked_with@")
string(TIMESTAMP today "%a, %d %b %Y %H:%M:%S +0000" UTC)    # SOURCE_DATE_EPOCH where it is set
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/changelog @ONLY CONTENT "rlslab (@PROJECT_VERSION@) unstable; urgency=medium

  * What changed is in the project's CHANGELOG.md.

 -- @RLSLAB_MAINTAINER@  @today@
")
foreach(package "program;rlslab" "bench;rlslab-bench" "headers;librlslab-dev" "library;${librlslab}"
    "python;python3-rlslab")
  list(GET package 0 component)
  list(GET package 1 name)
  if(component IN_LIST CPACK_COMPONENTS_ALL)
    install(FILES ${PROJECT_BINARY_DIR}/copyright ${PROJECT_BINARY_DIR}/changelog
      DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component})
  endif()
endforeach()

# A result says which revision it is from: a package whose program cannot is refused.
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/known_revision.cmake @ONLY CONTENT "set(SOURCE_DIR \"@PROJECT_SOURCE_DIR@\")
set(REVISION \"@RLSLAB_REVISION@\")
set(REFUSE_UNKNOWN ON)
include(\"@CMAKE_CURRENT_LIST_DIR@/revision.cmake\")
")
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/pack_pages.cmake)
if(TARGET rlslab_program)
  list(PREPEND CPACK_PRE_BUILD_SCRIPTS ${PROJECT_BINARY_DIR}/known_revision.cmake)
endif()
include(CPack)
