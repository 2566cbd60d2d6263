# SuiteSparse 5 ships no CMake config on Debian 12. Components: CHOLMOD, SPQR; targets SuiteSparse::NAME.
include(FindPackageHandleStandardArgs)
find_path(SuiteSparse_INCLUDE_DIR SuiteSparse_config.h PATH_SUFFIXES suitesparse)
set(required SuiteSparse_INCLUDE_DIR)
foreach(component IN LISTS SuiteSparse_FIND_COMPONENTS)
  string(TOLOWER ${component} name)
  find_library(SuiteSparse_${component}_LIBRARY ${name})
  list(APPEND required SuiteSparse_${component}_LIBRARY)
  if(SuiteSparse_${component}_LIBRARY AND NOT TARGET SuiteSparse::${component})
    add_library(SuiteSparse::${component} UNKNOWN IMPORTED)
    set_target_properties(SuiteSparse::${component} PROPERTIES
      IMPORTED_LOCATION ${SuiteSparse_${component}_LIBRARY}
      INTERFACE_INCLUDE_DIRECTORIES ${SuiteSparse_INCLUDE_DIR})
  endif()
endforeach()
find_package_handle_standard_args(SuiteSparse REQUIRED_VARS ${required})
