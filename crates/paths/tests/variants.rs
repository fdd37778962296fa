//! Checks the findings for wrong variants of the shipped data.

use std::{fmt::Write, path::Path};

use paths::{
    job::{WalkedJob, walk_job},
    known::Known,
};
use plant::{CellDescription, room::Room};
use taskdata::load::{Diagnostics, Job, Source, Store, source::read_blocks_under};

type Variant = (&'static str, &'static str, &'static str, &'static str, &'static str);

const TRAJECTORIES: &str = "trajectories.blk";
const POSES: &str = "poses.blk";
const TABLES: &str = "movetables.blk";
const LINKBAR: &str = "objects/linkbar.blk";

const VARIANTS: [Variant; 30] = [
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
        "HOL-V1 15 in lower",
        "turned-part",
        POSES,
        "     152    -4372     2619\n     188    -5397     -200\n    3186    -5292     -200   -pose-   ...         HOL-V1",
        "     152    -4372     1119\n     188    -5397    -1700\n    3186    -5292    -1700   -pose-   ...         HOL-V1",
    ),
    (
        "TOOL-V1 in the machine",
        "tool-change",
        POSES,
        "    2757    -2683     2321\n    5597    -3497     1800\n    5987    -1052      105   -pose-   ...         TOOL-V1",
        "    5257    -2683     1321\n    8097    -3497      800\n    8487    -1052     -895   -pose-   ...         TOOL-V1",
    ),
    (
        "QCA-UP leads up 3 in only",
        "turned-part",
        TABLES,
        "    1    t    -1400        0      0      -mtb-   QCA-UP\n",
        "    1    t     -300        0      0      -mtb-   QCA-UP\n",
    ),
    (
        "QCA-LIFT leads to the side",
        "turned-part",
        TABLES,
        "    1    t     -200        0      0      -mtb-   QCA-LIFT\n",
        "    1    t     -200      100      0      -mtb-   QCA-LIFT\n",
    ),
    (
        "INS-NEAR leads beside the drum",
        "tool-change",
        TABLES,
        "    1    t     -160        0      0      -mtb-   INS-NEAR\n",
        "    1    t     -160        0   -200      -mtb-   INS-NEAR\n",
    ),
    (
        "ACQ-NEAR leads into the plate",
        "tool-change",
        TABLES,
        "    1    t      -30        0   -165      -mtb-   ACQ-NEAR\n",
        "    1    t      130        0   -165      -mtb-   ACQ-NEAR\n",
    ),
    (
        "approach of 15 in leads down",
        "linkbar",
        TABLES,
        "    1    t    -1500        0      0      -mtb-   A/D-15\n",
        "    1    t      300        0      0      -mtb-   A/D-15\n",
    ),
];

fn data() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"))
}

fn first(report: &Diagnostics) -> String {
    report.errors().next().map_or(String::new(), |error| format!("{}: {}", error.place(), error.message()))
}

fn walked(variant: &Variant, sources: &[Source], room: &Room) -> Result<WalkedJob, String> {
    let (name, job, file, from, to) = *variant;
    let mut sources = sources.to_vec();
    let source = sources.iter_mut().find(|source| source.name == file).unwrap();
    assert_eq!(source.text.matches(from).count(), 1, "{name}: what is to be replaced");
    source.text = source.text.replace(from, to).into();
    let (store, _) = Store::from_sources(sources).map_err(|report| first(&report))?;
    let path = data().join("jobs").join(format!("{job}.job"));
    let (job, _) = Job::load(&path, &store).map_err(|report| first(&report))?;
    Ok(walk_job(&job, &store, room, &Known::default()))
}

#[test]
fn each_variant_gets_its_answer() {
    let (sources, unreadable) = read_blocks_under(data());
    assert!(unreadable.is_empty(), "{unreadable:?}");
    let room = Room::new(&CellDescription::load(&data().join("cell.toml")).unwrap());
    let mut said = String::new();
    for variant in &VARIANTS {
        let (name, job, ..) = variant;
        writeln!(said, "{job}: {name}").unwrap();
        match walked(variant, &sources, &room) {
            Err(report) => writeln!(said, "    refused: {}", report).unwrap(),
            Ok(walked) => {
                if walked.findings.is_empty() {
                    writeln!(said, "    nothing is found").unwrap();
                }
                for finding in walked.findings.iter().take(3) {
                    writeln!(said, "    line {}: {}", finding.line, finding.message).unwrap();
                    if let Some(help) = &finding.help {
                        writeln!(said, "        {help}").unwrap();
                    }
                }
            }
        }
    }
    let page = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/variants.txt"));
    if std::env::var_os("RCS_WRITE_VARIANTS").is_some() {
        std::fs::write(page, &said).unwrap();
    }
    assert_eq!(
        std::fs::read_to_string(page).unwrap(),
        said,
        "RCS_WRITE_VARIANTS=1 writes {}",
        page.display()
    );
}
