//! Unreadable files, and files with errors.

use std::{fs, path::Path};

use taskdata::load::source::read_blocks_under;

use super::{Checked, Flights, data::copy};

fn said(data: &Path) -> String {
    let checked = Checked::of(data, &Flights::default());
    let reports = checked.reports.iter().map(|(_, report)| report.to_string());
    let text = reports.collect::<String>().replace(&format!("{}/", data.display()), "");
    let is_count = |line: &str| line.contains("; ") && (line.ends_with(" file") || line.ends_with(" files"));
    let lines = text.lines().filter(|line| !is_count(line) && !line.starts_with("records:"));
    lines.map(|line| line.trim_end().to_owned() + "\n").collect()
}

fn replace(file: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(file).unwrap();
    assert!(text.contains(from), "{} has no {from}", file.display());
    fs::write(file, text.replacen(from, to, 1)).unwrap();
}

#[test]
fn unreadable_file_is_one_error_and_hides_no_other() {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
    let scratch = tempfile::tempdir().unwrap();
    let data = scratch.path().join("data");
    copy(&shipped, &data);
    let why = |name: &str| {
        format!(
            "error: {name} cannot be read: line 1 is not UTF-8: save the file as UTF-8 or as plain ASCII\n"
        )
    };
    for source in read_blocks_under(&shipped).0 {
        fs::write(data.join(&source.name), b"\xff").unwrap();
        assert_eq!(said(&data), why(&source.name));
        fs::write(data.join(&source.name), &*source.text).unwrap();
    }
    fs::write(data.join("poses.blk"), b"\xff").unwrap();
    replace(&data.join("objects/linkbar.blk"), "LK-GRP-FX1", "LK-GPR-FX1");
    let job =
        "== MOVE LINKBAR_BH +2 UNIT_1 4 +2 PFIXTUER 0 -- 0\n== MOV LINKBAR1_BH\n** vise shut PFIXTURE\n";
    fs::write(data.join("jobs/try.job"), job).unwrap();
    replace(&data.join("cell.toml"), "[vise]", "[vise]\nwidht = 1");
    let expected = r#"
error: objects/linkbar.blk: block 260 (offset 20000), line 7, column 53: no movetable is named LK-GPR-FX1 in the files that can be read
     -grip- LINKBAR1_BH      2     lpt    PFIXTURE      LK-GPR-FX1
                                                        ^^^^^^^^^^
    help: the nearest known name is LK-GRP-FX1
error: jobs/try.job: line 1, column 9: no object is named LINKBAR_BH
    == MOVE LINKBAR_BH +2 UNIT_1 4 +2 PFIXTUER 0 -- 0
            ^^^^^^^^^^
    help: the nearest known name is LINKBAR1_BH
error: jobs/try.job: line 1, column 35: no location point, owner or array is named PFIXTUER
    == MOVE LINKBAR_BH +2 UNIT_1 4 +2 PFIXTUER 0 -- 0
                                      ^^^^^^^^
    help: the nearest known name is PFIXTURE
error: jobs/try.job: line 2, column 8: source grip was expected, the line ends
    == MOV LINKBAR1_BH
           ^^^^^^^^^^^
error: jobs/try.job: line 3, column 9: no opening of a vise is named shut
    ** vise shut PFIXTURE
            ^^^^
    help: there are partial, close, open
"#;
    let said = said(&data);
    assert_eq!(
        said[..said.find("error: cell.toml").unwrap()],
        why("poses.blk") + expected.trim_start(),
        "\n{said}"
    );
    assert!(said.contains("vise has no key widht"), "{said}");
}
