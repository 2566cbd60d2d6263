# cmake -DWHAT=host|cortex_m -DCOMPILERS=g++,clang++ -DSOURCE_DIR=... -DSYSTEM=... -DWORK_DIR=... -P run.cmake
# Variants of fixed size without exceptions, type information and heap. host: compiled by each compiler, the same bits;
# misuse ends in the program's own function, or at a trap. cortex_m: three processors, emulated, leave the bits of the
# host.
string(REPLACE "," ";" COMPILERS "${COMPILERS}")
string(REPLACE "," ";" SYSTEM "${SYSTEM}")
set(folder ${CMAKE_CURRENT_LIST_DIR})
set(board ${SOURCE_DIR}/docs/examples/microcontroller/board)
set(flags -std=c++20 -O1 -ffp-contract=off -fno-exceptions -fno-rtti -DNDEBUG -Wall -Wextra -Werror -I ${folder} -I
    ${SOURCE_DIR}/src -I ${board})
foreach(path IN LISTS SYSTEM)
  list(APPEND flags -isystem ${path})
endforeach()
file(MAKE_DIRECTORY ${WORK_DIR})
set(of_host ${WORK_DIR}/host.txt)

function(build out)    # build(OUT COMPILER_AND_FLAGS...)
  execute_process(COMMAND ${ARGN} -o ${out} COMMAND_ERROR_IS_FATAL ANY)
endfunction()
function(expect_run said code)    # expect_run(SAID CODE COMMAND...)
  execute_process(COMMAND ${ARGN} INPUT_FILE /dev/null OUTPUT_VARIABLE out ERROR_VARIABLE err RESULT_VARIABLE result
      TIMEOUT 100)
  if(NOT "${out}${err}" STREQUAL "${said}" OR NOT result MATCHES "^(${code})$")
    message(FATAL_ERROR "${ARGN}: '${out}${err}' and ${result}, not '${said}' and ${code}")
  endif()
endfunction()
set(refused "expected size equal to the filter's fixed size\n")

if(WHAT STREQUAL host)
  set(first "")
  foreach(compiler IN LISTS COMPILERS)
    build(${WORK_DIR}/digest ${compiler} ${flags} ${folder}/digest.cpp ${board}/host.cpp)
    execute_process(COMMAND ${WORK_DIR}/digest OUTPUT_VARIABLE digest COMMAND_ERROR_IS_FATAL ANY)
    if(NOT digest MATCHES "\nud float 5 " OR NOT digest MATCHES "\nqr_block double 10 "
        OR NOT digest MATCHES "\nud complex float 5 " OR NOT digest MATCHES "ud guarded 5 ")
      message(FATAL_ERROR "not every variant is there:\n${digest}")
    elseif(first AND NOT digest STREQUAL first)
      message(FATAL_ERROR "${compiler} computes other bits:\n${first}\n${digest}")
    endif()
    set(first "${digest}")
    build(${WORK_DIR}/misuse.o ${compiler} ${flags} -c ${folder}/misuse.cpp)
    build(${WORK_DIR}/misuse ${compiler} ${flags} ${WORK_DIR}/misuse.o ${folder}/on_misuse.cpp ${board}/host.cpp)
    expect_run("${refused}" 3 ${WORK_DIR}/misuse)
    build(${WORK_DIR}/misuse ${compiler} ${flags} ${WORK_DIR}/misuse.o ${board}/host.cpp)
    expect_run("" "Illegal instruction|Subprocess aborted|[^0-9].*" ${WORK_DIR}/misuse)
  endforeach()
  file(WRITE ${of_host} "${first}")
  return()
endif()

find_program(compiler arm-none-eabi-g++)
find_program(emulator qemu-system-arm)
execute_process(COMMAND ${CMAKE_COMMAND} -E echo "#include <optional>" OUTPUT_FILE ${WORK_DIR}/library.cpp)
set(library 1)
if(compiler)
  execute_process(COMMAND ${compiler} -fsyntax-only ${WORK_DIR}/library.cpp RESULT_VARIABLE library ERROR_QUIET)
endif()
if(library OR NOT emulator)
  message("skipped: needs the packages gcc-arm-none-eabi, libstdc++-arm-none-eabi-newlib and "
        "qemu-system-arm (./lab embedded)")
  return()
endif()
file(READ ${of_host} expected)
foreach(processor
    "mps2-an385;-mcpu=cortex-m3"                                               # no floating point: in software
    "mps2-an386;-mcpu=cortex-m4;-mfloat-abi=hard;-mfpu=fpv4-sp-d16"            # single precision
    "mps2-an500;-mcpu=cortex-m7;-mfloat-abi=hard;-mfpu=fpv5-d16")              # single and double
  list(POP_FRONT processor machine)
  set(compile ${compiler} ${flags} -mthumb ${processor} -fno-threadsafe-statics -ffunction-sections -fdata-sections
      ${board}/cortex_m.cpp
    --specs=nano.specs -nostartfiles -T ${board}/mps2.ld -Wl,--gc-sections)
  set(run ${emulator} -M ${machine} -nographic -semihosting-config enable=on,target=native -kernel ${WORK_DIR}/app.elf)
  build(${WORK_DIR}/app.elf ${compile} ${folder}/digest.cpp)
  expect_run("${expected}" 0 ${run})
  message(STATUS "${machine}: the host's bits")
  build(${WORK_DIR}/app.elf ${compile} ${folder}/misuse.cpp ${folder}/on_misuse.cpp)
  expect_run("${refused}" 3 ${run})
  build(${WORK_DIR}/app.elf ${compile} ${folder}/misuse.cpp)
  expect_run("fault\n" 99 ${run})
endforeach()

# That there is no heap is what the linker says: a program that asks for memory is refused.
execute_process(COMMAND ${compile} ${folder}/heap.cpp -o ${WORK_DIR}/heap.elf RESULT_VARIABLE linked ERROR_VARIABLE
    said)
if(linked EQUAL 0 OR NOT said MATCHES "_sbrk")
  message(FATAL_ERROR "a program with a heap was linked: ${said}")
endif()
# That the bits are compared: with products and sums contracted they are others.
list(TRANSFORM compile REPLACE "^-ffp-contract=off$" "-ffp-contract=fast;-fexpensive-optimizations")
build(${WORK_DIR}/app.elf ${compile} ${folder}/digest.cpp)
execute_process(COMMAND ${run} INPUT_FILE /dev/null OUTPUT_VARIABLE out ERROR_VARIABLE err)
if("${out}${err}" STREQUAL "${expected}")
  message(FATAL_ERROR "contracted operations leave the same bits: nothing was compared")
endif()
