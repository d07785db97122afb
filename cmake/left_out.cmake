# cloth_sim_leave_out(<key> <text>): reports an optional part that is not built because something is
# not installed. The keys are listed in build/cloth_sim/left_out.txt, where scripts/test.sh reads
# them: there, nothing may be left out.
set(left_out_file ${PROJECT_BINARY_DIR}/left_out.txt)
file(WRITE ${left_out_file} "")
function(cloth_sim_leave_out key)
  string(CONCAT text ${ARGN})
  message(STATUS "cloth_sim: ${text}")
  file(APPEND ${left_out_file} "${key}: ${text}\n")
endfunction()
