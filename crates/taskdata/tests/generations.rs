//! Loading blocks into data in use: record numbers stay, values are new, and an error changes nothing.

use proptest::prelude::*;
use rcs_core::name::Name16;
use taskdata::{
    files::TaskData,
    load::{Source, Store},
};

fn source(name: &str, text: &str) -> Source {
    Source { name: name.to_owned(), text: text.into() }
}

fn name(text: &str) -> Name16 {
    Name16::new(text).unwrap()
}

fn loaded(text: &str) -> Store {
    Store::from_sources(vec![source("base.blk", text)])
        .map_or_else(|report| panic!("{report}"), |(store, _)| store)
}

fn with(store: &Store, text: &str) -> Result<Store, String> {
    store.with_blocks(vec![source("more.blk", text)]).map(|(store, _)| store).map_err(|r| r.to_string())
}

/// Two fixtures, and a part that moves from the first to the second.
const BASE: &str = "BLOCK# 600 OFFSET 21000
 3800 -4400 -400 6800 -4400 -400 6800 -1400 -400 -pose- ... F-P
 3800 -4400 600 6800 -4400 600 6800 -1400 600 -pose- ... G-P
 -pt- F F-P ...   -pt- G G-P ...
 1 t -25 0 0 -mtb- IN
 -traj F-G lpt F lpt G -ppt 4 100 8 300 pos F-P
BLOCK# 1 OFFSET 20000
 -obj- PART 1 300 60 30 350
 -grip- PART 1 $$$ IN
 -o-loc- PART lpt F
 -appr obj PART 1 $$$ -ppt 5 40 8 100 mtb IN -ppt 4 5 40 0 stop
";

fn numbers(data: &TaskData<'_>) -> Vec<Option<u32>> {
    vec![
        data.pose_named(&name("F-P")).map(|id| id.number()),
        data.pose_named(&name("G-P")).map(|id| id.number()),
        data.locpt_named(&name("F")).map(|id| id.number()),
        data.locpt_named(&name("G")).map(|id| id.number()),
        data.movetable_named(&name("IN")).map(|id| id.number()),
        data.trajectory_named(&name("F-G")).map(|id| id.number()),
        data.object_named(&name("PART")).map(|id| id.number()),
        data.object(&name("PART"), 1).map(|(id, _)| id.number()),
    ]
}

#[test]
fn replaced_record_keeps_its_number_and_updates_derived_ones() {
    let base = loaded(BASE);
    let next = with(
        &base,
        "BLOCK# 610 OFFSET 21000
 3600 -4400 -400 6600 -4400 -400 6600 -1400 -400 -pose- ... F-P
 -pt- H F-P IN
 1 t -50 0 0 -mtb- IN
BLOCK# 2 OFFSET 20000
 -obj- OTHER 1 300 60 30 350
 -appr obj PART 1 $$$ -ppt 5 20 8 100 mtb IN -ppt 4 5 40 0 stop
",
    )
    .unwrap_or_else(|report| panic!("{report}"));
    let (old, new) = (base.view(), next.view());
    assert_eq!(numbers(&old), numbers(&new));
    assert!(numbers(&new).iter().all(Option::is_some));
    assert_eq!(new.locpt_named(&name("H")).map(|id| id.number()), Some(3));
    let at = |data: &TaskData<'_>| {
        let place = data.resolve_location(&name("F"), None, Some(&name("PART"))).unwrap();
        let frame = data.grip_frame(&name("PART"), 1, &place).unwrap();
        let approach = data.path(data.approach(&name("PART"), 1, &place.place).unwrap());
        (frame.position.x, data.traj_para(approach[0].para).unwrap().vel_max)
    };
    assert_eq!((at(&old), at(&new)), ((67.75, 40), (65.5, 20)));
    assert_eq!(next.place(next.origins().poses[0]), "more.blk, block 610 (offset 21000), line 0");
    assert_eq!(next.place(next.origins().poses[1]), "base.blk, block 600 (offset 21000), line 1");
    // The first generation is unchanged; the second is the base of a third.
    assert_eq!(at(&base.view()), (67.75, 40));
    let third = with(&next, "BLOCK# 610 OFFSET 21000\n 1 t -75 0 0 -mtb- IN").unwrap();
    assert_eq!(at(&third.view()), (65.25, 20));
}

#[test]
fn object_assigned_to_another_place_leaves_the_old_one() {
    let base = loaded(BASE);
    let next = with(&base, "BLOCK# 2 OFFSET 20000\n -o-loc- PART lpt G\n").unwrap();
    let count = |store: &Store| {
        let data = store.view();
        data.object_locations(data.object_named(&name("PART")).unwrap()).count()
    };
    assert_eq!((count(&base), count(&next)), (1, 1));
    let both = with(&base, "BLOCK# 2 OFFSET 20000\n -o-loc- PART lpt G -o-loc- PART lpt F\n").unwrap();
    assert_eq!(count(&both), 2);
}

