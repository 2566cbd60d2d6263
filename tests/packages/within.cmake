# cmake -DSOURCE_DIR=... -DCOMPILERS=g++,clang++ -DWORK_DIR=... -P within.cmake
# Another project's build takes the headers where there is Eigen and nothing else: by add_subdirectory and by
# FetchContent.
include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)
set(absent "")
foreach(package Boost Arb CLI11 fmt nlohmann_json TBB ZLIB PkgConfig SuiteSparse GTest rapidcheck benchmark)
  list(APPEND absent -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
foreach(compiler IN LISTS COMPILERS)
  foreach(fetch OFF ON)
    run(${CMAKE_COMMAND} --fresh -G Ninja -S ${CMAKE_CURRENT_LIST_DIR}/within -B ${WORK_DIR}/build
        -DRLSLAB=${SOURCE_DIR} -DFETCH=${fetch}
      -DCMAKE_CXX_COMPILER=${compiler} -DCMAKE_BUILD_TYPE=Release ${absent})
    run(${CMAKE_COMMAND} --build ${WORK_DIR}/build --clean-first)
    run(${WORK_DIR}/build/app)
  endforeach()
endforeach()
# Nothing of rlslab is installed with that project, and no test of it is run.
file(READ ${WORK_DIR}/build/cmake_install.cmake rules)
file(GLOB_RECURSE all_rules ${WORK_DIR}/build/*/cmake_install.cmake)
foreach(file IN LISTS all_rules)
  file(READ ${file} text)
  string(APPEND rules "${text}")
endforeach()
expect_not("${rules}" "file\\(INSTALL" "rules of installation in another project's build")

# That the packages are really out of reach: with the core asked for, the same build is refused.
execute_process(COMMAND ${CMAKE_COMMAND} --fresh -G Ninja -S ${CMAKE_CURRENT_LIST_DIR}/within -B ${WORK_DIR}/build
    -DRLSLAB=${SOURCE_DIR}
  -DRLSLAB_HEADERS_ONLY=OFF ${absent} RESULT_VARIABLE code OUTPUT_QUIET ERROR_VARIABLE said)
expect("${said}" "Boost" "a core without Boost is refused")
if(code EQUAL 0)
  message(FATAL_ERROR "a core was configured without Boost")
endif()
