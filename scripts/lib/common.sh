# shellcheck shell=bash
# Functions of scripts/*.sh: packages, the environment, the catkin workspace in .ws. Sourced, not run.
#
# They work on Debian 12, whose own ROS 1 is in /usr, and on ROS Noetic in /opt/ros/noetic. They print
# each step and do only those that are due, so a second run is quick.

set -euo pipefail

repo_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd -P)

say() { printf '== %s\n' "$*"; }
warn() { printf 'warning: %s\n' "$*" >&2; }
die() {
  printf 'error: %s\n' "$*" >&2
  exit 1
}

# bad_usage <message>: prints the usage and the message, and exits with the status of a wrong command
# line.
bad_usage() {
  usage >&2
  printf 'error: %s\n' "$*" >&2
  exit 2
}

# run_timed <title> <command>...: runs the command, prints how long it took, returns its status.
run_timed() {
  local title=$1 start=$SECONDS status=0
  shift
  "$@" || status=$?
  say "$title: $((SECONDS - start)) s"
  return "$status"
}

# ---- the system ----------------------------------------------------------------------------------

# Sets ros_flavour to debian or noetic.
detect_system() {
  if [[ -f /opt/ros/noetic/setup.bash ]]; then
    ros_flavour=noetic
    return
  fi
  local id='' version_id='' pretty='an unknown system'
  if [[ -r /etc/os-release ]]; then
    id=$(. /etc/os-release && echo "${ID:-}")
    version_id=$(. /etc/os-release && echo "${VERSION_ID:-}")
    pretty=$(. /etc/os-release && echo "${PRETTY_NAME:-$ID}")
  fi
  [[ $id == debian ]] || die "this is $pretty; cloth_sim's scripts know Debian 12 and ROS Noetic" \
    "(elsewhere: put the package in a catkin workspace and run catkin_make)"
  [[ $version_id == 12 ]] || warn "this is $pretty; these scripts are tested on Debian 12"
  ros_flavour=debian
}

# ---- packages ------------------------------------------------------------------------------------

