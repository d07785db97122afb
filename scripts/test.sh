#!/usr/bin/env bash
source "$(dirname "${BASH_SOURCE[0]}")/lib/common.sh"

usage() {
  cat <<USAGE
usage: scripts/test.sh [--quick] [--compiler=NAME] [--sanitize=LIST]

Builds everything in the catkin workspace .ws at the repository's root, and runs every test.
First installs the missing packages of ROS and the libraries (as root or with sudo).

  --quick           only the tests that need no ROS master
  --compiler=NAME   gcc (the default) or clang, which builds in a workspace of its own, .ws-clang
  --sanitize=LIST   build with sanitizers (address, undefined or address,undefined; or thread), in a
                    workspace of its own, .ws-LIST (.ws-clang-LIST)
  -h, --help        this text

With sanitizers, long suites run fewer cases (test/fewer_cases.h), the cases of
test/sanitizers/too_long.txt are left out, and whatever a process reports counts as failed, also if no
test looks at how it ended. The thread sanitizer runs, of suites about what one thread does, only the
cases that name threads.

A suite of tests that was not built or not run (scripts/lib/suites.txt) is named and counts as failed.
Ends with a line 'N passed, N failed'; the exit status is 0 only if nothing failed.
USAGE
}

quick=no
sanitize=
compiler=gcc
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --quick) quick=yes ;;
    --compiler=*) compiler=${1#*=} ;;
    --compiler) compiler=${2:?--compiler needs a name} && shift ;;
    --sanitize=*) sanitize=${1#*=} ;;
    --sanitize) sanitize=${2:?--sanitize needs a list} && shift ;;
    *) bad_usage "unknown argument '$1'" ;;
  esac
  shift
done
[[ -z $sanitize || $sanitize =~ ^[a-z,]+$ ]] || die "--sanitize: '$sanitize' is no list of names"

workspace=$repo_root/.ws
suite_options=()  # of check_suites.py
groups=(build run test bench)
case $compiler in
  gcc) ;;
  clang)
    workspace+=-clang
    groups+=(clang)
    export CC=clang CXX=clang++
    ;;
  *) bad_usage "--compiler: '$compiler' is neither gcc nor clang" ;;
esac
cmake_arguments=(-DCMAKE_BUILD_TYPE=Release "-DCLOTH_SIM_SANITIZE=$sanitize")
if [[ -n $sanitize ]]; then
  workspace+=-${sanitize//,/-}
  # Little optimisation, and line numbers only: the compiler needs half as long.
  cmake_arguments=(-DCMAKE_BUILD_TYPE=RelWithDebInfo "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1 -DNDEBUG"
    "-DCLOTH_SIM_SANITIZE=$sanitize")
  export CLOTH_SIM_FEWER_CASES=10
  export GTEST_FILTER=-$(grep -o '^[^ #]\+' "$repo_root/test/sanitizers/too_long.txt" | paste -sd:)
  suite_options+=(--without rviz --fewer-cases "$CLOTH_SIM_FEWER_CASES")
  if [[ $sanitize == thread ]]; then suite_options+=(--without one_thread); fi
fi
reports=$workspace/log/sanitizers

# run_tests <title> <regular expression of ctest names> <how many at a time>
failed_groups=0
run_tests() {
  local title=$1 pattern=$2 at_once=$3
  if [[ $(cd "$workspace/build" && ctest -N -R "$pattern" | grep -c 'Test *#') -eq 0 ]]; then
    say "$title: none"
    return
  fi
  say "$title"
  (cd "$workspace/build" && run_timed "$title" ctest -R "$pattern" -j "$at_once" \
    --output-on-failure </dev/null) || failed_groups=$((failed_groups + 1))
  if [[ -n $sanitize ]]; then  # nodes report undefined behaviour here, if no test asks how they ended
    grep -A 20 'runtime error:' "$workspace/build/Testing/Temporary/LastTest.log" \
      >>"$reports/undefined" || true
  fi
}

# watch_sanitizers: lets every process write what its sanitizer reports into a file of $reports. The one
# for undefined behaviour cannot, next to that for addresses: it ends the process.
watch_sanitizers() {
  rm -rf "$reports"
  mkdir -p "$reports"
  export ASAN_OPTIONS=log_path=$reports/report
  export LSAN_OPTIONS=suppressions=$repo_root/test/sanitizers/leak.supp:print_suppressions=0
  export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
  export TSAN_OPTIONS=log_path=$reports/report:suppressions=$repo_root/test/sanitizers/thread.supp
  export CXXFLAGS=-fsanitize=$sanitize  # of test/consumer, which links the libraries
}

# show_reports: prints the beginning of each report. \return 1 if there is one.
show_reports() {
  local report status=0
  for report in "$reports"/*; do
    [[ -s $report ]] || continue
    printf '  FAILED sanitizer: %s\n' "$report"
    head -n 30 "$report"
    status=1
  done
  return "$status"
}

if [[ $quick == no ]]; then groups+=(rviz photo); fi  # the plugin, and a screen for its tests
prepare "${groups[@]}"
run_timed build build_workspace "$workspace" "all tests" "${cmake_arguments[@]}"

results=$workspace/build/test_results/cloth_sim
rm -rf "$results"
if [[ -n $sanitize ]]; then watch_sanitizers; fi
export ROS_HOME=$workspace/ros_home  # logs and the like: not in the user's ~/.ros
if [[ $sanitize == thread ]]; then
  run_tests "core tests" '_gtest_.*_(unit|determinism)_test' "$(build_jobs)"
  GTEST_FILTER='*Thread*' run_tests "core tests with threads" \
    '_gtest_.*_(verify|surgery|study|allocation|fuzz)_test' "$(build_jobs)"
else
  run_tests "core tests" '_(gtest|gmock)_' "$(build_jobs)"
  run_tests "tests of the programs" '_tool_' 1
fi
if [[ $quick == no ]]; then
  run_tests "ROS tests" '_rostest_' 1
fi

mkdir -p "$results"
totals=$(/usr/bin/python3 "$repo_root/scripts/lib/junit_total.py" "$results")
read -r passed failed skipped <<<"${totals##*$'\n'}"
if [[ $totals == *$'\n'* ]]; then printf '%s\n' "${totals%$'\n'*}"; fi
if [[ $failed -eq 0 && $failed_groups -gt 0 ]]; then
  say "ctest reports a failure that left no record of a failed case; see above"
  failed=$failed_groups
fi

# check_suites: prints a line for everything in scripts/lib/suites.txt that was not built or not run.
check_suites() {
  local options=(--left-out "$workspace/build/cloth_sim/left_out.txt" "${suite_options[@]}")
  if [[ $quick == yes ]]; then options+=(--quick --without rviz); fi
  if [[ $ros_flavour == noetic ]]; then options+=(--without rapidcheck --without cvode); fi
  /usr/bin/python3 "$repo_root/scripts/lib/check_suites.py" "${options[@]}" "$results"
}
if ! absent=$(check_suites); then
  say "these were not built or not run:"
  printf '%s\n' "$absent"
  failed=$((failed + $(wc -l <<<"$absent")))
fi
if [[ -n $sanitize ]]; then show_reports || failed=$((failed + 1)); fi
say "in all: $SECONDS s"

closing="$passed passed, $failed failed"
if [[ $skipped -gt 0 ]]; then closing+=", $skipped skipped"; fi
echo "$closing"
[[ $failed -eq 0 ]]
