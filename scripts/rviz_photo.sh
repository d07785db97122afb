#!/usr/bin/env bash
source "$(dirname "${BASH_SOURCE[0]}")/lib/common.sh"

usage() {
  cat <<USAGE
usage: scripts/rviz_photo.sh [--scene FILE] [--at PHASE[+SECONDS]]... [--out DIR] [--size WxH]

Takes pictures of the package's rviz view without a display: rviz shows the live scene on a virtual
screen (Xvfb), which is saved when PHASE begins, or SECONDS of simulated time later. Installs missing
packages first. rviz draws in software here, so the run is slow.

  --scene FILE   scene file, or the name of one in config/scenes (default: tear_seam)
  --at WHEN      e.g. --at settle --at pull_and_tear+2.0 (default: settle, lift, pull_and_tear+2);
                 of a scene without phases: --at +2.0
  --out DIR      folder of the pictures rviz_<phase>.png, or rviz_<phase>+<seconds>.png where there
                 are several of a phase (default: the current folder)
  --size WxH     size of the screen in pixels (default: 1600x1000; at least 1440x940, for the window)
  --speed F      simulated time over wall time (default: 0.5)
  -h, --help     this text
USAGE
}

scene=tear_seam
out=.
size=1600x1000
speed=0.5
moments=()
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --scene | --at | --out | --size | --speed)
      [[ $# -ge 2 ]] || die "$1 needs a value"
      case $1 in
        --scene) scene=$2 ;;
        --at) moments+=("$2") ;;
        --out) out=$2 ;;
        --size) size=$2 ;;
        --speed) speed=$2 ;;
      esac
      shift
      ;;
    *) bad_usage "unknown argument '$1'" ;;
  esac
  shift
done
[[ $size =~ ^([1-9][0-9]{3,4})x([1-9][0-9]{2,4})$ ]] &&
  ((BASH_REMATCH[1] >= 1440 && BASH_REMATCH[2] >= 940)) ||
  bad_usage "--size: expected a screen of at least 1440x940 (got '$size')"
[[ ${#moments[@]} -gt 0 ]] || moments=(settle lift pull_and_tear+2)
[[ -f $scene ]] && scene=$(readlink -f "$scene")
mkdir -p "$out"
out=$(cd "$out" && pwd)

workspace=$repo_root/.ws
prepare build run rviz photo
run_timed build build_workspace "$workspace" all -DCMAKE_BUILD_TYPE=Release -DCLOTH_SIM_SANITIZE=
enter_workspace "$workspace"

processes=()
cleanup() {
  for process in "${processes[@]}"; do kill "$process" 2>/dev/null || true; done
  wait 2>/dev/null || true
  rm -f "${display_file:-}"
}
trap cleanup EXIT

display_file=$(mktemp)
Xvfb -displayfd 3 -screen 0 "${size}x24" -nolisten tcp -noreset 3>"$display_file" 2>/dev/null &
processes+=($!)
for _ in $(seq 100); do
  if [[ -s $display_file ]]; then break; fi
  sleep 0.1
done
[[ -s $display_file ]] || die "Xvfb did not start"
DISPLAY=:$(<"$display_file")
export DISPLAY LIBGL_ALWAYS_SOFTWARE=1 QT_X11_NO_MITSHM=1 ROS_HOME=$workspace/ros_home
# A master of its own, because another one may be running on the usual port.
export ROS_MASTER_URI=http://localhost:11399

say "run: $scene in rviz on $DISPLAY, photographs at ${moments[*]}"
roslaunch --port 11399 cloth_sim cloth.launch scene:="$scene" rviz:=true \
  speed:="$speed" paused:=true \
  >"$workspace/log/rviz.log" 2>&1 &
processes+=($!)

/usr/bin/python3 "$repo_root/scripts/lib/photograph.py" --size "$size" --out "$out" \
  "${moments[@]}" || die "see $workspace/log/rviz.log"
