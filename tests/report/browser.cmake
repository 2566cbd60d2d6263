# Pages as a browser shows them, at two widths: every figure drawn, every formula there, nothing beyond the edge.
# cmake -DPROGRAM= -DWORK_DIR= -DDATA= -DPANDOC= -P browser.cmake
find_program(BROWSER NAMES chromium chromium-browser google-chrome)
if(NOT BROWSER)
  message("skipped: needs chromium (a package of that name; too large for what ./lab installs)")
  return()
endif()
file(REMOVE_RECURSE ${WORK_DIR})
file(MAKE_DIRECTORY ${WORK_DIR})
execute_process(COMMAND ${PROGRAM} study gain_error bierman slicot precision_boundary --out ${WORK_DIR}
  RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
if(failed)
  message(FATAL_ERROR "the studies failed: ${failed}")
endif()
execute_process(COMMAND ${PROGRAM} identify ${DATA}/sales.csv --input lead --output sales --out ${WORK_DIR}
  RESULT_VARIABLE failed OUTPUT_QUIET)
if(failed)
  message(FATAL_ERROR "identify failed: ${failed}")
endif()

execute_process(COMMAND ${PROGRAM} compare ${DATA}/sales.csv --input lead --output sales --order 2 --no-timings --out
    ${WORK_DIR}
  RESULT_VARIABLE failed OUTPUT_QUIET)
if(failed)
  message(FATAL_ERROR "compare failed: ${failed}")
endif()

file(READ ${CMAKE_CURRENT_LIST_DIR}/browser.js check)
# look_at(FILE FIGURES FORMULAS): as many of them as are in the page, or more.
function(look_at file figures formulas)
  file(READ ${WORK_DIR}/${file} page)
  file(WRITE ${WORK_DIR}/looked_at.html "${page}\n<script>\n${check}</script>\n")
  if(page MATCHES "src=\"http|href=\"http|\\$\\$|\\\\frac[^<]*</code>")
    message(FATAL_ERROR "${file} loads something, or shows raw LaTeX: ${CMAKE_MATCH_0}")
  endif()
  foreach(width 1280 420)    # in a frame: a window of a browser is never narrower than 500
    file(WRITE ${WORK_DIR}/frame.html "<!doctype html>
<script>onmessage = e => Object.assign(document.documentElement.dataset, e.data)</script>
<iframe src='looked_at.html' style='border:0;width:${width}px;height:3000px'></iframe>")
    execute_process(COMMAND ${BROWSER} --headless --no-sandbox --disable-gpu --user-data-dir=${WORK_DIR}/profile
        --virtual-time-budget=10000
        --window-size=1400,3100 --dump-dom file://${WORK_DIR}/frame.html
      OUTPUT_VARIABLE shown ERROR_QUIET RESULT_VARIABLE failed TIMEOUT 120)
    if(NOT shown MATCHES "data-seen=\"([^\"]*)\"")
      message(FATAL_ERROR "${file} at ${width} pixels: the browser showed nothing (${failed})")
    endif()
    set(seen "${CMAKE_MATCH_1}")
    if(NOT shown MATCHES "data-wrong=\"\"")
      string(REGEX MATCH "data-wrong=\"[^\"]*\"" wrong "${shown}")
      message(FATAL_ERROR "${file} at ${width} pixels: ${wrong} (${seen})")
    endif()
    string(REGEX MATCH "width ([0-9]+), figures ([0-9]+), formulas ([0-9]+), typeset ([0-9]+)" whole "${seen}")
    if(NOT CMAKE_MATCH_1 EQUAL width OR CMAKE_MATCH_2 LESS figures OR CMAKE_MATCH_3 LESS formulas
        OR (PANDOC AND NOT CMAKE_MATCH_4 EQUAL CMAKE_MATCH_3))
      message(FATAL_ERROR
          "${file} at ${width} pixels: expected ${figures} figures and ${formulas} formulas at least, found: ${seen}")
    endif()
    message("${file}: ${seen}")
  endforeach()
endfunction()
look_at(report.html 6 4)
look_at(model.html 6 0)
look_at(compare.html 4 0)
