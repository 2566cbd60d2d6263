# cmake -DBENCH=... -DWORK_DIR=... -P json.cmake: what programs read is JSON or CSV and nothing else; a page that
# cannot be written leaves the one before.
file(REMOVE_RECURSE ${WORK_DIR})
file(MAKE_DIRECTORY ${WORK_DIR})
set(one_row --benchmark_filter=^limit/ --benchmark_min_time=0.001)

function(run name)    # its standard output in ${name}, which must come with exit code 0
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE out ERROR_VARIABLE error RESULT_VARIABLE code)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${ARGN}: ${code}: ${error}")
  endif()
  set(${name} "${out}" PARENT_SCOPE)
endfunction()
function(expect_json text)
  string(JSON rows ERROR_VARIABLE error LENGTH "${text}" benchmarks)
  if(error OR rows LESS 1)
    message(FATAL_ERROR "not JSON alone: ${error}\n${text}")
  endif()
endfunction()

run(json ${BENCH} run ${one_row} --benchmark_format=json)
expect_json("${json}")
string(JSON processor GET "${json}" context cpu)
run(json ${CMAKE_COMMAND} -E env BENCHMARK_FORMAT=json ${BENCH} run ${one_row})
expect_json("${json}")
run(csv ${BENCH} run ${one_row} --benchmark_format=csv)
if(NOT csv MATCHES "^name,")
  message(FATAL_ERROR "not CSV alone:\n${csv}")
endif()
foreach(format "" --benchmark_format=console)
  run(lines ${BENCH} run ${one_row} ${format} --benchmark_out=${WORK_DIR}/run.json)
  if(NOT lines MATCHES "^ +ns/update +digits +finite +ns/theta +longest\nlimit/")
    message(FATAL_ERROR "not our lines:\n${lines}")
  endif()
endforeach()
file(READ ${WORK_DIR}/run.json json)
expect_json("${json}")

# A verb that is none, a file that is not there, a run without the rows that are asked for: no answer.
foreach(words "" nothing "page;${WORK_DIR}/run.json" "limits;${WORK_DIR}/none.json;${WORK_DIR}/none.json"
    "table;${WORK_DIR}/run.json"
    "run;--no_option")
  execute_process(COMMAND ${BENCH} ${words} RESULT_VARIABLE code OUTPUT_QUIET ERROR_VARIABLE error)
  if(NOT code EQUAL 2 OR NOT error)
    message(FATAL_ERROR "${words}: exit code ${code}: ${error}")
  endif()
endforeach()

run(nothing ${BENCH} page ${WORK_DIR}/run.json ${WORK_DIR}/page.html)
file(SIZE ${WORK_DIR}/page.html whole)
execute_process(COMMAND sh -c "ulimit -f 1; exec \"$@\"" sh ${BENCH} page ${WORK_DIR}/run.json ${WORK_DIR}/page.html
  RESULT_VARIABLE code ERROR_VARIABLE error)
file(SIZE ${WORK_DIR}/page.html now)
file(GLOB left RELATIVE ${WORK_DIR} ${WORK_DIR}/*)
if(code EQUAL 0 OR NOT now EQUAL whole OR NOT left STREQUAL "page.html;run.json")
  message(FATAL_ERROR "a page that cannot be written: exit code ${code}, ${now} of ${whole} bytes, ${left}: ${error}")
endif()
