#!/bin/sh
# Opens a log in Rerun as a cell with meshes, curves and log lines beside each other: viewers/rerun.sh runs/linkbar.mcap [OPTIONS OF RERUN]
#
#     pip install rerun-sdk mcap mcap-protobuf-support
#
# Rerun draws neither models nor texts of foxglove.SceneUpdate, and applies no arrangement to a log that it converts itself:
# the log is converted, merged with its meshes (rerun_meshes.py), and opened with an arrangement for its name. Rerun listens on
# 127.0.0.1 only.
set -eu
log=$1
shift
here=$(dirname "$0")
name=$(basename "$log" .mcap)
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
rerun mcap convert "$log" --application-id "$name" --recording-id "$name" -o "$folder/log.rrd"
python3 "$here/rerun_meshes.py" "$log" "$folder/meshes.rrd" --application "$name" --recording "$name"
python3 "$here/rerun_blueprint.py" --application "$name" --output "$folder/cell.rbl"
rerun rrd merge "$folder/log.rrd" "$folder/meshes.rrd" -o "$folder/$name.rrd"
rerun --bind 127.0.0.1 "$folder/$name.rrd" "$folder/cell.rbl" "$@"
