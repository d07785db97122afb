#!/usr/bin/env bash
source "$(dirname "${BASH_SOURCE[0]}")/lib/common.sh"

usage() {
  cat <<USAGE
usage: scripts/demo.sh [--scene FILE] [--out DIR] [--headless]

Runs the tearing run: a cloth falls on a sphere on a table, two clamps grasp it, lift it, lower it
and pull it apart. First installs the missing packages of ROS and the libraries (as root or with
sudo), and builds.

Writes to DIR (default: the repository's root)
  demo.bag    the messages that the node would have published, for rosbag and rviz
  demo.json   the summary of the run
  demo.png    a picture of each phase
Where there is a display, it then shows the run live in rviz until Ctrl-C.

  --scene FILE   a scene file, or the name of one in config/scenes (default: tear_seam.yaml)
  --out DIR      folder of the files
  --headless     no rviz, even where there is a display
  -h, --help     this text

The exit status is that of the run: 0 done, 2 bad input, 3 the simulation failed; 1 if the run did
not start.
USAGE
}

scene=tear_seam.yaml
out=$repo_root
headless=no
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --scene=*) scene=${1#*=} ;;
    --scene) scene=${2:?--scene needs a file} && shift ;;
    --out=*) out=${1#*=} ;;
    --out) out=${2:?--out needs a folder} && shift ;;
    --headless) headless=yes ;;
    *) bad_usage "unknown argument '$1'" ;;
  esac
  shift
done

# find_scene <file or name>: prints the path of the scene.
find_scene() {
  local candidate
  for candidate in "$1" "$repo_root/config/scenes/$1" "$repo_root/config/scenes/$1.yaml"; do
    if [[ -f $candidate ]]; then
      readlink -f "$candidate"
      return
    fi
  done
  echo "error: there is no scene '$1'; in config/scenes:" \
    "$(cd "$repo_root/config/scenes" && echo *.yaml)" >&2
  exit 2
}

# display_named: whether DISPLAY may name a screen. A local screen has a socket, and without one there
# is no need to install rviz.
display_named() {
  [[ -n ${DISPLAY:-} ]] || return 1
  [[ ! $DISPLAY =~ ^:([0-9]+) || -S /tmp/.X11-unix/X${BASH_REMATCH[1]} ]]
}
# display_answers: whether the screen can be opened.
display_answers() {
  /usr/bin/python3 -c 'import ctypes, sys
x11 = ctypes.CDLL("libX11.so.6")
x11.XOpenDisplay.restype = ctypes.c_void_p
sys.exit(x11.XOpenDisplay(None) is None)'
}

scene=$(find_scene "$scene")
mkdir -p "$out"
out=$(cd "$out" && pwd)

groups=(build run picture)
if [[ $headless == no ]]; then
  if display_named; then
    groups+=(rviz)
  else
    say "no display (DISPLAY is '${DISPLAY:-}'): running headless"
    headless=yes
  fi
fi

workspace=$repo_root/.ws
prepare "${groups[@]}"
run_timed build build_workspace "$workspace" all -DCMAKE_BUILD_TYPE=Release -DCLOTH_SIM_SANITIZE=
enter_workspace "$workspace"

say "run: $scene"
rm -f "$out"/demo.{bag,json,png}
status=0
run_timed run rosrun cloth_sim cloth_run "$scene" --bag "$out/demo.bag" \
  --summary "$out/demo.json" || status=$?

if [[ -f $out/demo.bag ]]; then
  run_timed picture /usr/bin/python3 "$repo_root/scripts/picture.py" "$out/demo.bag" \
    --scene "$scene" --out "$out/demo.png" || warn "demo.png could not be drawn"
fi
if [[ -f $out/demo.json ]]; then
  /usr/bin/python3 "$repo_root/scripts/lib/print_summary.py" "$out/demo.json"
fi
for file in "$out"/demo.{bag,json,png}; do
  if [[ -f $file ]]; then say "wrote $file ($(du -h "$file" | cut -f1))"; fi
done
if [[ $status -ne 0 ]]; then
  echo "error: cloth_run ended with status $status" >&2
  exit "$status"
fi

if [[ $headless == no ]]; then
  if display_answers; then
    say "the same run live in rviz; Ctrl-C ends it"
    roslaunch cloth_sim cloth.launch scene:="$scene" rviz:=true
  else
    say "the display $DISPLAY does not answer: no rviz"
  fi
fi
