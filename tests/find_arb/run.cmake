# FindArb in prefixes of each layout, empty files for libraries: cmake -DSOURCE_DIR= -DWORK_DIR= -P run.cmake
function(expect prefix said)
  execute_process(COMMAND ${CMAKE_COMMAND} --fresh -S ${SOURCE_DIR} -B ${WORK_DIR}/build
      -DCMAKE_PREFIX_PATH=${WORK_DIR}/${prefix}
    -DCMAKE_MAKE_PROGRAM=${CMAKE_COMMAND}    # nothing is built
    -DCMAKE_FIND_USE_CMAKE_SYSTEM_PATH=OFF -DCMAKE_FIND_USE_SYSTEM_ENVIRONMENT_PATH=OFF
    RESULT_VARIABLE failed OUTPUT_VARIABLE output ERROR_VARIABLE output)
  string(FIND "${output}" "${said}\n" at)
  if(failed OR at EQUAL -1)
    message(FATAL_ERROR "${prefix}: expected \"${said}\" in\n${output}")
  endif()
endfunction()
function(lay prefix)
  foreach(file IN LISTS ARGN)
    file(WRITE ${WORK_DIR}/${prefix}/${file} "")
  endforeach()
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
lay(flint3 include/flint/arb.h include/flint/flint.h include/mpfr.h include/gmp.h lib/libflint.so lib/libmpfr.so
    lib/libgmp.so)
lay(debian12 include/arb.h include/flint/flint.h include/mpfr.h include/gmp.h
  lib/libflint-arb.so lib/libflint.so lib/libmpfr.so lib/libgmp.so)
lay(arb2 include/arb.h include/flint/flint.h include/mpfr.h include/gmp.h
  lib64/libarb.so lib64/libflint.so lib64/libmpfr.so lib64/libgmp.so)
lay(both include/arb.h include/flint/arb.h lib/libarb.so lib/libflint.so lib/libmpfr.so lib/libgmp.so)
lay(flint2 include/flint/flint.h include/mpfr.h include/gmp.h lib/libflint.so lib/libmpfr.so lib/libgmp.so)
lay(half include/arb.h lib/libflint.so lib/libmpfr.so lib/libgmp.so)

expect(flint3 "found: include lib/libflint.so;lib/libmpfr.so;lib/libgmp.so")
expect(debian12 "found: include lib/libflint-arb.so;lib/libflint.so;lib/libmpfr.so;lib/libgmp.so")
expect(arb2 "found: include lib64/libarb.so;lib64/libflint.so;lib64/libmpfr.so;lib64/libgmp.so")
expect(both "found: include lib/libflint.so;lib/libmpfr.so;lib/libgmp.so")    # as the headers choose
expect(flint2 "not found")
expect(half "not found")
