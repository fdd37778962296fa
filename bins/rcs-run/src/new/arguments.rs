//! The command line of `rcs-run new`.

use crate::pages::{DataArgument, length};
use clap::{Args, Subcommand};

use super::size::Size;

/// Arguments of `new`.
#[derive(Clone, Debug, Args)]
pub struct NewArguments {
    /// What is new
    #[command(subcommand)]
    pub what: NewItem,
}

/// What is new.
#[derive(Clone, Debug, Subcommand)]
pub enum NewItem {
    /// A part like an existing one, of another size: forms, movetables, entries of the cell and a job
    ///
    /// A box gets a program of the vise; a cylinder gets places in the nests of the part of --like. The data are tested
    /// in a copy: check, three runs of the job, and one run of each other job if the jaws of the vise get a new step.
    /// Data that fail are not written.
    Part(PartArguments),
    /// A tool in a holder for the tool gripper: forms, entries of the cell and a job
    ///
    /// The data are tested in a copy: check, then the job of the tool of --like, three runs with the new tool instead
    /// of that tool and three instead of each other tool. Data that fail are not written.
    Tool(ToolArguments),
    /// A location for the robot: a pose, a location point, and the trajectories and approaches of another place
    ///
    /// The data are tested in a copy by check. Data that fail are not written.
    Place(PlaceArguments),
    /// A tray with the sections, camera views and trajectories of another one
    ///
    /// The data are tested in a copy: check, and three runs of a job of the other tray, changed to take its part from
    /// the new one. Data that fail are not written.
    Tray(TrayArguments),
}

/// Arguments of `new part`.
#[derive(Clone, Debug, Args)]
pub struct PartArguments {
    /// Name of the part: capital letters and digits, 11 at most
    #[arg(value_name = "NAME")]
    pub name: String,
    /// Size of the blank as it lies in its tray, in the units of --units: length x width x height, where the fingers close on the width;
    /// for a cylinder length x diameter
    #[arg(long, value_name = "LxWxH|LxD")]
    pub size: Size,
    /// A part of the cell; the new part is handled like this one
    #[arg(long, value_name = "PART")]
    pub like: String,
    /// Write the files; without this option they are only shown
    #[arg(long)]
    pub write: bool,
    /// Print the paths of all lines of the job, as `check --explain-job` does
    #[arg(long)]
    pub explain_job: bool,
    /// The data.
    #[command(flatten)]
    pub data: DataArgument,
}

/// Arguments of `new tool`.
#[derive(Clone, Debug, Args)]
pub struct ToolArguments {
    /// Name of the tool: capital letters, digits and -, 11 at most
    #[arg(value_name = "NAME")]
    pub name: String,
    /// Length x diameter of the holder, in the units of --units [default: those of the tool of --like]
    #[arg(long, value_name = "LxD")]
    pub size: Option<Size>,
    /// Weight, pounds [default: scaled by volume from the tool of --like]
    #[arg(long, value_name = "LB")]
    pub weight: Option<f64>,
    /// A tool of the cell; the new tool is handled like this one
    #[arg(long, value_name = "TOOL")]
    pub like: String,
    /// Write the files; without this option they are only shown
    #[arg(long)]
    pub write: bool,
    /// Print the paths of all lines of the job, as `check --explain-job` does
    #[arg(long)]
    pub explain_job: bool,
    /// The data.
    #[command(flatten)]
    pub data: DataArgument,
}

/// Arguments of `new place`.
#[derive(Clone, Debug, Args)]
#[command(allow_negative_numbers = true)]
pub struct PlaceArguments {
    /// Name of the place: capital letters, digits and _, 8 at most
    #[arg(value_name = "NAME")]
    pub name: String,
    /// The tool point, in the units of --units
    #[arg(value_names = ["X", "Y", "Z"], num_args = 3, required = true, value_parser = length)]
    pub point: Vec<f64>,
    /// Direction in which the tool leans, degrees from the X axis of the world; the finger point is horizontal, 90
    /// degrees further
    #[arg(long, value_name = "DEGREES", default_value_t = -90.0)]
    pub azimuth: f64,
    /// How far the tool leans from straight down, degrees
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0)]
    pub tilt: f64,
    /// Rotation of the finger point about the axis of the tool, degrees
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0)]
    pub roll: f64,
    /// A location point; the new place is reached like this one
    #[arg(long, value_name = "PLACE")]
    pub like: String,
    /// Write the files; without this option they are only shown
    #[arg(long)]
    pub write: bool,
    /// The data.
    #[command(flatten)]
    pub data: DataArgument,
}

/// Arguments of `new tray`.
#[derive(Clone, Debug, Args)]
#[command(allow_negative_numbers = true)]
pub struct TrayArguments {
    /// Name of the tray: capital letters, digits and _, 8 at most
    #[arg(value_name = "NAME")]
    pub name: String,
    /// The centre of the tray, in the units of --units
    #[arg(value_names = ["X", "Y"], num_args = 2, required = true, value_parser = length)]
    pub centre: Vec<f64>,
    /// A tray of the cell; the new tray is used like this one
    #[arg(long, value_name = "UNIT")]
    pub like: String,
    /// Write the files; without this option they are only shown
    #[arg(long)]
    pub write: bool,
    /// The data.
    #[command(flatten)]
    pub data: DataArgument,
}
