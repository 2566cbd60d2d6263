# What own_study.cmake and own_bench.cmake share: an installation in WORK_DIR/prefix of the COMPONENTS, and
# own(CODE ARGUMENT...), which runs ${program}; what it prints is in `out` and `err`.
file(REMOVE_RECURSE ${WORK_DIR})
file(MAKE_DIRECTORY ${WORK_DIR})
foreach(component IN LISTS COMPONENTS)
  execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD_DIR} --component ${component} --prefix ${WORK_DIR}/prefix
    OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
endforeach()
function(own code)
  execute_process(COMMAND ${program} ${ARGN} WORKING_DIRECTORY ${WORK_DIR} INPUT_FILE /dev/null
    OUTPUT_VARIABLE out ERROR_VARIABLE err RESULT_VARIABLE was)
  if(NOT was EQUAL code)
    message(FATAL_ERROR "${program} ${ARGN}: exit code ${was}, expected ${code}\n${out}${err}")
  endif()
  set(out "${out}" PARENT_SCOPE)
  set(err "${err}" PARENT_SCOPE)
endfunction()
