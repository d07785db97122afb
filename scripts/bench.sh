#!/usr/bin/env bash
source "$(dirname "${BASH_SOURCE[0]}")/lib/common.sh"

usage() {
  cat <<USAGE
usage: scripts/bench.sh [--core N] [arguments of Google Benchmark, such as --benchmark_filter=REGEX]
       scripts/bench.sh [--core N] --layers [arguments of peer_layers, such as --sizes=32,64]

Builds the benchmarks in the catkin workspace .ws and runs them on one core. Installs missing packages
first.

  --core N     run on core N (default: 0)
  --layers     measure contact between layers of cloth, beside Bullet, instead (docs/layers.md):
               tables in markdown on stdout, in a few minutes. What follows goes to peer_layers;
               --layers --help lists it
  -h, --help   this text
USAGE
}

core=0
program=cloth_bench
targets="cloth_bench peer_bullet"
arguments=()
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --core)
      [[ $# -ge 2 ]] || die "--core needs a value"
      core=$2
      shift
      ;;
    --layers)
      program=peer_layers
      targets=peer_layers
      arguments=("${@:2}")
      break
      ;;
    --benchmark_*) arguments+=("$1") ;;
    *) bad_usage "unknown argument '$1'" ;;
  esac
  shift
done

workspace=$repo_root/.ws
prepare build bench
run_timed build build_workspace "$workspace" "$targets" -DCMAKE_BUILD_TYPE=Release -DCLOTH_SIM_SANITIZE=
enter_workspace "$workspace"
taskset -c "$core" "$(find "$workspace" -type f -name "$program" | head -n 1)" "${arguments[@]}"