#[test]
fn error_leaves_the_data_unchanged() {
    let base = loaded(BASE);
    let first =
        |text| with(&base, text).expect_err("an error was expected").lines().next().unwrap().to_owned();
    assert_eq!(
        first("BLOCK# 2 OFFSET 20000\n 1 t 0 0 5 -mtb- IN\n -grip- PART 2 lpt F IN\n"),
        "error: more.blk: block 2 (offset 20000), line 1, column 9: PART has no grip 2 in an object form"
    );
    assert_eq!(
        first("BLOCK# 2 OFFSET 20000\n 1 t 0 0 5 -mtb- IN\n 1 t 0 0 6 -mtb- IN\n"),
        "error: more.blk: block 2 (offset 20000), line 1, column 18: a movetable of this name is given twice"
    );
    // The new movetable is correct, but an old entry that uses it is not.
    assert_eq!(
        first("BLOCK# 2 OFFSET 20000\n 1 t 4000 0 0 -mtb- IN\n"),
        "error: base.blk: block 1 (offset 20000), line 1, column 9: grip 1 of PART at F: out of reach by 17.26 in"
    );
    assert_eq!(numbers(&base.view()).len(), 8);
}

#[test]
fn directory_may_name_loaded_blocks() {
    let base = loaded(BASE);
    assert!(with(&base, "BLOCK# 2 OFFSET 20000\n 1 load 3 load\nBLOCK# 3 OFFSET 20000\n FDEF\n").is_ok());
    let missing = with(&base, "BLOCK# 2 OFFSET 20000\n 7 load\n").expect_err("block 7 is missing");
    assert!(missing.contains("there is no block 7 (offset 20000)"), "{missing}");
}

fn text(block: u32, movetables: &[(u8, i32)], objects: &[(u8, u8)]) -> String {
    let mut out = String::new();
    let lines = movetables.iter().map(|(n, x)| format!(" 1 t {x} 0 0 -mtb- M{n}\n"));
    let objects = objects
        .iter()
        .map(|(n, m)| format!(" -obj- P{n} 1 {} 60 30 350 -grip- P{n} 1 lpt F M{m}\n", 100 + u32::from(*m)));
    for (i, line) in lines.chain(objects).enumerate() {
        if i % 16 == 0 {
            out.push_str(&format!("BLOCK# {} OFFSET 20000\n", block + u32::try_from(i).unwrap() / 16));
        }
        out.push_str(&line);
    }
    out
}

fn once<V: std::fmt::Debug + Copy + 'static>(
    numbers: std::ops::Range<u8>,
    value: impl Strategy<Value = V> + 'static,
) -> impl Strategy<Value = Vec<(u8, V)>> {
    prop::collection::btree_map(numbers, value, 0..20).prop_map(|map| map.into_iter().collect())
}

proptest! {
    /// For any blocks loaded, every name keeps its number and has the values that were loaded last.
    #[test]
    fn names_keep_their_numbers_and_last_values(
        reloads in prop::collection::vec((once(0..30, -200..0), once(0..30, 0_u8..10)), 1..4),
    ) {
        let all: Vec<(u8, i32)> = (0..10).map(|n| (n, -i32::from(n))).collect();
        let mut store = loaded(&format!("{BASE}{}", text(100, &all, &[(0, 0), (1, 1), (2, 2)])));
        let mut said: std::collections::BTreeMap<u8, i32> = all.into_iter().collect();
        let mut parts: std::collections::BTreeMap<u8, u8> = [(0, 0), (1, 1), (2, 2)].into();
        for (movetables, objects) in reloads {
            let next = with(&store, &text(100, &movetables, &objects)).unwrap_or_else(|e| panic!("{e}"));
            let (old, new) = (store.view(), next.view());
            prop_assert_eq!(numbers(&old), numbers(&new));
            for n in said.keys() {
                let id = old.movetable_named(&name(&format!("M{n}")));
                prop_assert!(id.is_some());
                prop_assert_eq!(id, new.movetable_named(&name(&format!("M{n}"))));
            }
            for n in parts.keys() {
                let part = name(&format!("P{n}"));
                prop_assert!(old.object_named(&part).is_some());
                prop_assert_eq!(old.object_named(&part), new.object_named(&part));
                prop_assert_eq!(old.object(&part, 1).unwrap().0, new.object(&part, 1).unwrap().0);
            }
            said.extend(movetables);
            parts.extend(objects);
            let f = new.resolve_location::<16, 16>(&name("F"), None, None).unwrap();
            for (n, m) in &parts {
                let frame = new.grip_frame(&name(&format!("P{n}")), 1, &f).unwrap();
                let expected = 68.0 + f64::from(said[m]) / 100.0;
                prop_assert!((frame.position.x - expected).abs() < 1e-9);
                let (_, grip) = new.object(&name(&format!("P{n}")), 1).unwrap();
                prop_assert_eq!(grip.appr_size, 100 + i32::from(*m));
            }
            store = next;
        }
    }
}
