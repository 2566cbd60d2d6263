# The example of CONTRIBUTING.md compiles as it stands: its C++ block is written to the path that its introduction
# names, under WORK_DIR, and checked by the compiler against the tree. (Its variant: docs/examples/own_study.)
#
#   CONTRIBUTING  the page        SOURCE_DIR  the tree            WORK_DIR  for the files written here
#   CXX           the compiler    INCLUDES    folders, | between
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${WORK_DIR})
file(READ ${CONTRIBUTING} text)
string(REPLACE ";" "<semicolon>" text "${text}")    # a ; would end an item of a list
string(REPLACE "[" "<open>" text "${text}")         # brackets would keep one together
string(REPLACE "]" "<close>" text "${text}")
set(written "")
while(TRUE)
  string(FIND "${text}" "\n```cpp\n" start)
  if(start EQUAL -1)
    break()
  endif()
  string(SUBSTRING "${text}" 0 ${start} before)
  math(EXPR start "${start} + 8")
  string(SUBSTRING "${text}" ${start} -1 text)
  string(FIND "${text}" "\n```\n" end)
  string(SUBSTRING "${text}" 0 ${end} code)
  string(SUBSTRING "${text}" ${end} -1 text)
  if(NOT before MATCHES "`([a-z_/]+\\.[ch]pp)`:\n$")
    message(FATAL_ERROR "expected \"`a/path.hpp`:\" before each C++ block of ${CONTRIBUTING}")
  endif()
  set(path ${CMAKE_MATCH_1})
  string(REPLACE "<semicolon>" ";" code "${code}")
  string(REPLACE "<open>" "[" code "${code}")
  string(REPLACE "<close>" "]" code "${code}")
  file(WRITE ${WORK_DIR}/${path}.cpp "${code}\n")
  list(APPEND written ${path})
endwhile()

list(LENGTH written count)
if(NOT count EQUAL 1)
  message(FATAL_ERROR "expected one C++ block in ${CONTRIBUTING}, a study, not ${count}: ${written}")
endif()
string(REPLACE "|" ";" folders "${INCLUDES}")
list(TRANSFORM folders PREPEND -I)
foreach(path IN LISTS written)
  execute_process(
    COMMAND ${CXX} -std=c++20 -ffp-contract=off -fsyntax-only -I${SOURCE_DIR}/src -I${SOURCE_DIR} ${folders}
        ${WORK_DIR}/${path}.cpp
    RESULT_VARIABLE failed ERROR_VARIABLE errors)
  if(failed)
    message(FATAL_ERROR "CONTRIBUTING.md, ${path}:\n${errors}")
  endif()
endforeach()
message(STATUS "compiled: ${written}")
