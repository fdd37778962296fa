#!/usr/bin/env python3
"""Writes cell.rbl, the arrangement of views in which Rerun shows the log of a run.

    pip install rerun-sdk
    python3 viewers/rerun_blueprint.py          # writes viewers/cell.rbl
    rerun runs/linkbar.mcap viewers/cell.rbl

The cell moves on the left; beside it are the curves of the joints and the lines of the log. Everything else in the log can be
dragged in from the list of streams. Rerun takes an arrangement for the logs of one name: cell.rbl is for linkbar.mcap, and

    python3 viewers/rerun_blueprint.py --application shift --output shift.rbl

makes one for shift.mcap. Without an arrangement Rerun shows the same views, but not beside each other.
"""

import argparse
from pathlib import Path

import rerun.blueprint as rrb

EYE = rrb.EyeControls3D(
    kind=rrb.Eye3DKind.Orbital,
    position=(1.6, -4.2, 2.0),
    look_target=(0.2, 0.0, -0.5),
    eye_up=(0.0, 0.0, 1.0),
)


def blueprint() -> rrb.Blueprint:
    """The cell, the log, and curves."""
    curves = rrb.Vertical(
        rrb.TimeSeriesView(
            origin="/joint_states/position",
            name="Joints (rad, m)",
            plot_legend=rrb.PlotLegend(visible=False),
        ),
        rrb.TextLogView(origin="/log", name="Log"),
    )
    cell = rrb.Spatial3DView(
        origin="/",
        contents="/**",
        name="Cell",
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
    arguments = parser.parse_args()
    blueprint().save(arguments.application, str(arguments.output))


if __name__ == "__main__":
    main()
