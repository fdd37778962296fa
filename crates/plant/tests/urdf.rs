//! The URDF of the cell as a viewer reads it: one tree, every moving joint with an axis and limits.

use std::collections::{BTreeMap, BTreeSet};

use plant::{Cell, CellDescription, Placement, WorkstationAction};
use roxmltree::{Document, Node};

fn cell() -> Cell {
    let text = include_str!("../../../data/cell.toml");
    let mut cell = Cell::new(&CellDescription::from_toml(text).unwrap(), 1).unwrap();
    let (part, unit) = ("LINKBAR1_BH".into(), "UNIT_1".into());
    cell.workstation(&WorkstationAction::Place { part, unit, sector: 1, placement: Placement::Random })
        .unwrap();
    cell
}

fn named<'a>(document: &'a Document<'a>, tag: &'a str) -> impl Iterator<Item = (&'a str, Node<'a, 'a>)> {
    let found = document.root_element().children().filter(move |node| node.has_tag_name(tag));
    found.map(|node| (node.attribute("name").expect("it has a name"), node))
}

fn child<'a>(node: Node<'a, 'a>, tag: &str, attribute: &str) -> &'a str {
    let child = node.children().find(|child| child.has_tag_name(tag));
    child
        .and_then(|child| child.attribute(attribute))
        .unwrap_or_else(|| panic!("no {attribute} of {tag} in {node:?}"))
}

fn numbers(text: &str) -> Vec<f64> {
    text.split(' ').map(|number| number.parse().unwrap_or_else(|_| panic!("{text}"))).collect()
}

#[test]
fn links_and_joints_are_one_tree_with_unique_names() {
    let text = cell().scene(&[]).urdf();
    let document = Document::parse(&text).expect("it is XML");
    assert!(document.root_element().has_tag_name("robot"));
    let links: Vec<&str> = named(&document, "link").map(|(name, _)| name).collect();
    let unique: BTreeSet<&str> = links.iter().copied().collect();
    assert_eq!(unique.len(), links.len(), "names of links are unique");
    let joints: Vec<&str> = named(&document, "joint").map(|(name, _)| name).collect();
    assert_eq!(joints.iter().collect::<BTreeSet<_>>().len(), joints.len(), "names of joints are unique");
    let parents: BTreeMap<&str, &str> = named(&document, "joint")
        .map(|(_, joint)| (child(joint, "child", "link"), child(joint, "parent", "link")))
        .collect();
    assert_eq!(parents.len(), joints.len(), "a link hangs on one joint");
    for link in links.iter().filter(|link| **link != "world") {
        let mut above = *link;
        for _ in 0..links.len() {
            above = parents.get(above).copied().unwrap_or(above);
        }
        assert_eq!(above, "world", "{link} hangs on the world at last");
    }
}

#[test]
fn every_moving_joint_is_within_its_limits() {
    let cell = cell();
    let text = cell.scene(&[]).urdf();
    let document = Document::parse(&text).expect("it is XML");
    let states: BTreeMap<&str, f64> = cell.joint_states().into_iter().collect();
    let mut moving = BTreeSet::new();
    for (name, joint) in named(&document, "joint") {
        let kind = joint.attribute("type").expect("a joint has a type");
        match kind {
            "fixed" | "floating" => continue,
            "revolute" | "prismatic" => {}
            other => panic!("{name}: {other}"),
        }
        let axis = numbers(child(joint, "axis", "xyz"));
        assert!((axis.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-9, "{name}: {axis:?}");
        let limit = |which| numbers(child(joint, "limit", which))[0];
        let (low, high, state) = (limit("lower"), limit("upper"), states[name]);
        assert!(
            low < high && low - 1e-9 <= state && state <= high + 1e-9,
            "{name}: {state} in {low} to {high}"
        );
        assert!(limit("velocity") > 0.0 && limit("effort") >= 0.0, "{name}");
        moving.insert(name);
    }
    assert_eq!(moving, states.keys().copied().collect(), "a stream of joint angles moves all of them");
}

#[test]
fn every_collision_shape_is_in_the_picture() {
    let text = cell().scene(&[]).urdf();
    let document = Document::parse(&text).expect("it is XML");
    let shapes = |link: &str| {
        let link = named(&document, "link").find(|(name, _)| *name == link);
        link.map_or(0, |(_, link)| link.children().filter(|child| child.has_tag_name("visual")).count())
    };
    let expected = [
        "turret",
        "upper_arm",
        "forearm",
        "wrist_yaw",
        "end_plate",
        "quick_change",
        "parts_gripper",
        "v_gripper",
        "tool_gripper",
        "left_finger",
        "right_finger",
        "pedestal_hand",
        "pedestal_left_finger",
        "pedestal_right_finger",
        "vise",
        "movable_jaw",
        "strike_plate",
        "tool_drum",
        "UNIT_1_floor",
        "UNIT_2_near_wall",
        "holster_left_left_cheek",
        "holster_centre_foot",
        "brush_bracket",
        "part_1",
    ];
    for link in expected {
        assert!(shapes(link) > 0, "{link} has no shape");
    }
    for (_, link) in named(&document, "link") {
        for visual in link.children().filter(|child| child.has_tag_name("visual")) {
            assert_eq!(numbers(child(visual, "origin", "xyz")).len(), 3);
            assert_eq!(numbers(child(visual, "origin", "rpy")).len(), 3);
            let geometry =
                visual.children().find(|child| child.has_tag_name("geometry")).expect("a geometry");
            let shape = geometry.first_element_child().expect("a shape");
            let sizes = shape.attributes().flat_map(|one| numbers(one.value())).collect::<Vec<_>>();
            assert!(!sizes.is_empty() && sizes.iter().all(|size| *size > 0.0), "{shape:?}");
        }
    }
}