# packages_for <group>...: prints the names that the packages of these groups have on this system.
packages_for() {
  local group
  for group in "$@"; do
    case $ros_flavour/$group in
      debian/build)
        echo g++ make cmake catkin python3 \
          libeigen3-dev libyaml-cpp-dev nlohmann-json3-dev libcereal-dev libcli11-dev \
          ros-message-generation ros-message-runtime libroscpp-dev libroslib-dev librosbag-dev \
          ros-std-msgs ros-geometry-msgs libstd-msgs-dev libgeometry-msgs-dev \
          libnav-msgs-dev libsensor-msgs-dev libshape-msgs-dev libtrajectory-msgs-dev \
          libvisualization-msgs-dev libdiagnostic-msgs-dev \
          libdiagnostic-updater-dev libdynamic-reconfigure-config-init-mutex-dev \
          python3-dynamic-reconfigure libinteractive-markers-dev libtf2-dev libtf2-ros-dev \
          libtf2-geometry-msgs-dev liburdf-dev libtinyxml2-dev \
          libactionlib-dev libactionlib-msgs-dev libros-rosgraph-msgs-dev ros-actionlib-msgs
        ;;
      debian/run)  # rosrun, roslaunch and the command-line tools; python3-*-msgs: rostopic echo
        echo rosbash python3-roslaunch python3-rosbag python3-rostopic python3-rosservice \
          python3-rosnode python3-rosparam python3-rosmsg python3-rospy \
          python3-std-msgs python3-geometry-msgs python3-visualization-msgs \
          python3-diagnostic-msgs python3-rosgraph-msgs python3-tf2-msgs \
          python3-actionlib python3-actionlib-msgs \
          python3-nav-msgs python3-sensor-msgs python3-shape-msgs python3-trajectory-msgs \
          python3-numpy ros-robot-state-publisher tf2-tools
        ;;
      debian/test)
        echo libgtest-dev libgmock-dev librapidcheck-dev libsundials-dev librostest-dev \
          python3-rostest python3-rosunit python3-matplotlib python3-numpy doxygen \
          parallel openssh-server openssh-client slurm-wlm munge  # for sweeps
        ;;
      debian/bench) echo libbenchmark-dev libbullet-dev valgrind ;;
      debian/picture) echo python3-matplotlib python3-numpy ;;
      debian/rviz) echo rviz librviz-dev qtbase5-dev ;;  # to show, and to build the plugin
      debian/photo) echo xvfb xauth imagemagick xdotool ;;  # a screen and its mouse
      debian/clang) echo clang libclang-rt-dev ;;  # the second compiler, with its sanitizers
      debian/lint) echo clang clang-tidy ;;
      debian/api) echo doxygen ;;

      noetic/build)
        echo g++ make cmake ros-noetic-catkin python3 \
          libeigen3-dev libyaml-cpp-dev nlohmann-json3-dev libcereal-dev libtinyxml2-dev \
          ros-noetic-message-generation ros-noetic-message-runtime ros-noetic-roscpp \
          ros-noetic-roslib ros-noetic-rosbag ros-noetic-std-msgs ros-noetic-geometry-msgs \
          ros-noetic-nav-msgs ros-noetic-sensor-msgs ros-noetic-shape-msgs \
          ros-noetic-visualization-msgs ros-noetic-diagnostic-msgs \
          ros-noetic-diagnostic-updater ros-noetic-dynamic-reconfigure \
          ros-noetic-interactive-markers ros-noetic-tf2 ros-noetic-tf2-ros \
          ros-noetic-tf2-geometry-msgs \
          ros-noetic-actionlib ros-noetic-actionlib-msgs ros-noetic-rosgraph-msgs \
          ros-noetic-trajectory-msgs ros-noetic-control-msgs ros-noetic-urdf
        ;;
      noetic/run)
        echo ros-noetic-rosbash ros-noetic-roslaunch ros-noetic-rostopic ros-noetic-rosservice \
          ros-noetic-rosnode ros-noetic-rosparam ros-noetic-rosmsg ros-noetic-rospy python3-numpy \
          ros-noetic-robot-state-publisher
        ;;
      noetic/test)  # without RapidCheck: the property tests are left out there
        echo libgtest-dev libgmock-dev ros-noetic-rostest ros-noetic-rosunit python3-matplotlib \
          python3-numpy doxygen parallel openssh-server openssh-client slurm-wlm munge
        ;;
      noetic/bench) echo libbenchmark-dev libbullet-dev valgrind ;;
      noetic/picture) echo python3-matplotlib python3-numpy ;;
      noetic/rviz) echo ros-noetic-rviz qtbase5-dev ;;
      noetic/photo) echo xvfb xauth imagemagick xdotool ;;
      noetic/clang) echo clang ;;
      noetic/lint) echo clang clang-tidy ;;
      noetic/api) echo doxygen ;;
      *) die "no package list called '$group' for $ros_flavour" ;;
    esac
  done
}

# missing_packages <package>...: prints those that are not installed.
missing_packages() {
  local installed package
  installed=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' "$@" 2>/dev/null || true)
  for package in "$@"; do
    grep -qxF "$package installed" <<<"$installed" || echo "$package"
  done
}

