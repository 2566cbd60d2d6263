# Fleets on a GPU: the kernels to PTX by clang 16 alone, which the driver compiles for the card there is. No CUDA
# toolkit, to build or to run. Without clang 16 this is left out.
find_program(RLSLAB_CLANG_16 NAMES clang++-16)
if(NOT RLSLAB_CLANG_16)
  message(STATUS "fleets on a GPU are left out: no clang++-16 (package clang-16)")
  return()
endif()
set(part_1 -O3 -mllvm -unroll-threshold=4000 -mllvm -inline-threshold=20000)   # a filter in registers
set(part_2 ${part_1})
set(part_6 ${part_1})
foreach(part 3 4 5)    # in local memory: as loops, an eighth of the text
  set(part_${part} -O2 -fno-unroll-loops)
endforeach()
get_target_property(eigen_folders Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
list(TRANSFORM eigen_folders PREPEND -I)
file(GLOB headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/rlslab/*/*.hpp
  ${PROJECT_SOURCE_DIR}/src/rlslab/linalg/kernels/* ${PROJECT_SOURCE_DIR}/variants/*.hpp)
set(ptx_parts "")
set(kernels ${PROJECT_SOURCE_DIR}/src/rlslab/gpu/kernels.cu)
foreach(part RANGE 1 6)
  # 77 is 'M': as on a Cortex-M, the text of the kernels that is for any arithmetic (linalg/storage.hpp). PTX 6.0 has
  # what a warp does together; left alone clang takes 4.2, or that of a toolkit which happens to be there.
  add_custom_command(OUTPUT kernels_${part}.ptx DEPENDS ${kernels} ${headers}
    COMMAND ${RLSLAB_CLANG_16} -x cuda --cuda-device-only --cuda-gpu-arch=sm_70 --cuda-feature=+ptx60 -nocudainc
      -nocudalib -std=c++20 ${part_${part}} -ffp-contract=off -fno-exceptions -Xclang -fcuda-allow-variadic-functions
      -D__ARM_ARCH_PROFILE=77 -DRLSLAB_PART=${part} -Wno-unknown-cuda-version -Wno-ignored-pragmas
      -I${PROJECT_SOURCE_DIR}/src ${eigen_folders} -S ${kernels} -o kernels_${part}.ptx
    COMMENT "kernels for a GPU, part ${part}" VERBATIM)
  list(APPEND ptx_parts ${CMAKE_CURRENT_BINARY_DIR}/kernels_${part}.ptx)
endforeach()
add_custom_command(OUTPUT kernels.ptx DEPENDS ${ptx_parts} COMMAND cat ${ptx_parts} > kernels.ptx VERBATIM)
set(ptx ${CMAKE_CURRENT_BINARY_DIR}/kernels.ptx)
add_library(rlslab_gpu STATIC ${PROJECT_SOURCE_DIR}/src/rlslab/gpu/driver.cpp)
set_source_files_properties(${PROJECT_SOURCE_DIR}/src/rlslab/gpu/driver.cpp PROPERTIES OBJECT_DEPENDS ${ptx}
  COMPILE_DEFINITIONS RLSLAB_PTX="${ptx}")
target_link_libraries(rlslab_gpu PUBLIC rlslab_kernels PRIVATE $<BUILD_INTERFACE:rlslab_flags> ${CMAKE_DL_LIBS})
set_target_properties(rlslab_gpu PROPERTIES POSITION_INDEPENDENT_CODE ON)
