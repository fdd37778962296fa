//! Wrong variants of the shipped data, and what is said of each.

use std::{fmt::Write, path::Path};

use paths::job::{WalkedJob, walk_job};
use plant::{CellDescription, room::Room};
use taskdata::load::{Job, Source, Store, source::read_blocks_under};

/// A mistake: its name, the job that meets it, the file, what stands there, and what stands there instead.
type Variant = (&'static str, &'static str, &'static str, &'static str, &'static str);

const TRAJECTORIES: &str = "trajectories.blk";
const POSES: &str = "poses.blk";
const TABLES: &str = "movetables.blk";
const LINKBAR: &str = "objects/linkbar.blk";
const CLEVIS: &str = "objects/clevis.blk";

const VARIANTS: [Variant; 24] = [
    (
        "UNIT-PFIX without via points",
        "linkbar",
        TRAJECTORIES,
        "UNIT    lpt    PFIXTURE\n  -ppt     4      100      8      300     pos    UNIT-V1\n  -ppt     4      100      8      300     pos    HOM-SAF-3\n  -ppt     4      100      8      300     pos    HOM-SAF-1\n  -ppt     4      100      8      300     pos    FIX-V1\n",
        "UNIT    lpt    PFIXTURE\n",
    ),
    (
        "UNIT-PFIX without its last two points",
        "linkbar",
        TRAJECTORIES,
        "UNIT    lpt    PFIXTURE\n  -ppt     4      100      8      300     pos    UNIT-V1\n  -ppt     4      100      8      300     pos    HOM-SAF-3\n  -ppt     4      100      8      300     pos    HOM-SAF-1\n  -ppt     4      100      8      300     pos    FIX-V1\n",
        "UNIT    lpt    PFIXTURE\n  -ppt     4      100      8      300     pos    UNIT-V1\n  -ppt     4      100      8      300     pos    HOM-SAF-3\n",
    ),
    (
        "UNIT-PFIX with only its last point",
        "clevis",
        TRAJECTORIES,
        "UNIT    lpt    PFIXTURE\n  -ppt     4      100      8      300     pos    UNIT-V1\n  -ppt     4      100      8      300     pos    HOM-SAF-3\n  -ppt     4      100      8      300     pos    HOM-SAF-1\n",
        "UNIT    lpt    PFIXTURE\n",
    ),
    (
        "PFIX-UNIT without via points",
        "linkbar",
        TRAJECTORIES,
        "PFIXTURE own    UNIT\n  -ppt     4      100      8      300     pos    FIX-V1\n  -ppt     4      100      8      300     pos    HOM-SAF-1\n  -ppt     4      100      8      300     pos    HOM-SAF-3\n  -ppt     4      100      8      300     pos    UNIT-V1\n",
        "PFIXTURE own    UNIT\n",
    ),
    (
        "PFIX-UNIT without its middle",
        "clevis",
        TRAJECTORIES,
        "PFIXTURE own    UNIT\n  -ppt     4      100      8      300     pos    FIX-V1\n  -ppt     4      100      8      300     pos    HOM-SAF-1\n  -ppt     4      100      8      300     pos    HOM-SAF-3\n",
        "PFIXTURE own    UNIT\n  -ppt     4      100      8      300     pos    FIX-V1\n",
    ),
    (
        "UNIT-HOL without via points",
        "turned-part",
        TRAJECTORIES,
        "UNIT      own    HOLSTER\n  -ppt     4      100      8      300     pos    UNIT-V1\n  -ppt     4      100      8      300     pos    HOM-SAF-3\n  -ppt     4      100      8      300     pos    HOL-V1\n",
        "UNIT      own    HOLSTER\n",
    ),
    (
        "HOL-UNIT without via points",
        "turned-part",
        TRAJECTORIES,
        "HOLSTER   own    UNIT\n  -ppt     4      100      8      300     pos    HOL-V1\n  -ppt     4      100      8      300     pos    HOM-SAF-3\n  -ppt     4      100      8      300     pos    UNIT-V1\n",
        "HOLSTER   own    UNIT\n",
    ),
    (
        "UNIT-VFIX without via points",
        "turned-part",
        TRAJECTORIES,
        "UNIT      own    VFIXTURE\n  -ppt     4      100      8      300     pos    UNIT-V1\n  -ppt     4      100      8      300     pos    HOM-SAF-3\n  -ppt     4      100      8      300     pos    HOM-SAF-1\n  -ppt     4      100      8      300     pos    FIX-V1\n",
        "UNIT      own    VFIXTURE\n",
    ),
    (
        "HOL-TOOLS without via points",
        "tool-change",
        TRAJECTORIES,
        "HOLSTER   lpt    TOOL-SAFE\n  -ppt     4      100      8      300     pos    HOL-V1\n  -ppt     4      100      8      300     pos    FIX-V1\n  -ppt     4      100      8      300     pos    TOOL-V1\n",
        "HOLSTER   lpt    TOOL-SAFE\n",
    ),
    (
        "TOOLS-UNIT without via points",
        "tool-change",
        TRAJECTORIES,
        "TOOL-SAFE own    UNIT\n  -ppt     4      100      8      300     pos    TOOL-V1\n  -ppt     4      100      8      300     pos    FIX-V1\n  -ppt     4      100      8      300     pos    HOM-SAF-1\n  -ppt     4      100      8      300     pos    HOM-SAF-3\n  -ppt     4      100      8      300     pos    UNIT-V1\n",
        "TOOL-SAFE own    UNIT\n",
    ),
    (
        "UNIT-TOOLS with only its last point",
        "tool-change",
        TRAJECTORIES,
        "UNIT      lpt    TOOL-SAFE\n  -ppt     4      100      8      300     pos    UNIT-V1\n  -ppt     4      100      8      300     pos    HOM-SAF-3\n  -ppt     4      100      8      300     pos    HOM-SAF-1\n  -ppt     4      100      8      300     pos    FIX-V1\n",
        "UNIT      lpt    TOOL-SAFE\n",
    ),
    (
        "UNIT-V1 10 in lower",
        "linkbar",
        POSES,
        "   -4424    -4803      800   -pose-   ...         UNIT-V1",
        "   -4424    -4803     -200   -pose-   ...         UNIT-V1",
    ),
    (
        "FIX-V1 12 in lower",
        "linkbar",
        POSES,
        "    1473    -3098     1426\n    3285    -5258      400\n    5583    -3330      400   -pose-   ...         FIX-V1",
        "    1473    -3098      226\n    3285    -5258     -800\n    5583    -3330     -800   -pose-   ...         FIX-V1",
    ),
    (
        "FIX-V1 behind the vise",
        "clevis",
        POSES,
        "    1473    -3098     1426\n    3285    -5258      400\n    5583    -3330      400   -pose-   ...         FIX-V1",
        "    6473    -3098     1026\n    8285    -5258        0\n   10583    -3330        0   -pose-   ...         FIX-V1",
    ),
    (
        "approach of 5 in is one of 1 in",
        "linkbar",
        TABLES,
        "    1    t     -500        0      0      -mtb-   A/D-5\n",
        "    1    t     -100        0      0      -mtb-   A/D-5\n",
    ),
    (
        "approach of 5 in leads beyond",
        "linkbar",
        TABLES,
        "    1    t     -500        0      0      -mtb-   A/D-5\n",
        "    1    t      500        0      0      -mtb-   A/D-5\n",
    ),
    (
        "depart of 8 in is one of 1 in",
        "linkbar",
        TABLES,
        "    1    t     -800        0      0      -mtb-   A/D-8\n",
        "    1    t     -100        0      0      -mtb-   A/D-8\n",
    ),
    (
        "depart of 8 in is one of 1 in",
        "clevis",
        TABLES,
        "    1    t     -800        0      0      -mtb-   A/D-8\n",
        "    1    t     -100        0      0      -mtb-   A/D-8\n",
    ),
    (
        "depart of 8 in leads down",
        "turned-part",
        TABLES,
        "    1    t     -800        0      0      -mtb-   A/D-8\n",
        "    1    t      800        0      0      -mtb-   A/D-8\n",
    ),
    (
        "approach of 10 in leads down",
        "tool-change",
        TABLES,
        "    1    t    -1000        0      0      -mtb-   A/D-10\n",
        "    1    t     1000        0      0      -mtb-   A/D-10\n",
    ),
    (
        "the bar is approached with fingers 0.30 in open",
        "linkbar",
        LINKBAR,
        "  -obj-  LINKBAR1         2     0300   0060   30     0350",
        "  -obj-  LINKBAR1         2     0030   0020   30     0350",
    ),
    (
        "the bar is left with fingers 5 in open in the vise",
        "linkbar",
        LINKBAR,
        "  -obj-  LINKBAR1_BH      2     0300   0060   30     0350",
        "  -obj-  LINKBAR1_BH      2     0300   0060   30     0500",
    ),
    (
        "QCA-FAST leads 2 in into the gripper",
        "turned-part",
        TABLES,
        "    1    t     -100        0    150      -mtb-   QCA-FAST\n",
        "    1    t      200        0    150      -mtb-   QCA-FAST\n",
    ),
    (
        "the clevis is approached from below",
        "clevis",
        CLEVIS,
        "-appr   obj   LCLEVIS      1   lpt   PFIXTURE\n  -ppt     05      30       5      500    mtb     A/D-10\n",
        "-appr   obj   LCLEVIS      1   lpt   PFIXTURE\n  -ppt     05      30       5      500    mtb     A/D-15\n",
    ),
];

fn data() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"))
}