# need <group>...: installs the missing packages of these groups, as root or with sudo.
need() {
  local packages missing as_root=()
  read -ra packages <<<"$(packages_for "$@" | tr '\n' ' ')"
  read -ra missing <<<"$(missing_packages "${packages[@]}" | tr '\n' ' ')"
  if [[ ${#missing[@]} -eq 0 ]]; then
    say "packages ($*): all ${#packages[@]} are there"
    return
  fi

  if [[ $(id -u) -ne 0 ]]; then
    command -v sudo >/dev/null || die "these packages are missing, and this is neither root nor" \
      "a user with sudo: ${missing[*]} (as root: apt-get install ${missing[*]})"
    as_root=(sudo)
    if [[ ! -t 0 ]]; then as_root=(sudo -n); fi  # without a terminal nobody can type a password
  fi

  local log=$repo_root/.ws/log/apt.log
  mkdir -p "${log%/*}"
  say "packages ($*): installing ${#missing[@]} missing ones and their dependencies (log: $log)"
  printf '     %s\n' "${missing[*]}"
  local start=$SECONDS
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -y -q
    -o DPkg::Lock::Timeout=600 -o Acquire::Retries=3)
  # A failed update need not stop the run: the package lists from before may suffice.
  "${apt[@]}" update >"$log" 2>&1 || warn "apt-get update failed, see $log"
  if ! "${apt[@]}" install --no-install-recommends "${missing[@]}" >>"$log" 2>&1; then
    tail -n 15 "$log" >&2
    die "apt-get could not install ${missing[*]} (whole log: $log)"
  fi
  say "packages: installed in $((SECONDS - start)) s"
}

# ---- environment ---------------------------------------------------------------------------------

# Puts the system's programs first on PATH: ROS's Python modules are installed for /usr/bin/python3, not
# for a python3 of pyenv or conda.
use_system_python() {
  local first
  first=$(command -v python3 || true)
  export PATH="/usr/bin:/bin:/usr/sbin:/sbin:$PATH"
  if [[ -n $first && $(readlink -f "$first") != "$(readlink -f /usr/bin/python3)" ]]; then
    say "python: the first on PATH is $first; using /usr/bin/python3, which ROS is installed for"
  fi
  unset PYTHONHOME VIRTUAL_ENV
}

# Makes ROS use the name localhost. Every process that these scripts start is on this machine, and
# roslaunch fails where the host's own name does not resolve, as in many containers.
use_local_ros() {
  if [[ -z ${ROS_HOSTNAME:-} && -z ${ROS_IP:-} ]]; then
    export ROS_HOSTNAME=localhost
  fi
  if [[ $ros_flavour == noetic ]]; then source_setup /opt/ros/noetic/setup.bash; fi
}

# source_setup <file>: sources a setup file of ROS, which may read unset variables.
source_setup() {
  set +u
  # shellcheck disable=SC1090
  source "$1"
  set -u
}

# prepare <group>...: checks the system, installs packages and sets the environment.
prepare() {
  detect_system
  need "$@"
  use_system_python
  use_local_ros
}

# ---- the workspace -------------------------------------------------------------------------------

# build_jobs: prints how many compilers to run: one for each core, as far as memory goes (2 GiB each).
build_jobs() {
  local cores memory_gib
  cores=$(nproc)
  memory_gib=$(awk '/^MemAvailable:/ { print int($2 / 1048576) }' /proc/meminfo 2>/dev/null || true)
  local jobs=$((${memory_gib:-4} / 2))
  ((jobs > cores)) && jobs=$cores
  ((jobs < 1)) && jobs=1
  echo "$jobs"
}

# link_package <workspace>: makes src/cloth_sim a folder of links to the folders of the repository.
#
# A single link to the whole repository would contain the workspace and thus itself. rosrun follows
# links when it looks for a program; it would complain of the loop, and with an install space it would
# ask which of two equal programs to start. *.xml files are copied, because `make install` copies a
# link as a link.
link_package() {
  local package=$1/src/cloth_sim entry name
  if [[ -L $package ]]; then rm "$package"; fi
  mkdir -p "$package"
  for entry in "$package"/*; do  # links to folders that the repository no longer has
    if [[ ! -e $repo_root/${entry##*/} ]]; then rm -f "$entry"; fi
  done
  for entry in "$repo_root"/*; do
    name=${entry##*/}
    case $name in
      build | devel | install | logs) ;;  # folders of another workspace
      *.xml)
        if [[ -L $package/$name ]] || ! cmp -s "$entry" "$package/$name"; then
          cp --remove-destination "$entry" "$package/$name"
        fi
        ;;
      *)
        if [[ -d $entry || $name == CMakeLists.txt || $name == setup.py ]]; then
          ln -sfn "../../../$name" "$package/$name"
        fi
        ;;
    esac
  done
}

# configuration_inputs <cmake argument>...: prints everything on which the result of configuring
# depends: the compiler, CMake's arguments, and the versions of the packages that CMake looks for.
configuration_inputs() {
  local packages
  echo "compiler: ${CC:-} ${CXX:-}"
  echo "arguments: $*"
  read -ra packages <<<"$(packages_for build run test bench rviz | tr '\n' ' ')"
  dpkg-query -W -f '${Package} ${Version} ${db:Status-Status}\n' "${packages[@]}" 2>/dev/null |
    grep ' installed$' | sort || true
}

