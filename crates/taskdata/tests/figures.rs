//! The manual's figures can be read as printed, and the shipped data agree with them.

use std::{collections::BTreeMap, path::Path};

use diagnostics::{BlockNumber, Problems, Source};
use taskdata::load::{
    entries::Entry,
    lex::words,
    parse::{Parsed, parse},
    source::{blocks, places_in_blocks, read_blocks_under},
};

/// Blocks of [`FIGURES`] that repeat another (Figures VIII.7 and VIII.10).
const REPEATED: [(u32, u32); 2] = [(802, 702), (811, 711)];

const FIGURES: &str = include_str!("figures.blk");

fn figures() -> Source {
    Source { name: "figures.blk".to_owned(), text: FIGURES.into() }
}

fn block_words(sources: &[Source]) -> BTreeMap<BlockNumber, Vec<String>> {
    let mut found = BTreeMap::new();
    for (index, source) in sources.iter().enumerate() {
        let (blocks, faults) = blocks(index, source);
        assert_eq!(faults, [], "{}", source.name);
        for block in blocks {
            let mut problems = Problems::default();
            let mut lines: Vec<String> = Vec::new();
            for word in words(&block, &mut problems) {
                match lines.last_mut() {
                    Some(line) if !word.first => *line = format!("{line} {}", word.text),
                    _ => lines.push(word.text.to_owned()),
                }
            }
            assert!(!problems.has_errors());
            assert!(found.insert(block.number, lines).is_none(), "{} is given twice", block.number);
        }
    }
    found
}

fn parsed(source: &Source) -> Vec<(BlockNumber, Parsed)> {
    let mut problems = Problems::default();
    let (blocks, _) = blocks(0, source);
    let read = blocks.iter().map(|block| {
        let words = words(block, &mut problems);
        (block.number, parse(&words, block.number, block.header, &mut problems))
    });
    let all = read.collect();
    let said: Vec<String> = problems
        .into_diagnostics(&mut places_in_blocks(std::slice::from_ref(source)))
        .iter()
        .map(|d| format!("{} {d}", d.place()))
        .collect();
    assert_eq!(said, Vec::<String>::new());
    all
}

fn kind(entry: &Entry) -> &'static str {
    match entry {
        Entry::Pose(_) => "pose",
        Entry::Movetable(_) => "movetable",
        Entry::Locpt(_) => "location point",
        Entry::Array(_) => "array",
        Entry::ArrayAt(_) => "array location",
        Entry::Owner(_) => "owner",
        Entry::Traj(_) => "trajectory",
        Entry::Object(_) => "object",
        Entry::ObjGrips(_) => "object grips",
        Entry::ObjLoc(_) => "object location",
        Entry::PedPara(_) => "pedestal",
        Entry::Grip(_) => "grip",
        Entry::View(_) => "view",
        Entry::ApprDept(_) => "approach or depart",
        Entry::File(_) => "file",
        Entry::Sensor(_) => "sensor",
        Entry::Relative(_) => "relative move",
    }
}

#[test]
fn every_figure_is_read_without_findings() {
    let mut count: BTreeMap<&str, usize> = BTreeMap::new();
    let mut loads = 0;
    for (_, block) in parsed(&figures()) {
        loads += block.loads.len();
        for entry in &block.entries {
            *count.entry(kind(entry)).or_default() += 1;
        }
    }
    let expected = BTreeMap::from([
        ("pose", 1),
        ("movetable", 3 + 9 + 5),
        ("location point", 14),
        ("array", 2 * 3),
        ("array location", 2 * 3),
        ("owner", 2 + 2),
        ("trajectory", 2),
        ("object", 4 + 2 + 2),
        ("object grips", 3 + 2),
        ("object location", 2 + 2),
        ("pedestal", 1),
        ("grip", 9 + 5 + 2),
        ("view", 2 + 2),
        ("approach or depart", 4 + 4 + 2 + 2 + 2 + 2 + 2 + 2),
    ]);
    assert_eq!(count, expected);
    assert_eq!(loads, 14, "Figure VIII.12");
}

#[test]
fn data_equal_the_figures_except_for_marked_readings() {
    let data =
        block_words(&read_blocks_under(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"))).0);
    let mut differences = Vec::new();
    for (number, printed) in block_words(&[figures()]) {
        let number = BlockNumber {
            number: REPEATED.iter().find(|r| r.0 == number.number).map_or(number.number, |r| r.1),
            ..number
        };
        let entered = data.get(&number).unwrap_or_else(|| panic!("{number} is missing in data"));
        assert_eq!(printed.len(), entered.len(), "{number}");
        for (printed, entered) in printed.iter().zip(entered) {
            if printed != entered {
                differences.push(format!("{}: {printed} -> {entered}", number.number));
            }
        }
    }
    assert_eq!(
        differences,
        ["457: 1 t 15 15 125 ---- -> 1 t 15 19 100 ----", "457: 1 t 05 15 100 ---- -> 1 t 25 15 100 ----"]
    );
}

/// The source of each block, from the first remark in it; empty without one.
fn origins(source: &Source) -> Vec<(BlockNumber, String)> {
    let (blocks, _) = blocks(0, source);
    let said = |start: u32| {
        let after_header = source.text[start as usize..].lines().nth(1).unwrap_or_default();
        after_header.strip_prefix("%% From: ").unwrap_or_default().to_owned()
    };
    blocks.iter().map(|block| (block.number, said(block.header.start))).collect()
}

#[test]
fn every_block_of_the_data_names_its_source() {
    // The figures of each block, according to the remark above it.
    let mut figure_of: BTreeMap<BlockNumber, Vec<&str>> = BTreeMap::new();
    let printed = figures();
    for block in blocks(0, &printed).0 {
        let above = printed.text[..block.header.start as usize].lines().last().unwrap();
        let number =
            REPEATED.iter().find(|r| r.0 == block.number.number).map_or(block.number.number, |r| r.1);
        let figure = above.strip_prefix("%% Figure ").unwrap();
        figure_of.entry(BlockNumber { number, ..block.number }).or_default().push(figure);
    }
    let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"));
    let mut count = 0;
    for (number, origin) in read_blocks_under(data).0.iter().flat_map(origins) {
        match figure_of.get(&number).map(Vec::as_slice) {
            None => {
                assert!(origin.starts_with("derived") || origin.starts_with("taught"), "{number}: {origin}")
            }
            Some([figure]) => assert_eq!(origin, format!("Figure {figure}."), "{number}"),
            Some(figures) => assert_eq!(origin, format!("Figures {}.", figures.join(" and ")), "{number}"),
        }
        count += 1;
    }
    assert!(count > figure_of.len());
}

#[test]
fn negative_numbers_leading_zeros_and_signs_parse() {
    let Entry::Pose(pose) = &parsed(&figures())[0].1.entries[0] else { panic!("Figure VII.1 comes first") };
    assert_eq!(pose.points, [[6497, -2366, 1569], [9495, -2475, 1595], [9523, -1460, -1228]]);
    let all = parsed(&figures());
    let sizes = all.iter().flat_map(|(_, p)| &p.entries).find_map(|e| match e {
        Entry::Object(o) if o.name.name.as_str() == "LINKBAR1" => Some(o.values),
        _ => None,
    });
    assert_eq!(sizes, Some([300, 60, 30, 350]));
}
