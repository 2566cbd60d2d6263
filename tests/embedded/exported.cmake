# cmake -DHEADERS=... -DSOURCE_DIR=... -DWORK_DIR=... -P exported.cmake
# Exported filters in C: Cortex-M3, M4F and M7 and, where its compiler is, RISC-V without floating point, emulated,
# leave the bits of the host.
set(folder ${CMAKE_CURRENT_LIST_DIR})
set(board ${SOURCE_DIR}/docs/examples/microcontroller/board)
set(strict -std=c99 -pedantic -Wall -Wextra -Werror -I ${board})
file(MAKE_DIRECTORY ${WORK_DIR})

set(program "#include <stdio.h>\n")
set(calls "")
foreach(filter ud.float ud.double ud_delta.float carlson.float carlson.double gentleman.double symmetric.float
    joseph_rank_two.float conventional.float)
  string(REPLACE "." ";" parts ${filter})
  list(GET parts 0 variant)
  list(GET parts 1 number)
  string(REPLACE "." "_" name ${filter})
  string(TOUPPER ${name} upper)
  execute_process(COMMAND ${HEADERS} ${variant} 4 ${number} ${name} OUTPUT_FILE ${WORK_DIR}/${name}.h
      COMMAND_ERROR_IS_FATAL ANY)
  string(APPEND program "#include \"${name}.h\"\n")
  string(APPEND calls "    say(\"${name}\", run_${name}(ROWS, 1));\n")
  list(APPEND runs "DEFINE_RUN(${name}, ${upper}, ${number}, 4)")
endforeach()
list(JOIN runs "\n" runs)
# No printf: a board's may want a heap.
file(WRITE ${WORK_DIR}/exported.c "${program}#include \"${folder}/exported.h\"
#define ROWS 400
#include <board.h>
static void say(const char *name, uint64_t digest) {
    char hex[19] = \" \";
    int i;
    for (i = 0; i < 16; ++i) hex[1 + i] = \"0123456789abcdef\"[(digest >> (60 - 4 * i)) & 15u];
    hex[17] = '\\n';
    print(name);
    print(hex);
}
${runs}
int main(void) {
${calls}    return 0;
}
")
file(WRITE ${WORK_DIR}/terminal.c "#include <board.h>
#include <stdio.h>
#include <board.h>
void print(const char *text) { fputs(text, stdout); }
")

function(run_program out)    # run_program(OUT COMMAND...)
  execute_process(COMMAND ${ARGN} INPUT_FILE /dev/null OUTPUT_VARIABLE text ERROR_VARIABLE text RESULT_VARIABLE result
      TIMEOUT 200)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}: ${result}, ${text}")
  endif()
  set(${out} "${text}" PARENT_SCOPE)
endfunction()

find_program(host NAMES gcc cc)
execute_process(COMMAND ${host} ${strict} -O1 -ffp-contract=off ${WORK_DIR}/exported.c ${WORK_DIR}/terminal.c -lm
    -o ${WORK_DIR}/exported COMMAND_ERROR_IS_FATAL ANY)
run_program(expected ${WORK_DIR}/exported)
string(REGEX MATCHALL "\n" lines "${expected}")
list(LENGTH lines count)
if(NOT count EQUAL 9)
  message(FATAL_ERROR "not every filter is there:\n${expected}")
endif()

function(build_arm of_c)    # build_arm(OPTIONS PROCESSOR...)
  execute_process(COMMAND ${arm} ${of_c} -mthumb ${ARGN} -c ${WORK_DIR}/exported.c -o ${WORK_DIR}/exported.o
      COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${arm_cxx} -std=c++20 -O1 -fno-exceptions -fno-rtti -fno-threadsafe-statics -mthumb ${ARGN}
      -I ${board} ${board}/cortex_m.cpp ${WORK_DIR}/exported.o --specs=nano.specs -nostartfiles -T ${board}/mps2.ld
      -Wl,--gc-sections -lm -o ${WORK_DIR}/exported.elf COMMAND_ERROR_IS_FATAL ANY)
endfunction()
set(compared 0)
find_program(arm arm-none-eabi-gcc)
find_program(arm_cxx arm-none-eabi-g++)
find_program(emulator qemu-system-arm)
if(arm AND arm_cxx AND emulator)
  foreach(processor
      "mps2-an385;-mcpu=cortex-m3"
      "mps2-an386;-mcpu=cortex-m4;-mfloat-abi=hard;-mfpu=fpv4-sp-d16"
      "mps2-an500;-mcpu=cortex-m7;-mfloat-abi=hard;-mfpu=fpv5-d16")
    list(POP_FRONT processor machine)
    foreach(option -O0 -O2 -Os)
      build_arm("${strict};${option}" ${processor})    # without -ffp-contract: -std=c99 says it
      run_program(found ${emulator} -M ${machine} -nographic -semihosting-config enable=on,target=native
          -kernel ${WORK_DIR}/exported.elf)
      if(NOT "${found}" STREQUAL "${expected}")
        message(FATAL_ERROR "${machine} ${option} leaves other bits:\n${found}\n${expected}")
      endif()
    endforeach()
    message(STATUS "${machine}: the host's bits")
    math(EXPR compared "${compared} + 1")
  endforeach()
  # That bits are compared: fused they are others.
  build_arm("-std=c99;-ffp-contract=fast;-O2;-I;${board}" -mcpu=cortex-m7 -mfloat-abi=hard -mfpu=fpv5-d16)
  run_program(found ${emulator} -M mps2-an500 -nographic -semihosting-config enable=on,target=native
      -kernel ${WORK_DIR}/exported.elf)
  if("${found}" STREQUAL "${expected}")
    message(FATAL_ERROR "fused operations leave the same bits: nothing was compared")
  endif()
endif()

find_program(riscv riscv64-unknown-elf-gcc)
find_program(riscv_emulator qemu-system-riscv32)
if(riscv AND riscv_emulator)
  execute_process(COMMAND ${riscv} --specs=picolibc.specs -print-file-name=crt0-hosted.o OUTPUT_VARIABLE begin
      OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE library)
  if(library EQUAL 0)
    foreach(option -O0 -O2)
      execute_process(COMMAND ${riscv} --specs=picolibc.specs --oslib=semihost --crt0=hosted -march=rv32imac
          -mabi=ilp32 ${strict} ${option} -Wl,--defsym=__flash=0x80000000,--defsym=__flash_size=0x100000
          -Wl,--defsym=__ram=0x80100000,--defsym=__ram_size=0x100000 ${WORK_DIR}/exported.c ${WORK_DIR}/terminal.c -lm
          -o ${WORK_DIR}/exported.elf COMMAND_ERROR_IS_FATAL ANY)
      run_program(found ${riscv_emulator} -M virt -bios none -nographic -semihosting-config enable=on,target=native
          -kernel ${WORK_DIR}/exported.elf)
      if(NOT "${found}" STREQUAL "${expected}")
        message(FATAL_ERROR "RV32 ${option} leaves other bits:\n${found}\n${expected}")
      endif()
    endforeach()
    message(STATUS "RV32: the host's bits")
    math(EXPR compared "${compared} + 1")
  endif()
endif()
if(compared EQUAL 0)
  message("skipped: needs gcc-arm-none-eabi, libstdc++-arm-none-eabi-newlib and qemu-system-arm, or "
        "gcc-riscv64-unknown-elf, picolibc-riscv64-unknown-elf and qemu-system-misc")
endif()
