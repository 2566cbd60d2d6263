# rlslab_add_bench(NAME FILE): a program that times the class Mine in FILE beside the variants (docs/bench.md). In an
# installation; in the tree, ./lab bench --mine FILE. What Mine needs to be linked with is added to NAME as usual.
function(rlslab_add_bench name file)
  if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    message(WARNING "rlslab_add_bench: no build type, so nothing is optimised: configure with "
      "-DCMAKE_BUILD_TYPE=Release")
  endif()
  set(from ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/bench)
  get_filename_component(file ${file} ABSOLUTE)
  foreach(scalar double float)
    add_library(${name}_${scalar} OBJECT ${from}/update.cpp)
    target_compile_definitions(${name}_${scalar} PRIVATE RLSLAB_BENCH_SCALAR=${scalar})
    target_include_directories(${name}_${scalar} PRIVATE ${CMAKE_CURRENT_FUNCTION_LIST_DIR})
    target_link_libraries(${name}_${scalar} PRIVATE rlslab::core benchmark::benchmark)
  endforeach()
  add_executable(${name} ${from}/own_main.cpp ${from}/run.cpp ${from}/choice.cpp ${from}/scenario.cpp
    ${from}/peer_eigen.cpp ${from}/peer_mine.cpp $<TARGET_OBJECTS:${name}_double> $<TARGET_OBJECTS:${name}_float>)
  target_compile_definitions(${name} PRIVATE RLSLAB_BENCH_MINE="${file}")
  target_include_directories(${name} PRIVATE ${CMAKE_CURRENT_FUNCTION_LIST_DIR})
  target_link_libraries(${name} PRIVATE rlslab::core benchmark::benchmark fmt::fmt)
endfunction()
