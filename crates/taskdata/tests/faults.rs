//! Data with errors are used; each error concerns the commands that use the wrong datum.

use std::path::Path;

use interfaces::HwsCommand;
use rcs_core::name::Name16;
use taskdata::load::{Source, Step, Store, job::own_command, source::read_blocks_under};

fn spoilt(file: &str, from: &str, to: &str) -> Store {
    let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"));
    let mut sources = read_blocks_under(data).0;
    let source = sources.iter_mut().find(|source| source.name == file).unwrap();
    assert!(source.text.contains(from), "{file} has no {from}");
    source.text = source.text.replacen(from, to, 1).into();
    Store::from_sources_with_faults(sources).0
}

fn command(text: &str, store: &Store) -> HwsCommand {
    match own_command(text, store).map(|line| line.step) {
        Ok(Step::Command(command)) => command,
        other => panic!("{text}: {other:?}"),
    }
}

#[test]
fn unknown_name_in_an_object_block_concerns_its_commands() {
    let store = spoilt("objects/linkbar.blk", "LK-GRP-FX1", "LK-GPR-FX1");
    assert!(store.faults().next().is_some());
    let of = |text: &str| store.faults_of(&command(text, &store), &[]);
    assert!(of("MOVE LCLEVIS_BH +2 UNIT_1 3 +2 PFIXTURE 0 -- 0").is_empty(), "another object");
    assert!(of("MOVE -- 0 -- 0 0 HOME 0 -- 0").is_empty(), "no object");
    let object = Some(Name16::clipped("LINKBAR1_BH"));
    let bar = HwsCommand { command: Name16::clipped("ACQUIRE"), object, ..HwsCommand::default() };
    let found = store.faults_of(&bar, &[]);
    assert!(found[0].in_line().starts_with("objects/linkbar.blk: block 260"), "{}", found[0].in_line());
    assert!(found[0].message.contains("LK-GPR-FX1"), "{}", found[0].message);
    assert!(store.faults_of(&HwsCommand { command: Name16::clipped("PAUSE"), ..bar }, &[]).is_empty());
}

#[test]
fn error_without_names_concerns_all_commands_but_pause() {
    let store = spoilt("locations.blk", "BLOCK#", "BLOK#");
    let home = HwsCommand { command: Name16::clipped("MOVE"), ..HwsCommand::default() };
    assert!(!store.faults_of(&home, &[]).is_empty());
    let pause = HwsCommand { command: Name16::clipped("PAUSE"), ..home };
    assert!(store.faults_of(&pause, &[]).is_empty());
}

#[test]
fn blocks_load_despite_known_errors_and_can_correct_them() {
    let wrong = spoilt("poses.blk", "   -4424    -4803      800", "   -4424    -4803     -200");
    assert!(wrong.faults().next().is_some_and(|fault| fault.message.contains("UNIT-V1")));
    let pose = |z: i32, name: &str| {
        let text = format!(
            "BLOCK# 900 OFFSET 21000\n   -4040    -1471     3398\n   -5450    -1984      800\n   -4424    -4803     \
             {z:4}   -pose-   ...         {name}\n"
        );
        wrong.with_blocks(vec![Source { name: "try.blk".into(), text: text.into() }])
    };
    let faults = |store: &Store| store.faults().count();
    assert_eq!(pose(800, "TRY").map(|(store, _)| faults(&store)).ok(), Some(1), "nothing new is wrong");
    assert_eq!(pose(800, "UNIT-V1").map(|(store, _)| faults(&store)).ok(), Some(0), "it is corrected");
    assert!(pose(-200, "TRY").is_err(), "another pose is wrong");
    assert!(pose(-200, "UNIT-V1").is_err(), "it is as wrong as before");
}
