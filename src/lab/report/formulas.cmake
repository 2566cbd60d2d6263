# Formulas of pages: LaTeX becomes MathML when a program is built, by pandoc. For this tree, and installed for the
# studies of others (rlslab_add_study).
find_program(PANDOC pandoc)
mark_as_advanced(PANDOC)
set(RLSLAB_FORMULAS ${CMAKE_CURRENT_LIST_DIR}/formulas.lua)

# rlslab_formulas(TARGET SOURCE...): adds to the target the table of every R"tex(...)tex" in the sources.
function(rlslab_formulas target)
  if(NOT PANDOC)
    message(STATUS "pandoc is not installed: pages of ${target} will show formulas as text")
    return()
  endif()
  set(table ${CMAKE_CURRENT_BINARY_DIR}/${target}_formulas.cpp)
  add_custom_command(OUTPUT ${table} DEPENDS ${RLSLAB_FORMULAS} ${ARGN} VERBATIM
    COMMAND ${PANDOC} -f ${RLSLAB_FORMULAS} -t html -o ${table} ${ARGN}
    WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} COMMENT "formulas of ${target} as MathML")
  target_sources(${target} PRIVATE ${table})
endfunction()
