#!/usr/bin/env python3
"""Writes cell.rbl, the arrangement of views in which Rerun shows the log of a run.

    pip install rerun-sdk
    python3 viewers/rerun_blueprint.py          # writes viewers/cell.rbl

The cell moves on the left; beside it are the curves of the joints, the picture of the camera, the rows of all processes and the
lines of the log. Everything else in the log can be dragged in from the list of streams. Rerun takes an arrangement for recordings of one application: cell.rbl is
for `linkbar`. viewers/rerun.sh converts a log, adds its meshes and opens it with an arrangement for its name; `rerun LOG
viewers/cell.rbl` shows Rerun's own views instead.
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


def blueprint(meshes: bool) -> rrb.Blueprint:
    """The cell, curves, the log; with the recording of rerun_meshes.py also meshes, rows and the camera's picture."""
    if meshes:
        joints = rrb.TimeSeriesView(origin="/joints", name="Joints (degrees)", plot_legend=rrb.PlotLegend(visible=True))
        below = rrb.Tabs(
            rrb.TextDocumentView(origin="/rows", name="Rows"),
            rrb.TextLogView(origin="/log", name="Log"),
        )
        beside = rrb.Spatial2DView(origin="/vision", name="What vision saw")
        curves = rrb.Vertical(rrb.Horizontal(joints, beside, column_shares=[3, 2]), below, row_shares=[2, 3])
    else:
        joints = rrb.TimeSeriesView(
            origin="/joint_states/position", name="Joints (rad, m)", plot_legend=rrb.PlotLegend(visible=False)
        )
        curves = rrb.Vertical(joints, rrb.TextLogView(origin="/log", name="Log"))
    cell = rrb.Spatial3DView(
        origin="/",
        contents=["/meshes/**", "/names/**", "/marks/**", "/tf/**", "/tf_static/**"] if meshes else "/**",
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
    parser.add_argument("--output", type=Path, default=Path(__file__).with_name("cell.rbl"))
    parser.add_argument("--application", default="linkbar", help="the name of the log without .mcap")
    parser.add_argument("--meshes", action="store_true", help="for a recording with those of rerun_meshes.py")
    arguments = parser.parse_args()
    blueprint(arguments.meshes).save(arguments.application, str(arguments.output))


if __name__ == "__main__":
    main()
