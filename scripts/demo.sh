#!/bin/bash
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.bash"

usage() {
  cat <<'TEXT'
usage: demo.sh [MAV0_DIR | SEQUENCE_DIR | DRIVE_DIR | BAG] [--rig FILE] [--rate FACTOR] [NAME:=VALUE ...]

Replays a recording through the nodelet and compares the odometry with ground truth:
  without argument   a simulated handheld stereo camera with IMU
  MAV0_DIR           EuRoC (ASL format): cam0, cam1, ..., imu0
  SEQUENCE_DIR       KITTI odometry (calib.txt, times.txt, image_0, ...); with ../../poses/NN.txt an IMU is derived
  DRIVE_DIR          KITTI raw drive (oxts, image_00, ...)
  BAG                rig from --rig, else BAG's name with .rig.yaml, else CameraInfo and TF in the bag; ground truth
                     from its name with .groundtruth.tum
  --rig FILE         rig YAML or Kalibr's camchain-imucam.yaml
  --rate FACTOR      replay at this multiple of real time (default 1)
  NAME:=VALUE        arguments of launch/egomotion.launch, such as use_imu:=false or imu_topic:=/imu/data

Left in demo/ under the package: odometry.bag (outputs), evaluation.txt, evaluation.json, trajectory.png and rviz.png.
TEXT
}

fail() {
  echo "demo.sh: $*" >&2
  exit 1
}

input='' rig='' rate=1
launch_arguments=()
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --rig | --rate) [[ $# -ge 2 ]] || fail "$1: found nothing, expected a value"
      if [[ $1 == --rig ]]; then rig=$2; else rate=$2; fi
      shift ;;
    *:=*) launch_arguments+=("$1") ;;
    -*) fail "found option $1 (see --help)" ;;
    *) [[ -z $input ]] || fail "found a second input, $1, expected one"
      input=$1 ;;
  esac
  shift
done
[[ -z $input || -e $input ]] || fail "$input: not found, expected a directory or a bag"
[[ -z $rig || -f $rig ]] || fail "$rig: not found, expected a rig file"
input=${input:+$(realpath "$input")}
rig=${rig:+$(realpath "$rig")}

# --- Build ------------------------------------------------------------------------------------------------------------
"$package/scripts/setup.sh" --rviz
configure "$build"
cmake --build "$build" -j "$jobs"
source_ros "$build/devel/setup.bash"

# --- Recording --------------------------------------------------------------------------------------------------------
demo=$package/demo
rm -rf "$demo"
mkdir -p "$demo"
export ROS_HOME=$demo/ros_home
bag=$demo/input.bag
truth=$demo/input.groundtruth.tum
if [[ -z $input ]]; then
  echo "Simulating handheld_stereo"
  "$build/devel/lib/multicam_egomotion/egomotion_sim" handheld_stereo "$bag"
elif [[ -f $input ]]; then
  bag=$input
  truth=${input%.bag}.groundtruth.tum
elif [[ -d $input/cam0 || -d $input/mav0 ]]; then
  [[ -d $input/cam0 ]] || input=$input/mav0
  "$package/scripts/euroc_to_bag.py" "$input" "$bag"
elif [[ -f $input/calib.txt ]]; then
  poses=$(dirname "$(dirname "$input")")/poses/$(basename "$input").txt
  arguments=()
  [[ ! -f $poses ]] || arguments=(--poses "$poses")
  "$package/scripts/kitti_to_bag.py" "$input" "$bag" "${arguments[@]}"
elif [[ -d $input/oxts ]]; then
  "$package/scripts/kitti_to_bag.py" --raw "$input" "$bag"
else
  fail "$input: found no cam0, mav0, calib.txt or oxts, expected a EuRoC or KITTI recording (see --help)"
fi
if [[ -z $rig && -f ${bag%.bag}.rig.yaml ]]; then
  rig=${bag%.bag}.rig.yaml
  grep -q '^imu:' "$rig" || launch_arguments=(use_imu:=false "${launch_arguments[@]}")
fi

