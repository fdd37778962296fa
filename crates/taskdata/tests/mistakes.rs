//! One error gives one message. Each case changes one piece of correct data (tests/sound) and compares the whole
//! report.

use std::path::Path;

use taskdata::load::{Diagnostics, Job, Source, Store, alike::alike, source::read_blocks_under};

fn sources() -> Vec<Source> {
    read_blocks_under(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/sound"))).0
}

/// Replaces `from` by `to` in a file; omits the counts.
fn said(file: &str, from: &str, to: &str) -> String {
    let mut sources = sources();
    let source = sources.iter_mut().find(|s| s.name == file).unwrap();
    assert_eq!(source.text.matches(from).count(), 1, "{from:?} must stand once in {file}");
    source.text = source.text.replace(from, to).into();
    let report = match Store::from_sources(sources) {
        Ok((_, report)) => report,
        Err(report) => *report,
    };
    shown(&report)
}

fn shown(report: &Diagnostics) -> String {
    let text = report.to_string();
    let mut lines: Vec<&str> = text.lines().collect();
    lines.retain(|line| {
        !line.starts_with("records:") && !line.ends_with(" files") && !line.ends_with(" file")
    });
    lines.iter().map(|line| line.trim_end()).collect::<Vec<_>>().join("\n")
}

fn job_said(line: &str) -> String {
    let (store, _) = Store::from_sources(sources()).unwrap_or_else(|report| panic!("{report}"));
    let source = Source { name: "try.job".to_owned(), text: line.into() };
    match Job::from_source(source, &store) {
        Ok((_, report)) => shown(&report),
        Err(report) => shown(&report),
    }
}

#[test]
fn unknown_name_is_reported_with_the_nearest() {
    let said = said("objects/linkbar.blk", r#"PFIXTURE      LK-GRP-FX1"#, r#"PFIXTURE      LK-GPR-FX1"#);
    let expected = r#"
error: objects/linkbar.blk: block 260 (offset 20000), line 7, column 53: no movetable is named LK-GPR-FX1
     -grip- LINKBAR1_BH      2     lpt    PFIXTURE      LK-GPR-FX1
                                                        ^^^^^^^^^^
    help: the nearest known name is LK-GRP-FX1
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn a_name_is_given_once() {
    let said = said("movetables.blk", r#"-mtb-   -900ty"#, r#"-mtb-   -1050tz"#);
    let expected = r#"
error: movetables.blk: block 435 (offset 21000), line 7, column 50: a movetable of this name is given twice
        1    t        0     -900      0      -mtb-   -1050tz
                                                     ^^^^^^^
    help: the first is in movetables.blk, block 435 (offset 21000), line 6
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn name_beyond_ten_characters_is_reported() {
    let said =
        said("locations.blk", r#"  -arr-  TRNG-SCTRS     2    2"#, r#"  -arr-  TRNG-SECTORS   2    2"#);
    let expected = r#"
error: locations.blk: block 702 (offset 21000), line 9, column 10: name of the array has at most 10 characters, TRNG-SECTORS has 12
      -arr-  TRNG-SECTORS   2    2     4     -840tz     500ty      0
             ^^^^^^^^^^^^
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn values_have_ranges() {
    let said = said(
        "objects/linkbar.blk",
        r#"  -ppt     05      60      15      150"#,
        r#"  -ppt     05     600      15      150"#,
    );
    let expected = r#"
error: objects/linkbar.blk: block 269 (offset 20000), line 11, column 19: vel-max is from 1 to 140, 600 found
      -ppt     05     600      15      150    mtb     A/D-15
                      ^^^
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn approach_without_a_stop_is_reported() {
    let said = said(
        "objects/linkbar.blk",
        r#"  -ppt     05      05      40      050    stop
"#,
        r#"
"#,
    );
    let expected = r#"
error: objects/linkbar.blk: block 265 (offset 20000), line 6, column 1: an approach ends with a stop point, this one does not
    -appr   obj   LINKBAR1_BH   2   $$$
    ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
    help: add a last line such as `-ppt 04 05 40 0 stop`
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn movetable_beyond_eight_lines_is_reported() {
    let said = said(
        "movetables.blk",
        r#"    1    rw       0        0   1000      -mtb-   D/A+10rwz"#,
        r#"    1    t        0        0      1      ----
    2    t        0        0      1      ----
    3    t        0        0      1      ----
    4    t        0        0      1      ----
    5    t        0        0      1      ----
    6    t        0        0      1      ----
    7    t        0        0      1      ----
    8    t        0        0      1      ----
    9    t        0        0      1      -mtb-   D/A+10rwz"#,
    );
    let expected = r#"
error: movetables.blk: block 520 (offset 21000), line 16, column 1: a block has 16 lines, 0 to 15; this one has more
        8    t        0        0      1      ----
    ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
    help: begin another block; remarks that begin with %% are not counted
error: movetables.blk: block 520 (offset 21000), line 17, column 5: a movetable has at most 8 lines, D/A+10rwz has 9
        9    t        0        0      1      -mtb-   D/A+10rwz
        ^
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn a_line_has_64_columns() {
    let said = said(
        "objects/linkbar.blk",
        r#"  -obj-  LINKBAR1_BH      2     0300"#,
        r#"  -obj-  LINKBAR1_BH      2     0300                                  "#,
    );
    let expected = r#"
error: objects/linkbar.blk: block 253 (offset 20000), line 5, column 65: a line has 64 columns, this one has 91
      -obj-  LINKBAR1_BH      2     0300                                     0060   30     0350
                                                                    ^^^^^^^^^^^^^^^^^^^^^^^^^^^
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn a_block_has_16_lines() {
    let said = said(
        "objects/linkbar.blk",
        r#"( 274 load (            )      ( 275 load (           )"#,
        r#"

  256 load"#,
    );
    let expected = r#"
error: objects/linkbar.blk: block 251 (offset 20000), line 17, column 1: a block has 16 lines, 0 to 15; this one has more
      256 load
    ^^^^^^^^^^
    help: begin another block; remarks that begin with %% are not counted
warning: objects/linkbar.blk: block 251 (offset 20000), line 17, column 3: block 256 (offset 20000) is loaded already
      256 load
      ^^^^^^^^
    help: take the line out
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn comment_must_end_in_its_block() {
    let said =
        said("objects/clevis.blk", r#"loc-type     "loc-name"             )"#, r#"loc-type     "loc-name""#);
    let expected = r#"
error: objects/clevis.blk: block 456 (offset 20000), line 0, column 1: this comment has no end in its block: `)` was expected
    ( OBJ-LOC FORM    assigned-type => lpt arr
    ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
    help: comments in parentheses may span lines but not blocks
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn a_pose_is_square() {
    let said = said("poses.blk", r#"    3000    -7145    -1483"#, r#"    3000    -7345    -1483"#);
    let expected = r#"
error: poses.blk: block 610 (offset 21000), line 3, column 8: HOME-POS is 2.70 degrees off square
           0    -5022      636
           ^^^^^^^^^^^^^^^^^^^
    help: the finger point must be square to the axis within 2 degrees: record the pose again
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn a_pose_is_within_reach() {
    let said = said(
        "poses.blk",
        r#"   -6650     -550     1600
   -6650     -550    -1400
   -6650    -3550"#,
        r#"   -9650     -550     1600
   -9650     -550    -1400
   -9650    -3550"#,
    );
    let expected = r#"
error: poses.blk: block 612 (offset 21000), line 3, column 4: pose UT-1-P: out of reach by 16.91 in
       -9650     -550     1600
       ^^^^^^^^^^^^^^^^^^^^^^^
    help: its tool point is at (-96.50, -5.50, -14.00 in)
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn pose_beyond_joint_limits_is_reported() {
    let said = said(
        "poses.blk",
        r#"       0    -4279     2521
       0    -6400      400
    3000    -6400      400"#,
        r#"       0    -2279     2521
       0    -4400      400
    3000    -4400      400"#,
    );
    let expected = r#"
error: poses.blk: block 620 (offset 21000), line 3, column 8: pose HOM-SAF-1: shoulder at 97.2 degrees, 7.2 beyond its limit
           0    -2279     2521
           ^^^^^^^^^^^^^^^^^^^
    help: the limits of shoulder are 0 and 90 degrees
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn grip_out_of_reach_at_a_sector_is_reported() {
    let said = said(
        "movetables.blk",
        r#"    1    t      -20        0    210      ----"#,
        r#"    1    t      -20        0   2100      ----"#,
    );
    let expected = r#"
error: objects/linkbar.blk: block 260 (offset 20000), line 5, column 9: grip 2 of LINKBAR1_BH at UNIT_1 sector 1: out of reach by 1.28 in
     -grip- LINKBAR1_BH      2     $$$                  LK-GRP-1
            ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
    help: its tool point is at (-82.25, -0.25, -16.35 in); the same at 3 more places
error: objects/linkbar.blk: block 260 (offset 20000), line 9, column 9: grip 2 of LINKBAR1 at UNIT_1 sector 1: out of reach by 1.28 in
     -grip- LINKBAR1         2     $$$                  LK-GRP-1
            ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
    help: its tool point is at (-82.25, -0.25, -16.35 in); the same at 1 more place
error: objects/linkbar.blk: block 260 (offset 20000), line 11, column 9: grip 2 of LINKBAR1 at UNIT_2 sector 1: out of reach by 5.11 in
     -grip- LINKBAR1         2     lpt    UNIT_2        LK-GRP-1
            ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
    help: its tool point is at (-82.25, -25.25, -16.35 in); the same at 1 more place
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn vertical_targets_cause_a_warning() {
    let said = said(
        "movetables.blk",
        r#"    2    to    -300        0      0      -mtb-   LK-GRP-1
"#,
        r#"    2    to    -100        0      0      -mtb-   LK-GRP-1
"#,
    );
    let expected = r#"
warning: objects/linkbar.blk: block 260 (offset 20000), line 5, column 9: grip 2 of LINKBAR1_BH at UNIT_1 sector 1: the gripper is 1.0 degrees from vertical
     -grip- LINKBAR1_BH      2     $$$                  LK-GRP-1
            ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
    help: tilt the gripper by 3 degrees or more, as LK-GRP-1 does (VIII.9.5); the same at 7 more places
warning: objects/linkbar.blk: block 260 (offset 20000), line 9, column 9: grip 2 of LINKBAR1 at UNIT_1 sector 1: the gripper is 1.0 degrees from vertical
     -grip- LINKBAR1         2     $$$                  LK-GRP-1
            ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
    help: tilt the gripper by 3 degrees or more, as LK-GRP-1 does (VIII.9.5); the same at 3 more places
warning: objects/linkbar.blk: block 260 (offset 20000), line 11, column 9: grip 2 of LINKBAR1 at UNIT_2 sector 1: the gripper is 1.0 degrees from vertical
     -grip- LINKBAR1         2     lpt    UNIT_2        LK-GRP-1
            ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
    help: tilt the gripper by 3 degrees or more, as LK-GRP-1 does (VIII.9.5); the same at 3 more places
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn empty_trajectory_is_reported() {
    let said = said(
        "trajectories.blk",
        r#"-traj   HOME-PFIX       lpt     HOME    lpt    PFIXTURE"#,
        r#"-traj   HOME-PFIX       lpt     HOME    lpt    PFIXTUR"#,
    );
    let expected = r#"
error: trajectories.blk: block 853 (offset 21000), line 5, column 48: no location point is named PFIXTUR
    -traj   HOME-PFIX       lpt     HOME    lpt    PFIXTUR
                                                   ^^^^^^^
    help: the nearest known name is PFIXTURE
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn a_location_has_a_type() {
    let said = said(
        "objects/linkbar.blk",
        r#"LINKBAR1         2     lpt    UNIT_2        LK-GRP-1"#,
        r#"LINKBAR1         2     pos    UNIT_2        LK-GRP-1"#,
    );
    let expected = r#"
error: objects/linkbar.blk: block 260 (offset 20000), line 11, column 32: type of location (lpt, arr, own, $$$) was expected, pos found
     -grip- LINKBAR1         2     pos    UNIT_2        LK-GRP-1
                                   ^^^
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn directory_with_a_missing_block_is_reported() {
    let said = said("objects/linkbar.blk", r#"  256 load ( o-loc"#, r#"  257 load ( o-loc"#);
    let expected = r#"
error: objects/linkbar.blk: block 251 (offset 20000), line 6, column 3: there is no block 257 (offset 20000)
      257 load ( o-loc      )      ( 257 load (           )
      ^^^^^^^^
    help: one of two numbers is wrong: block 256 (offset 20000) is loaded by no directory block; its header is in objects/linkbar.blk, line 56
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn unused_directory_entry_is_reported_once() {
    let said = said("objects/linkbar.blk", "253 load ( object    )", "");
    let expected = r#"
error: objects/linkbar.blk: line 22, column 1: block 253 (offset 20000) is loaded by no directory block; LINKBAR1_BH and 1 more name are used and defined there
    BLOCK# 253 OFFSET 20000
    ^^^^^^^^^^^^^^^^^^^^^^^
    help: add `253 load` to block 251 (offset 20000)
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn duplicate_block_is_reported_with_both_places() {
    let said = said("objects/linkbar.blk", "BLOCK# 254 OFFSET 20000", "BLOCK# 253 OFFSET 20000");
    assert!(said.contains("there is no block 254 (offset 20000)"), "{said}");
    assert!(said.contains("is given twice; its header is in objects/linkbar.blk, line "), "{said}");
    assert_eq!(said.matches("error:").count(), 1, "{said}");
}

#[test]
fn missing_field_is_reported_at_its_entry() {
    let said = said(
        "objects/linkbar.blk",
        "LINKBAR1_BH      2     0300   0060   30     0350",
        "LINKBAR1_BH 2 0300 0060 30",
    );
    let expected = r#"
error: objects/linkbar.blk: block 253 (offset 20000), line 5, column 3: depart size was expected, the entry ends before it
      -obj-  LINKBAR1_BH 2 0300 0060 30
      ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn tabs_are_reported_once_per_file() {
    let mut sources = sources();
    let source = sources.iter_mut().find(|source| source.name == "movetables.blk").unwrap();
    source.text = source.text.replace("    ", "\t").into();
    let report = Store::from_sources(sources).unwrap_err();
    let codes: Vec<&str> = report.errors().map(|error| error.code()).collect();
    assert_eq!(codes, ["block.tab"], "{report}");
    assert!(
        report.errors().all(|error| error.help().is_some_and(|help| help.contains("expand"))),
        "{report}"
    );
}

#[test]
fn incomplete_show_mode_record_is_reported() {
    let said = said(
        "objects/clevis.blk",
        r#"         ped-force            <= 50
"#,
        r#"         pad-force            <= 50
"#,
    );
    let expected = r#"
error: objects/clevis.blk: block 457 (offset 20000), line 5, column 10: PED-PARA has no variable pad-force
             pad-force            <= 50
             ^^^^^^^^^
    help: the nearest variable is ped-force
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn misspelt_compiling_word_is_reported() {
    let said = said("objects/linkbar.blk", r#" -grip- S-LINKBAR1_BH"#, r#" -grp- S-LINKBAR1_BH"#);
    let expected = r#"
error: objects/linkbar.blk: block 261 (offset 20000), line 7, column 2: a compiling word or a number was expected, -grp- found
     -grp- S-LINKBAR1_BH    1     lpt    PFIXTURE      LK-S-GRP
     ^^^^^
    help: the nearest compiling word is -grip-
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn blocks_are_numbered_to_999() {
    let said = said("objects/clevis.blk", "BLOCK# 457 OFFSET 20000", "BLOCK# 1457 OFFSET 20000");
    let expected = r#"
error: objects/clevis.blk: line 59, column 1: the blocks of an offset are numbered 0 to 999, 1457 found
    BLOCK# 1457 OFFSET 20000
    ^^^^^^^^^^^^^^^^^^^^^^^^
    help: continue at the next offset, 1000 higher
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn full_file_names_its_declaration() {
    let said =
        said("directory.blk", "BLOCK# 905 OFFSET 21000\n", "BLOCK# 905 OFFSET 21000\n-file- MOVTAB 20\n");
    let expected = r#"
error: directory.blk: block 905 (offset 21000), line 0, column 8: FILE FULL: MOVTAB holds 20 records, 41 found
    -file- MOVTAB 20
           ^^^^^^^^^
    help: raise the number in this declaration, to 100000 at most
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn sector_outside_its_tray_is_reported() {
    let said = said("locations.blk", "SECTORS        2    2     2 ", "SECTORS        2    2     3 ");
    let expected = r#"
error: locations.blk: block 702 (offset 21000), line 5, column 10: sector 5 of SECTORS is 5.25 in outside its tray
      -arr-  SECTORS        2    2     3     -1050ty    -1050tz    0
             ^^^^^^^
    help: a tray is 21.00 in square; its corner is UNIT_1, columns lead along tool -Y and rows along -Z; the same at 1 more place
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn unusable_trajectory_is_reported() {
    let said = said(
        "trajectories.blk",
        "-traj   HOME-PFIX       lpt     HOME    lpt    PFIXTURE",
        "-traj   HOME-PFIX       lpt     HOME    lpt    HOME",
    );
    let expected = r#"
warning: trajectories.blk: block 853 (offset 21000), line 5, column 33: no command can reach the trajectory HOME-PFIX: it ends at the location where it starts
    -traj   HOME-PFIX       lpt     HOME    lpt    HOME
                                    ^^^^^^^^^^^^^^^^^^^
    help: within one location only depart and approach are followed
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn objects_differing_only_in_vision_ids_are_reported() {
    let more = "BLOCK# 1 OFFSET 22000
-obj- ONE 1 300 60 30 350   -obj- TWO 1 300 60 30 350
-grip- ONE 1 lpt UNIT_1 LK-GRP-1
-grip- TWO 1 lpt UNIT_1 LK-GRP-1
-vu- ONE 1 21 lpt UNIT_1 GR-PIC lpt 561 1
-vu- TWO 1 22 lpt UNIT_1 GR-PIC lpt 561 1
";
    let mut sources = sources();
    sources.push(Source { name: "more.blk".to_owned(), text: more.into() });
    let (store, _) = Store::from_sources(sources).unwrap_or_else(|report| panic!("{report}"));
    let data = store.view();
    let pairs = alike(&data);
    let names: Vec<_> =
        pairs.iter().map(|pair| pair.map(|object| data.object_name(object).to_string())).collect();
    assert_eq!(names, [["ONE", "TWO"]]);
}

#[test]
fn commands_in_task_data_are_reported() {
    let said = said(
        "objects/linkbar.blk",
        r#"  -obj-  S-LINKBAR1_BH"#,
        r#"  == MOVE -- +0 -- 0 +0 HOME 0 -- 0
  -obj-  S-LINKBAR1_BH"#,
    );
    let expected = r#"
error: objects/linkbar.blk: block 254 (offset 20000), line 7, column 3: a command is not task data
      == MOVE -- +0 -- 0 +0 HOME 0 -- 0
      ^^
    help: commands belong in the job files, data/jobs/NAME.job
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn grip_without_an_object_form_is_reported() {
    let said = said("objects/linkbar.blk", r#" -grip- H-LINKBAR1_BH    1"#, r#" -grip- H-LINKBAR1_BH    2"#);
    let expected = r#"
error: objects/linkbar.blk: block 261 (offset 20000), line 5, column 9: H-LINKBAR1_BH has no grip 2 in an object form
     -grip- H-LINKBAR1_BH    2     lpt    PFIXTURE      LK-H-GRP
            ^^^^^^^^^^^^^
    help: it has grip 1
"#;
    assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
}

#[test]
fn job_is_checked_against_the_data() {
    for (line, expected) in [
        (
            r#"== TRANSFER LCLEVIS +1 UNIT_2 1 +1 UNIT_2 2 HOME 0"#,
            r#"
error: try.job: line 1, column 24: nothing says how grip 1 of LCLEVIS is approached at UNIT_2
    == TRANSFER LCLEVIS +1 UNIT_2 1 +1 UNIT_2 2 HOME 0
                           ^^^^^^
    help: add an entry -appr obj for this location, or for $$$ (VII.7.7); there is none
error: try.job: line 1, column 36: nothing says how grip 1 of LCLEVIS is approached at UNIT_2
    == TRANSFER LCLEVIS +1 UNIT_2 1 +1 UNIT_2 2 HOME 0
                                       ^^^^^^
    help: add an entry -appr obj for this location, or for $$$ (VII.7.7); there is none
"#,
        ),
        (
            r#"== TRANSFER LINKBAR1 +2 PFIXTURE 0 +2 UNIT_1 1 HOME 0
== MOVE -- +0 -- 0 +0 SAFE 0 -- 0
== MOVE -- +0 -- 0 +0 PFIXTURE 0 -- 0"#,
            r#"
error: try.job: line 3, column 23: no trajectory leads from SAFE to PFIXTURE
    == MOVE -- +0 -- 0 +0 PFIXTURE 0 -- 0
                          ^^^^^^^^
    help: add a trajectory form (VII.6); each leads from its start to its end only
"#,
        ),
        (
            r#"== MOVE LINKBAR1_BH +2 UNIT_1 5 +2 PFIXTURE 0 -- 0"#,
            r#"
error: try.job: line 1, column 31: SECTORS at UNIT_1 has sectors 1 to 4, 5 found
    == MOVE LINKBAR1_BH +2 UNIT_1 5 +2 PFIXTURE 0 -- 0
                                  ^
"#,
        ),
        (
            r#"== MOVE LINKBAR_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0"#,
            r#"
error: try.job: line 1, column 9: no object is named LINKBAR_BH
    == MOVE LINKBAR_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0
            ^^^^^^^^^^
    help: the nearest known name is LINKBAR1_BH
"#,
        ),
        (
            r#"== MOVE LINKBAR1_BH +2 UNIT1 4 +2 PFIXTURE 0 -- 0"#,
            r#"
error: try.job: line 1, column 24: no location point, owner or array is named UNIT1
    == MOVE LINKBAR1_BH +2 UNIT1 4 +2 PFIXTURE 0 -- 0
                           ^^^^^
    help: the nearest known name is UNIT_1
"#,
        ),
        (
            r#"== MOVE LINKBAR1_BH +1 UNIT_1 4 +2 PFIXTURE 0 -- 0"#,
            r#"
error: try.job: line 1, column 21: LINKBAR1_BH has no grip 1 in an object form
    == MOVE LINKBAR1_BH +1 UNIT_1 4 +2 PFIXTURE 0 -- 0
                        ^^
    help: LINKBAR1_BH has grip +2
"#,
        ),
        (
            r#"== MOV LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0"#,
            r#"
error: try.job: line 1, column 4: no command of Task is named MOV
    == MOV LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0
       ^^^
    help: the nearest is MOVE
"#,
        ),
        (
            r#"== MOVE LINKBAR1_BH +2 UNIT_1 +2 PFIXTURE 0 -- 0"#,
            r#"
error: try.job: line 1, column 34: destination grip, a whole number, was expected; PFIXTURE found
    == MOVE LINKBAR1_BH +2 UNIT_1 +2 PFIXTURE 0 -- 0
                                     ^^^^^^^^
    help: a command has nine fields: object, grip, location, sector, grip, location, sector, end-at, sector; -- is null
"#,
        ),
        (
            r#"== MOVE LINKBAR1_BH +2 UNIT 4 +2 PFIXTURE 0 -- 0"#,
            r#"
error: try.job: line 1, column 24: no object location form assigns LINKBAR1_BH to a member of UNIT
    == MOVE LINKBAR1_BH +2 UNIT 4 +2 PFIXTURE 0 -- 0
                           ^^^^
    help: LINKBAR1_BH is assigned to SECTORS
"#,
        ),
        (
            r#"** vise shut PFIXTURE"#,
            r#"
error: try.job: line 1, column 9: no opening of a vise is named shut
    ** vise shut PFIXTURE
            ^^^^
    help: there are partial, close, open
"#,
        ),
        (
            r#"** tray UNIT_1 4 LCLEVIS_IH"#,
            r#"
error: try.job: line 1, column 9: no object location form assigns LCLEVIS_IH to a member of UNIT_1
    ** tray UNIT_1 4 LCLEVIS_IH
            ^^^^^^
    help: no object location form (-o-loc-, VII.7.3) has LCLEVIS_IH
"#,
        ),
        (
            r#"MOVE"#,
            r#"
error: try.job: line 1, column 1: a line begins with == or **, MOVE found
    MOVE
    ^^^^
    help: == sends a command to Task, ** says what the workstation does, % begins a comment
"#,
        ),
        (
            r#"** tray UNIT_1 4 LINKBAR1_BH 50"#,
            r#"
error: try.job: line 1, column 30: y in 0.01 in was expected, the line ends
    ** tray UNIT_1 4 LINKBAR1_BH 50
                                 ^^
"#,
        ),
        (
            r#"== MOVE LINKBAR1_BH +2 PFIXTURE 3 +2 HOME 0 -- 0 extra"#,
            r#"
error: try.job: line 1, column 33: PFIXTURE has no sectors: 0 was expected, 3 found
    == MOVE LINKBAR1_BH +2 PFIXTURE 3 +2 HOME 0 -- 0 extra
                                    ^
error: try.job: line 1, column 50: the line should end before extra
    == MOVE LINKBAR1_BH +2 PFIXTURE 3 +2 HOME 0 -- 0 extra
                                                     ^^^^^
    help: behind the nine fields only a serial number can stand, # and 1 to 16 characters, as in #17, and `expect error`
"#,
        ),
    ] {
        let said = job_said(line);
        assert_eq!(said, expected.trim_matches('\n'), "\n{said}");
    }
}
