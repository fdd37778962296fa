#!/bin/sh
# Makes the pictures of docs/cell.md from runs of today: viewers/moments.sh, in the root of the repository. See moments.py.
set -e
for job in linkbar clevis tool-change; do
    cargo run --release -- data/jobs/$job.job --log runs/$job.mcap
done
python3 viewers/film.py runs/linkbar.mcap docs/cell.png --tick 2490 --size 1000 620 --samples 16
python3 viewers/moments.py runs/linkbar.mcap docs/linkbar.png \
    "760 part_1 the second picture is taken" \
    "1335 parts_gripper the blank is grasped in sector 4" \
    "2490 parts_gripper over the ledge of the vise" \
    "2545 parts_gripper let go, fallen onto the ledge" \
    "3416 parts_gripper pushed against the back" \
    "5505 parts_gripper the linkbar is let go in sector 1"
python3 viewers/moments.py runs/clevis.mcap docs/clevis.png \
    "1305 parts_gripper the blank is grasped in sector 3" \
    "3420 parts_gripper pushed to its seat" \
    "5430 pedestal_hand the pedestal's hand has it" \
    "6120 pedestal_hand turned by 180 degrees, it is grasped anew" \
    "6960 parts_gripper half done, back in the vise" \
    "10130 parts_gripper the clevis is let go in sector 2"
python3 viewers/moments.py runs/tool-change.mcap docs/tool-change.png --eye -0.55 -0.85 0.55 \
    "940 parts_gripper GRIPPER-1 is left in its holster" \
    "1680 tool_gripper GRIPPER-3 is locked on, and out" \
    "2985 tool_gripper DRILL-2 is gripped in the drum" \
    "3380 tool_gripper pulled out, past the strike plate" \
    "6340 tool_gripper ENDMILL-1 is inserted" \
    "6900 tool_gripper let go"
