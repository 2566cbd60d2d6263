# cmake -DBUILD_DIR=... -DFOLDER=... -DCOMPILER=... -DWORK_DIR=... -P own_bench.cmake
# A class of one's own, timed by a program that is built against an installation: its table, its CSV, what it refuses.
cmake_minimum_required(VERSION 3.25)
set(COMPONENTS headers kernels native core bench)
include(${CMAKE_CURRENT_LIST_DIR}/own.cmake)
# Not optimised: its times are not looked at.
execute_process(COMMAND ${CMAKE_COMMAND} -G Ninja -S ${FOLDER} -B ${WORK_DIR}/build -DCMAKE_BUILD_TYPE=Debug
    -DCMAKE_CXX_FLAGS_DEBUG=-O0
  -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix -DCMAKE_CXX_COMPILER=${COMPILER} COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK_DIR}/build COMMAND_ERROR_IS_FATAL ANY)

function(expect where text)
  if(NOT where MATCHES "${text}")
    message(FATAL_ERROR "expected '${text}' in\n${where}")
  endif()
endfunction()
set(program ${WORK_DIR}/build/own_bench)
set(short --benchmark_min_time=0.001 --sizes 3,5)

own(0 ${short} --csv times.csv --benchmark_filter=textbook|/ud/)
expect("${out}" "\n3 parameters +ns +p50 +p99 +largest +rows/s +digits\n  ud ")
expect("${out}" "\n5 parameters +ns +p50 +p99 +largest +rows/s +digits\n  ud ")
expect("${out}" "\n  textbook +[0-9]+ +[0-9]+ +[0-9]+ +[0-9]+ +[0-9.e+-]+ +1[0-9]\\.[0-9]\n")
string(REGEX MATCHALL "[^\n]+" lines "${out}")
foreach(line IN LISTS lines)
  string(LENGTH "${line}" length)
  if(length GREATER 80)
    message(FATAL_ERROR "wider than a terminal: ${line}")
  endif()
endforeach()
file(READ ${WORK_DIR}/times.csv csv)
expect("${csv}"
  "^# .*\nparameters,arithmetic,name,ns,theta,p50,p99,largest,rows_per_second_99_99,digits,finite\n3,double,ud,")
expect("${csv}" "\n5,double,textbook,[0-9.]+,[0-9.]+,[0-9.]+,[0-9.]+,[0-9]+,[0-9]+,1[0-9.]+,1\n")
own(0 ${short} --float --benchmark_filter=textbook|/ud/)
expect("${out}" "  ud, float ")
own(2 --sizes)
expect("${err}" "--sizes: expected a value\n$")
own(2 --csv --sizes=4)
own(2 --csv=)
own(2 ${short} --csv . --benchmark_filter=/ud/)
own(2 --sizes 0)
expect("${err}" "--sizes 0: expected whole numbers from 1 to 512, as in 5,12\n$")
own(2 ${short} --csv nowhere/times.csv --benchmark_filter=/ud/)
expect("${err}" "nowhere/times.csv")
own(2 ${short} --benchmark_filter=none)
# The installed program has the variants of fixed size, too.
set(program ${WORK_DIR}/prefix/bin/rlslab_bench)
own(0 run --fixed --sizes 4 --benchmark_min_time=0.001
  --benchmark_filter=/ud/|by_hand)
expect("${out}" "\n4 parameters .*\n  by_hand_ud ")
