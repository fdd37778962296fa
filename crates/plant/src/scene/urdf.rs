//! Prints a scene as URDF: boxes and cylinders, in metres.

use std::fmt::Write as _;

use core::f64::consts::FRAC_PI_2;

use geometry::frame::{Frame, Rotation, Vector as Inches};

use super::{JointKind, Link, Motion, ROOT, Scene, Shape, Visual};
use crate::convert::{metres, to_metres};

impl Scene<'_> {
    #[must_use]
    pub fn urdf(&self) -> String {
        let name = escaped(&self.cell.name);
        let mut text =
            format!("<?xml version=\"1.0\"?>\n<robot name=\"{name}\">\n  <link name=\"{ROOT}\"/>\n");
        let _ = self.links.iter().try_for_each(|link| put(link, &mut text));
        text + "</robot>\n"
    }
}

fn put(link: &Link<'_>, text: &mut String) -> std::fmt::Result {
    let name = escaped(&link.name);
    writeln!(text, "  <link name=\"{name}\">")?;
    for Visual { frame, shape, colour } in &link.visuals {
        let (frame, geometry) = match shape {
            Shape::Box(size) => {
                let size = to_metres(size);
                (*frame, format!("<box size=\"{} {} {}\"/>", size.x, size.y, size.z))
            }
            Shape::Cylinder(radius, length) => {
                // A cylinder of a URDF lies along Z.
                let along_x = Rotation::from_axis_angle(&Inches::y_axis(), FRAC_PI_2);
                let (radius, length) = (metres(*radius), metres(*length));
                (frame.turned(&along_x), format!("<cylinder radius=\"{radius}\" length=\"{length}\"/>"))
            }
        };
        let ([red, green, blue], origin) = (colour.colour(), origin(&frame));
        let colour = format!("{red:.2} {green:.2} {blue:.2} 1");
        writeln!(
            text,
            "    <visual>{origin}<geometry>{geometry}</geometry><material name=\"{colour}\">\
             <color rgba=\"{colour}\"/></material></visual>"
        )?;
    }
    let (kind, motion) = match link.joint.kind {
        JointKind::Fixed => ("fixed", None),
        JointKind::Floating => ("floating", None),
        JointKind::Revolute(motion) => ("revolute", Some(motion)),
        JointKind::Prismatic(motion) => ("prismatic", Some(motion)),
    };
    let motion = motion.map_or_else(String::new, |motion| {
        let Motion { axis: [x, y, z], range: (low, high), speed, effort } = motion;
        format!(
            "<axis xyz=\"{x} {y} {z}\"/><limit lower=\"{low}\" upper=\"{high}\" effort=\"{effort}\" \
             velocity=\"{speed}\"/>"
        )
    });
    writeln!(
        text,
        "  </link>\n  <joint name=\"{}\" type=\"{kind}\"><parent link=\"{}\"/><child link=\"{name}\"/>{}{motion}</joint>",
        escaped(&link.joint.name),
        link.parent,
        origin(&link.joint.start),
    )
}

/// An origin element: metres, and fixed-axis roll, pitch, yaw.
fn origin(frame: &Frame) -> String {
    let p = to_metres(&frame.position);
    let (roll, pitch, yaw) = frame.rotation.euler_angles();
    format!("<origin xyz=\"{} {} {}\" rpy=\"{roll} {pitch} {yaw}\"/>", p.x, p.y, p.z)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
