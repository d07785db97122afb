#!/usr/bin/env bash
source "$(dirname "${BASH_SOURCE[0]}")/lib/common.sh"

usage() {
  cat <<USAGE
usage: scripts/lint.sh [--changed REV] [--minutes N] [FILE...]

Checks the C++ sources with clang-tidy, by the rules in .clang-tidy. A warning is a failure. Installs
what is missing, and configures a catkin workspace of its own, .ws-lint, for the command lines of the
compiler and the generated headers.

  FILE           source or header files, or folders (default: everything; half an hour on one core)
  --changed REV  only what differs from this revision of git
  --minutes N    begin no further file after N minutes, and name those that were not checked
  -h, --help     this text

A header is checked with the source file of the same name, or else with the first that includes it.
Sources that are compiled as one (cmake/unity_build.cmake) are checked as one, which is quicker.
USAGE
}

changed=
minutes=
arguments=()
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --changed) changed=${2:?--changed needs a revision} && shift ;;
    --minutes) minutes=${2:?--minutes needs a number} && shift ;;
    -*) bad_usage "unknown argument '$1'" ;;
    *) arguments+=("$1") ;;
  esac
  shift
done

options=(--jobs "$(nproc)")
if [[ -n $minutes ]]; then options+=(--minutes "$minutes"); fi
if [[ -n $changed ]]; then
  mapfile -t arguments < <(cd "$repo_root" &&
    git diff --name-only --diff-filter=d "$changed" -- '*.h' '*.cpp')
  if [[ ${#arguments[@]} -eq 0 ]]; then
    say "lint: no C++ file differs from $changed"
    exit 0
  fi
fi

workspace=$repo_root/.ws-lint
prepare build run test bench rviz lint
export CC=clang CXX=clang++
run_timed configure build_workspace "$workspace" \
  "cloth_sim_generate_messages cloth_sim_gencfg"
run_timed lint /usr/bin/python3 "$repo_root/scripts/lib/tidy.py" "${options[@]}" \
  "$workspace" "${arguments[@]}"
