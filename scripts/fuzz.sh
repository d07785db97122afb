#!/usr/bin/env bash
source "$(dirname "${BASH_SOURCE[0]}")/lib/common.sh"

usage() {
  cat <<USAGE
usage: scripts/fuzz.sh [--seconds N] [TARGET]...

Feeds the program with bytes that libFuzzer changes until they reach new branches, with the address
and undefined-behaviour sanitizers: saved states (state), scenes (scene), meshes of cloth (obj) and
of obstacles (surface), strokes of a blade (stroke) and commands of bags (command); all of them if
none is named. It builds with clang in a workspace of its own, .ws-fuzz. What reached new branches is
kept there from run to run; what did harm is in .ws-fuzz/found/TARGET, to be mended and then kept in
test/fuzz/corpus/TARGET.

  --seconds N   for each target (default: 60; for a night: 3600)
  -h, --help    this text

Prints a line for each target; the exit status is 0 only if nothing did harm.
USAGE
}

readonly all_targets=(state scene obj surface stroke command)
seconds=60
targets=()
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --seconds) seconds=${2:?--seconds needs a number} && shift ;;
    --seconds=*) seconds=${1#*=} ;;
    -*) bad_usage "unknown argument '$1'" ;;
    *)
      [[ " ${all_targets[*]} " == *" $1 "* ]] ||
        bad_usage "unknown target '$1' (known: ${all_targets[*]})"
      targets+=("$1")
      ;;
  esac
  shift
done
[[ $seconds =~ ^[1-9][0-9]*$ ]] || bad_usage "--seconds: '$seconds' is no number of seconds"
if [[ ${#targets[@]} -eq 0 ]]; then targets=("${all_targets[@]}"); fi

workspace=$repo_root/.ws-fuzz
prepare build test clang
export CC=clang CXX=clang++
programs=$(printf ' fuzz_%s' "${targets[@]}")
run_timed build build_workspace "$workspace" "${programs# }" -DCMAKE_BUILD_TYPE=RelWithDebInfo \
  "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1 -DNDEBUG" -DCLOTH_SIM_FUZZ=ON \
  -DCLOTH_SIM_SANITIZE=address,undefined

export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
# fuzz <target>: prints its line. \return 1 if something did harm.
fuzz() {
  local target=$1
  local program=$workspace/devel/lib/cloth_sim/fuzz_$target
  local corpus=$workspace/corpus/$target found=$workspace/found/$target
  local log=$workspace/log/fuzz_$target.log status=0
  mkdir -p "$corpus" "$found"
  local -a kept=()
  if [[ -d $repo_root/test/fuzz/corpus/$target ]]; then
    kept=("$repo_root/test/fuzz/corpus/$target")
  fi
  CLOTH_SIM_FUZZ_SEEDS=$corpus "$program" >"$log" 2>&1 || { tail -n 5 "$log" >&2 && return 1; }
  "$program" -max_total_time="$seconds" -timeout=30 -rss_limit_mb=3000 -max_len=400000 \
    -print_final_stats=1 -artifact_prefix="$found/" "$corpus" "${kept[@]}" >"$log" 2>&1 || status=1
  local runs branches
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  branches=$(grep -oE 'cov: [0-9]+' "$log" | tail -n 1 | tr -dc 0-9)
  printf '%-8s %9s runs, %6s branches reached, %s\n' "$target" "${runs:-?}" "${branches:-?}" \
    "$([[ $status -eq 0 ]] && echo 'nothing found' || echo "harm: $found (log: $log)")"
  return "$status"
}

failed=0
for target in "${targets[@]}"; do fuzz "$target" || failed=$((failed + 1)); done
[[ $failed -eq 0 ]]
