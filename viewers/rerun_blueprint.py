#!/usr/bin/env python3
"""Writes the arrangement of views in which viewers/rerun.sh opens a converted log in Rerun.

    pip install rerun-sdk
    python3 viewers/rerun_blueprint.py --application linkbar --output cell.rbl

The cell moves on the left; beside it are the curves of the joints, the picture of the camera, the rows of all processes and the
lines of the log. Rerun takes an arrangement only for recordings of one application: the name of the log.
"""

import argparse
from pathlib import Path

import rerun.blueprint as rrb

EYE = rrb.EyeControls3D(
    kind=rrb.Eye3DKind.Orbital,
    position=(0.7, -5.6, 1.6),
    look_target=(0.3, -0.35, -0.3),
    eye_up=(0.0, 0.0, 1.0),
)


def blueprint() -> rrb.Blueprint:
    """The cell, curves, rows, the log, and the camera's picture: with the recording of rerun_meshes.py."""
    joints = rrb.TimeSeriesView(origin="/joints", name="Joints (degrees)", plot_legend=rrb.PlotLegend(visible=True))
    below = rrb.Tabs(
        rrb.TextDocumentView(origin="/rows", name="Rows"),
        rrb.TextLogView(origin="/log", name="Log"),
    )
    beside = rrb.Spatial2DView(origin="/vision", name="What vision saw")
    curves = rrb.Vertical(rrb.Horizontal(joints, beside, column_shares=[3, 2]), below, row_shares=[2, 3])
    cell = rrb.Spatial3DView(
        origin="/",
        contents=["/meshes/**", "/names/**", "/marks/**", "/tf/**", "/tf_static/**"],
        name="Cell",
        background=rrb.Background(color=(205, 214, 222)),
        line_grid=rrb.LineGrid3D(visible=False),
        eye_controls=EYE,
        spatial_information=rrb.SpatialInformation(target_frame="world"),
    )
    return rrb.Blueprint(
        rrb.Horizontal(cell, curves, column_shares=[3, 2]),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline="message_log_time", play_state="playing", loop_mode="all"),
        auto_views=False,
        auto_layout=False,
    )


def main() -> None:
    """Write the file."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, required=True)
    parser.add_argument("--application", required=True, help="the name of the log without .mcap")
    arguments = parser.parse_args()
    blueprint().save(arguments.application, str(arguments.output))


if __name__ == "__main__":
    main()
