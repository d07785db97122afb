#!/usr/bin/env bash
# Fails if the core includes a header of ROS, or of the folders that may include ROS.
#
# On Debian 12 the compiler cannot check this, because ROS's headers are in /usr/include. The linker
# checks it for symbols (cloth_core is linked with --no-undefined); this script checks it for headers.
# Every build runs it; by hand: scripts/check_layering.sh [package folder]
set -euo pipefail

cd "${1:-"$(dirname "${BASH_SOURCE[0]}")/.."}"

core_folders=(support threads mesh cloth linalg constraints solver contact clamp surgery scene sim study)
# Forbidden are ros/..., *_msgs/..., the ROS libraries, this package's generated messages
# (cloth_sim/Frame.h), and its folders that use ROS.
libraries='rosbag|rviz|roslib|tf2?|tf2_[a-z_]+|diagnostic_updater|dynamic_reconfigure'
libraries+='|interactive_markers|actionlib|message_filters|pluginlib|urdf|urdf_[a-z]+'
forbidden='^[[:space:]]*#[[:space:]]*include[[:space:]]*[<"]'
forbidden+="((ros|[a-z0-9_]+_msgs|std_srvs|$libraries)/"
forbidden+='|(cloth_sim/)?(ros|rviz|tools|node)/|cloth_sim/[A-Z])'

paths=()
for folder in "${core_folders[@]}"; do
  for path in "include/cloth_sim/$folder" "src/$folder"; do
    [[ -d $path ]] && paths+=("$path")
  done
done
for path in include/cloth_sim/*.h; do
  [[ -f $path ]] && paths+=("$path")
done
[[ ${#paths[@]} -gt 0 ]] || exit 0

if grep -rnE --include='*.h' --include='*.cpp' "$forbidden" "${paths[@]}"; then
  echo "error: the core (${core_folders[*]}) may not include ROS; that belongs in src/ros" >&2
  exit 1
fi