/// The job with a mistake in the data; `Err` if the data are refused before any way is walked.
fn walked(variant: &Variant, sources: &[Source], room: &Room) -> Result<WalkedJob, String> {
    let (name, job, file, from, to) = *variant;
    let mut sources = sources.to_vec();
    let source = sources.iter_mut().find(|source| source.name == file).unwrap();
    assert_eq!(source.text.matches(from).count(), 1, "{name}: what is to be replaced");
    source.text = source.text.replace(from, to).into();
    let (store, _) = Store::from_sources(sources).map_err(|report| report.to_string())?;
    let path = data().join("jobs").join(format!("{job}.job"));
    let (job, _) = Job::load(&path, &store).map_err(|report| report.to_string())?;
    Ok(walk_job(&job, &store, room))
}

#[test]
fn every_mistake_is_found_before_anything_moves() {
    let sources = read_blocks_under(data()).unwrap();
    let room = Room::new(&CellDescription::load(&data().join("cell.toml")).unwrap());
    let mut said = String::new();
    for variant in &VARIANTS {
        let (name, job, ..) = variant;
        writeln!(said, "{job}: {name}").unwrap();
        match walked(variant, &sources, &room) {
            Err(report) => {
                writeln!(said, "    refused: {}", report.lines().next().unwrap_or_default()).unwrap()
            }
            Ok(walked) => {
                if walked.findings.is_empty() {
                    writeln!(said, "    nothing is found").unwrap();
                }
                for finding in walked.findings.iter().take(2) {
                    writeln!(said, "    line {}: {}", finding.line, finding.message).unwrap();
                    writeln!(said, "        {}", finding.help.as_deref().unwrap_or_default()).unwrap();
                }
            }
        }
    }
    insta::assert_snapshot!(said);
}
