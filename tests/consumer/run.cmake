# cmake -DSOURCE_DIR=... -DBUILD_DIR=... -DWORK_DIR=... -P run.cmake
# Installs a built tree, then configures, builds and runs the consumer beside this file against the installation.
foreach(argument SOURCE_DIR BUILD_DIR WORK_DIR)
  if(NOT IS_ABSOLUTE "${${argument}}")
    message(FATAL_ERROR "${argument} must be an absolute path, not '${${argument}}'")
  endif()
endforeach()
file(REMOVE_RECURSE ${WORK_DIR})
file(MAKE_DIRECTORY ${WORK_DIR})

function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/first_prefix)
# An installation may be packed and moved: it must point neither at itself nor back at the tree it came from.
set(prefix ${WORK_DIR}/prefix)
file(RENAME ${WORK_DIR}/first_prefix ${prefix})
foreach(file bin/rlslab share/man/man1/rlslab.1 share/bash-completion/completions/rlslab
    share/zsh/site-functions/_rlslab)
  if(NOT EXISTS ${prefix}/${file})
    message(FATAL_ERROR "${file} is not installed")
  endif()
endforeach()
file(GLOB_RECURSE package_files ${prefix}/*.cmake)
foreach(file IN LISTS package_files)
  file(READ ${file} text)
  foreach(place ${SOURCE_DIR} ${BUILD_DIR} ${WORK_DIR}/first_prefix)
    string(FIND "${text}" "${place}" at)
    if(NOT at EQUAL -1)
      message(FATAL_ERROR "${file} names ${place}")
    endif()
  endforeach()
endforeach()

# The compiler of the tree, so that the two agree on the standard library.
file(STRINGS ${BUILD_DIR}/CMakeCache.txt compiler REGEX "^CMAKE_CXX_COMPILER:")
string(REGEX REPLACE "^[^=]*=" "" compiler "${compiler}")
run(${CMAKE_COMMAND} -G Ninja -S ${CMAKE_CURRENT_LIST_DIR} -B ${WORK_DIR}/build
  -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_CXX_COMPILER=${compiler} -DCMAKE_BUILD_TYPE=Debug)
run(${CMAKE_COMMAND} --build ${WORK_DIR}/build -j 2)
run(${WORK_DIR}/build/with_headers)
run(${WORK_DIR}/build/with_kernels)
run(${WORK_DIR}/build/with_core)
run(${WORK_DIR}/build/with_native)
run(${WORK_DIR}/build/with_catalogue)
if(EXISTS ${BUILD_DIR}/librlslab_gpu.a)    # where clang 16 is
  run(${WORK_DIR}/build/with_gpu)
endif()

# An app may be compiled for another instruction set than the core. What this machine cannot run is compiled at least.
file(STRINGS /proc/cpuinfo processor REGEX "^flags" LIMIT_COUNT 1)
foreach(set baseline native avx avx2 avx512f)
  if(EXISTS ${WORK_DIR}/build/owning_${set} AND (set MATCHES "baseline|native" OR processor MATCHES " ${set} "))
    message(STATUS "owning_${set}")
    run(${WORK_DIR}/build/owning_${set})
  endif()
endforeach()

# Of a function that the core (or the native layer) and the app both compile, the linker keeps one: there, none may be
# Eigen's over types that Eigen aligns (options 0) as the instruction set would have it.
file(STRINGS ${BUILD_DIR}/CMakeCache.txt nm REGEX "^CMAKE_NM:")
string(REGEX REPLACE "^[^=]*=" "" nm "${nm}")
file(GLOB_RECURSE core ${prefix}/librlslab_core.a ${prefix}/librlslab_native.a)
execute_process(COMMAND ${nm} -C --defined-only ${core} OUTPUT_VARIABLE symbols ERROR_QUIET COMMAND_ERROR_IS_FATAL ANY)
set(aligned "Eigen::(Matrix<[^\n]*, [-0-9]+, [-0-9]+, 0, |internal::(conditional_|handmade_)?aligned_)")
string(REGEX MATCHALL "[^\n]* [WVu] [^\n]*${aligned}[^\n]*" shared "${symbols}")
if(shared)
  list(JOIN shared "\n" shared)
  message(FATAL_ERROR "the compiled libraries share with apps:\n${shared}")
endif()