# --- Replay -----------------------------------------------------------------------------------------------------------
started=()
stop() {  # stop PID: asks it to end, and waits until its files are closed
  local signal
  for signal in INT TERM KILL; do
    kill -"$signal" "$1" 2>/dev/null || return 0
    for _ in $(seq 60); do
      kill -0 "$1" 2>/dev/null || return 0
      sleep 0.1
    done
  done
}
clean_up() {  # ends what this script started, last first
  trap - EXIT
  for ((i = ${#started[@]} - 1; i >= 0; --i)); do stop "${started[i]}"; done
}
trap clean_up EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
background() {  # background LOG COMMAND ...
  local log=$demo/$1
  shift
  "$@" >"$log" 2>&1 &
  started+=($!)
  disown
}
wait_until() {  # wait_until SECONDS WHAT COMMAND ...
  local deadline=$((SECONDS + $1)) what=$2
  shift 2
  until ("$@") >/dev/null 2>&1; do
    [[ $SECONDS -lt $deadline ]] || fail "$what did not start in time; logs are in $demo"
    for pid in "${started[@]}"; do
      kill -0 "$pid" 2>/dev/null || fail "$what did not start; logs are in $demo"
    done
    sleep 0.3
  done
}

has_line() {  # has_line TEXT COMMAND ...
  local text=$1
  shift
  "$@" | grep -qF -- "$text"
}

port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("", 0)); print(s.getsockname()[1])')
export ROS_MASTER_URI=http://127.0.0.1:$port
background roscore.log roscore -p "$port"
wait_until 60 roscore rosparam set /use_sim_time true

# rviz draws in software on a screen of its own, at the lowest priority: the nodelet comes first.
background xvfb.log Xvfb -displayfd 1 -screen 0 1400x900x24 -nolisten tcp
wait_until 30 Xvfb grep -q '[0-9]' "$demo/xvfb.log"
DISPLAY=:$(grep -m1 -o '^[0-9]*$' "$demo/xvfb.log")
export DISPLAY LIBGL_ALWAYS_SOFTWARE=1 LP_NUM_THREADS=1 QT_X11_NO_MITSHM=1
background rviz.log nice -n 19 rviz -d "$package/config/egomotion.rviz" __name:=rviz
wait_until 120 rviz has_line /rviz rostopic info /odometry

background record.log rosrun rosbag record -O "$demo/odometry.bag" \
  odometry relative_pose ego_motion diagnostics tf tf_static
recorder=${started[-1]}
wait_until 60 'rosbag record' has_line /record rostopic info /odometry
background egomotion.log roslaunch multicam_egomotion egomotion.launch ${rig:+rig:="$rig"} "${launch_arguments[@]}"
launched=${started[-1]}
wait_until 120 'the nodelet' has_line /egomotion/set_pose rosservice list

echo "Replaying $bag"
background play.log rosrun rosbag play --quiet --clock --delay 3 --rate "$rate" "$bag"
player=${started[-1]}
while kill -0 "$player" 2>/dev/null; do
  kill -0 "$launched" 2>/dev/null || fail "the nodelet ended: $(tail -n 5 "$demo/egomotion.log")"
  sleep 0.5
done
grep -q '^Done' "$demo/play.log" || fail "rosbag play failed: $(tail -n 2 "$demo/play.log")"
sleep 3
stop "$recorder"
import -window root "$demo/rviz.png"
clean_up

# --- Evaluation -------------------------------------------------------------------------------------------------------
read -r images poses < <(python3 - "$bag" "$demo/odometry.bag" <<'TEXT'
import sys

import rosbag

with rosbag.Bag(sys.argv[1]) as bag:
    images = [topic.message_count for topic in bag.get_type_and_topic_info().topics.values()
              if topic.msg_type in ("sensor_msgs/Image", "sensor_msgs/CompressedImage")]
with rosbag.Bag(sys.argv[2]) as bag:
    print(max(images, default=0), bag.get_message_count(["/odometry", "odometry"]))
TEXT
)
[[ $poses -gt 0 ]] || fail "found no odometry, expected some; see $demo/egomotion.log"
echo "$poses poses, $images images of a camera"
if [[ $((poses * 10)) -lt $((images * 9)) ]]; then
  echo "Images were dropped: is this machine too busy for real time? (--rate 0.5)"
fi
if [[ -f $truth ]]; then
  "$package/scripts/evaluate.py" "$truth" "$demo/odometry.bag" --json "$demo/evaluation.json" \
    --plot "$demo/trajectory.png" | tee "$demo/evaluation.txt"
  echo "$demo: trajectory.png, rviz.png, evaluation.json"
else
  echo "No ground truth ($truth): no evaluation. $demo: rviz.png"
fi
