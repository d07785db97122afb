#!/usr/bin/env bash
source "$(dirname "${BASH_SOURCE[0]}")/lib/common.sh"

usage() {
  cat <<USAGE
usage: scripts/bench.sh [--core N] [arguments of Google Benchmark, such as --benchmark_filter=REGEX]

Builds the benchmarks in the catkin workspace .ws and runs them on one core. Installs missing packages
first.

  --core N     run on core N (default: 0)
  -h, --help   this text
USAGE
}

core=0
arguments=()
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --core)
      [[ $# -ge 2 ]] || die "--core needs a value"
      core=$2
      shift
      ;;
    --benchmark_*) arguments+=("$1") ;;
    *) bad_usage "unknown argument '$1'" ;;
  esac
  shift
done

workspace=$repo_root/.ws
prepare build bench
run_timed build build_workspace "$workspace" "cloth_bench peer_bullet" -DCMAKE_BUILD_TYPE=Release -DCLOTH_SIM_SANITIZE=
enter_workspace "$workspace"
taskset -c "$core" "$(find "$workspace" -type f -name cloth_bench | head -n 1)" "${arguments[@]}"