# drop_stale_configuration <workspace> <cmake argument>...: removes CMake's cache if it was made from
# other inputs than these, so that the next build configures afresh: CMake searches again for every
# package, and forgets arguments that are no longer given. Compiled files stay; they are compiled again
# only if their own command line changes. With another compiler, the whole build is removed.
drop_stale_configuration() {
  local workspace=$1 inputs
  shift
  local record=$workspace/configured_from cache=$workspace/build/CMakeCache.txt
  inputs=$(configuration_inputs "$@")
  if [[ -f $cache ]]; then
    if ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$workspace/src" "$cache"; then
      say "workspace: it was built elsewhere and moved here; building it anew"
      rm -rf "$workspace/build" "$workspace/devel"
    elif [[ -f $record && $(head -n 1 "$record") != "${inputs%%$'\n'*}" ]]; then
      say "workspace: another compiler; building it anew"
      rm -rf "$workspace/build" "$workspace/devel"
    elif [[ ! -f $record || $(<"$record") != "$inputs" ]]; then
      say "workspace: packages or arguments changed; configuring it afresh"
      rm -f "$cache"
    fi
  fi
  printf '%s\n' "$inputs" >"$record"
}

# leave_workspace <workspace>: takes a workspace that the user has sourced out of the paths. catkin
# keeps what the workspace adds to the paths for the tests; where it configures with the workspace in
# them, that is nothing, and tests that another shell starts find no program.
leave_workspace() {
  local name entry kept
  for name in CMAKE_PREFIX_PATH LD_LIBRARY_PATH PATH PKG_CONFIG_PATH PYTHONPATH ROS_PACKAGE_PATH; do
    kept=
    while IFS= read -r -d : entry; do
      if [[ -n $entry && $entry != "$1"/* ]]; then kept+=${kept:+:}$entry; fi
    done <<<"${!name:-}:"
    if [[ -n $kept ]]; then export "$name=$kept"; else unset "$name"; fi
  done
}

# build_workspace <workspace> <make targets> [cmake argument]...: configures if necessary, and builds.
#
# CLOTH_SIM_HIDE names packages that CMake shall not find although they are installed; .ci/run uses it
# to test the scripts as on a machine without these packages.
build_workspace() {
  local workspace=$1 targets=$2 name
  shift 2
  for name in ${CLOTH_SIM_HIDE:-}; do set -- "$@" "-DCMAKE_DISABLE_FIND_PACKAGE_$name=TRUE"; done
  mkdir -p "$workspace/log"
  exec 9>"$workspace/log/lock"
  if ! flock -n 9; then
    say "build: another build is running in $workspace; waiting for it"
    flock 9
  fi
  link_package "$workspace"
  leave_workspace "$workspace"
  drop_stale_configuration "$workspace" "$@"

  # catkin gives tests only those folders of the workspace that exist when it configures. In a new
  # workspace, the first run of the tests would not find the Python modules of the messages.
  local modules=$workspace/devel/lib/python3/dist-packages
  local paths=$workspace/build/catkin_generated/setup_cached.sh  # see leave_workspace
  if [[ ! -f $workspace/build/CMakeCache.txt || ! -d $modules ]] ||
    ! grep -qsF "$workspace/devel" "$paths"; then
    mkdir -p "$modules"
    set -- --force-cmake "$@"
  fi

  local jobs log=$workspace/log/build.log
  jobs=$(build_jobs)
  say "build: $workspace, $jobs at a time (log: $log)"
  local command=(catkin_make -C "$workspace" -j"$jobs" -DPYTHON_EXECUTABLE=/usr/bin/python3
    "$@" --make-args)
  # shellcheck disable=SC2206
  command+=($targets)
  local status=0
  "${command[@]}" 2>&1 </dev/null 9>&- | tee "$log" | show_build || status=$?
  exec 9>&-
  if [[ $status -ne 0 ]]; then
    grep -nE -A6 'error:|CMake Error|Error [0-9]+$' "$log" | tail -n 60 >&2 || true
    die "the build failed (whole log: $log)"
  fi
}

# show_build: reduces the output of a build to the lines that its reader wants to see: compiling,
# linking, errors, and this package's own messages.
show_build() {
  grep --line-buffered -E 'Building CXX|Linking CXX|warning:|[Ee]rror|cloth_sim: ' || true
}

# enter_workspace <workspace>: puts its programs and messages on every search path.
enter_workspace() {
  source_setup "$1/devel/setup.bash"
}
