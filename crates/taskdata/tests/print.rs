//! Every form, with any contents, can be printed and read again without a change.

use diagnostics::{At, Problems, Source};
use geometry::movetable::{MovetableLine, System};
use proptest::{prelude::*, sample::select};
use rcs_core::name::Name;
use taskdata::{
    files::{Direction, RefType, SensorSource, TrajPara},
    load::{
        entries::{
            ApprDeptEntry, ArrayEntry, Entry, FileEntry, GripEntry, MovetableEntry, Named, ObjLocEntry,
            ObjectEntry, OwnerEntry, PointAt, PointEntry, PoseEntry, RelativeEntry, SensorEntry, ShowEntry,
            TrajEntry, Typed, ViewEntry,
        },
        lex::words,
        parse::parse,
        parser::COMPILING_WORDS,
        print,
        source::{BLOCK_COLUMNS, BLOCK_LINES, blocks, places_in_blocks},
        store::FILE_NAMES,
    },
};

fn named<const N: usize>() -> impl Strategy<Value = Named<N>> {
    let text = proptest::string::string_regex(&format!("[A-Z][A-Z0-9._+/-]{{0,{}}}", N - 1)).unwrap();
    text.prop_filter("a compiling word is not a name", |text| !COMPILING_WORDS.contains(&text.as_str()))
        .prop_map(|text| Named { name: Name::new(&text).unwrap(), at: At::default() })
}

fn wide() -> impl Strategy<Value = Named<16>> {
    named::<10>().prop_map(|n| Named { name: Name::clipped(n.name.as_str()), at: n.at })
}

fn typed(kinds: &'static [RefType]) -> impl Strategy<Value = Typed> {
    (select(kinds), wide(), named::<16>()).prop_map(|(kind, short, long)| {
        let name = match kind {
            RefType::Any => Named { name: Name::clipped("$$$"), at: At::default() },
            RefType::Object | RefType::View => long,
            _ => short,
        };
        Typed { kind, name }
    })
}

const PLACES: &[RefType] = &[RefType::LocationPoint, RefType::Array, RefType::Owner, RefType::Any];
const ENDS: &[RefType] = &[RefType::LocationPoint, RefType::Array, RefType::Owner];
const POINTS: &[RefType] = &[RefType::Pose, RefType::LocationPoint, RefType::Movetable];

fn para() -> impl Strategy<Value = TrajPara> {
    (1..=1000, 1..=140, 1..=1000, 0..=5000).prop_map(|(acc_fac, vel_max, smooth, brk_dst)| TrajPara {
        acc_fac,
        vel_max,
        smooth,
        brk_dst,
    })
}

fn through() -> impl Strategy<Value = PointEntry> {
    (para(), typed(POINTS)).prop_map(|(para, target)| PointEntry {
        para,
        target: Some(target),
        at: At::default(),
    })
}

fn pose() -> impl Strategy<Value = Entry> {
    (prop::array::uniform3(prop::array::uniform3(-20_000..=20_000)), named(), named()).prop_map(
        |(points, movetable, name)| Entry::Pose(PoseEntry { points, at: At::default(), movetable, name }),
    )
}

fn movetable() -> impl Strategy<Value = Entry> {
    let line = (
        select(&[System::World, System::Tool, System::ToolOrigin, System::WristOrigin, System::Roll][..]),
        prop::array::uniform3(-18_000..=18_000),
    );
    let line = line.prop_map(|(system, [x, y, z])| {
        let values = match system {
            System::Roll => [x, 0, 0],
            System::ToolOrigin | System::WristOrigin => [x, y, 0],
            _ => [x, y, z],
        };
        MovetableLine { system, values }
    });
    (prop::collection::vec(line, 1..=8), named())
        .prop_map(|(lines, name)| Entry::Movetable(MovetableEntry { lines, name }))
}

fn point_at() -> impl Strategy<Value = PointAt> {
    (named(), named(), named()).prop_map(|(name, pose, movetable)| PointAt { name, pose, movetable })
}

fn array() -> impl Strategy<Value = Entry> {
    (named(), 1..=2, 1..=100, 1..=100, named(), named(), 0..=1).prop_map(
        |(name, dimensions, columns, rows, column_step, row_step, present)| {
            let two = dimensions == 2;
            Entry::Array(ArrayEntry {
                name,
                dimensions,
                columns,
                rows: if two { rows } else { 1 },
                column_step,
                row_step: two.then_some(row_step),
                present,
            })
        },
    )
}

fn owner() -> impl Strategy<Value = Entry> {
    const MEMBERS: &[RefType] = &[RefType::LocationPoint, RefType::Array, RefType::Pose];
    (named(), prop::collection::vec(typed(MEMBERS), 1..=40))
        .prop_map(|(name, members)| Entry::Owner(OwnerEntry { name, members }))
}

fn trajectory() -> impl Strategy<Value = Entry> {
    (named(), typed(ENDS), typed(ENDS), prop::collection::vec(through(), 0..=15))
        .prop_map(|(name, start, end, points)| Entry::Traj(TrajEntry { name, start, end, points }))
}

fn object() -> impl Strategy<Value = Entry> {
    (named(), -99..=99, [0..=500, 0..=500, 0..=200, 0..=500])
        .prop_map(|(name, grip, values)| Entry::Object(ObjectEntry { name, grip, at: At::default(), values }))
}

fn show() -> impl Strategy<Value = Entry> {
    let ped = [0..=500, 0..=500, 0..=200, 0..=500, -3600..=3600, -3600..=3600];
    prop_oneof![
        (named(), [1..=3, -99..=99])
            .prop_map(|(object, values)| Entry::ObjGrips(ShowEntry { object, values })),
        (named(), ped).prop_map(|(object, values)| Entry::PedPara(ShowEntry { object, values })),
    ]
}

fn of_objects() -> impl Strategy<Value = Entry> {
    const ASSIGNED: &[RefType] = &[RefType::Array, RefType::LocationPoint];
    const OFFSET_FROM: &[RefType] = &[RefType::LocationPoint, RefType::Array, RefType::Object];
    prop_oneof![
        (named(), typed(ASSIGNED))
            .prop_map(|(object, assigned)| Entry::ObjLoc(ObjLocEntry { object, assigned })),
        (named(), -99..=99, typed(PLACES), named()).prop_map(|(object, grip, place, movetable)| Entry::Grip(
            GripEntry { object, grip, place, movetable }
        )),
        (named(), -99..=99, 0..=255, typed(PLACES), named(), select(OFFSET_FROM), 1..=3000, any::<bool>())
            .prop_map(|(object, grip, id, place, movetable, offset_from, range, enabled)| {
                Entry::View(ViewEntry { object, grip, id, place, movetable, offset_from, range, enabled })
            }),
    ]
}

fn approach_depart() -> impl Strategy<Value = Entry> {
    const SUBJECTS: &[RefType] = &[
        RefType::Object,
        RefType::View,
        RefType::LocationPoint,
        RefType::Array,
        RefType::Owner,
        RefType::Any,
    ];
    let parts = (
        any::<bool>(),
        typed(SUBJECTS),
        -99..=99,
        typed(PLACES),
        prop::collection::vec(through(), 0..=13),
        para(),
    );
    parts.prop_map(|(approach, subject, grip, place, mut points, stop)| {
        if approach {
            points.push(PointEntry { para: stop, target: None, at: At::default() });
        }
        let of_object = matches!(subject.kind, RefType::Object | RefType::View);
        Entry::ApprDept(ApprDeptEntry {
            direction: if approach { Direction::Approach } else { Direction::Depart },
            subject,
            grip: if of_object { grip } else { 0 },
            place: of_object.then_some(place),
            points,
            at: At::default(),
        })
    })
}

fn extensions() -> impl Strategy<Value = Entry> {
    prop_oneof![
        (select(&FILE_NAMES[..]), 1..=100_000_usize).prop_map(|(file, records)| Entry::File(FileEntry {
            file,
            records,
            at: At::default()
        })),
        (named(), select(SensorSource::ALL), 1..=3, prop_oneof![1..=1000, -1000..=-1]).prop_map(
            |(name, source, which, threshold)| {
                let (which, threshold) = if source.is_force() { (0, threshold) } else { (which, 0) };
                Entry::Sensor(SensorEntry { name, source, which, threshold })
            }
        ),
        (named(), typed(PLACES), para(), named(), prop::option::of(named())).prop_map(
            |(name, place, para, movetable, sensor)| {
                Entry::Relative(RelativeEntry { name, place, para, movetable, sensor, at: At::default() })
            }
        ),
    ]
}

fn entry() -> impl Strategy<Value = Entry> {
    prop_oneof![
        pose(),
        movetable(),
        point_at().prop_map(Entry::Locpt),
        array(),
        point_at().prop_map(Entry::ArrayAt),
        owner(),
        trajectory(),
        object(),
        show(),
        of_objects(),
        approach_depart(),
        extensions(),
    ]
}

fn said(entry: &Entry) -> String {
    let text = format!("{entry:?}");
    let mut out = String::new();
    let mut rest = text.as_str();
    while let Some(begin) = rest.find("At { source") {
        out.push_str(&rest[..begin]);
        let mut depth = 0;
        let end = rest[begin..]
            .find(|c| {
                depth += match c {
                    '{' => 1,
                    '}' => -1,
                    _ => 0,
                };
                c == '}' && depth == 0
            })
            .unwrap();
        rest = &rest[begin + end + 1..];
    }
    out + rest
}

fn read(text: &str) -> Vec<Entry> {
    let source = Source { name: "printed.blk".to_owned(), text: text.into() };
    let (blocks, faults) = blocks(0, &source);
    assert_eq!(faults, [], "{text}");
    let mut entries = Vec::new();
    let mut problems = Problems::default();
    for block in &blocks {
        let words = words(block, &mut problems);
        entries.extend(parse(&words, block.number, block.header, &mut problems).entries);
    }
    let said: Vec<String> = problems
        .into_diagnostics(&mut places_in_blocks(&[source]))
        .iter()
        .map(|d| format!("{} {d}", d.place()))
        .collect();
    assert_eq!(said, Vec::<String>::new(), "{text}");
    entries
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]
    #[test]
    fn every_printed_form_reads_back(entry in entry()) {
        let lines = print::form(&entry);
        prop_assert!(lines.len() <= BLOCK_LINES && lines.iter().all(|line| line.len() <= BLOCK_COLUMNS), "{lines:#?}");
        let text = format!("BLOCK# 1 OFFSET 20000\n{}\n", lines.join("\n"));
        let again = read(&text);
        prop_assert_eq!(again.len(), 1, "{}", text);
        prop_assert_eq!(said(&again[0]), said(&entry), "{}", text);
    }

    #[test]
    fn many_entries_fill_blocks(entries in prop::collection::vec(entry(), 0..60)) {
        let text = print::blocks(&entries, 20_000, 990);
        let again = read(&text);
        let (one, other): (Vec<_>, Vec<_>) = (again.iter().map(said).collect(), entries.iter().map(said).collect());
        prop_assert_eq!(one, other, "{}", text);
        // Printing the entries that were read gives the same text.
        prop_assert_eq!(print::blocks(&again, 20_000, 990), text);
    }
}

#[test]
fn printed_form_equals_that_of_the_manual() {
    let text = "BLOCK# 1 OFFSET 20000
  -appr obj LINKBAR1 2 lpt UNIT_2
  -ppt 5 30 40 150 mtb A/D-5
  -ppt 4 10 40 50 stop
  1 t -20 0 210 ----
  2 to -300 0 -mtb- LK-GRP-1
  :S \"object\" <= LCLEVIS
  endeff-id# <= 1
  tray-grip# <= 1
  :R >FILE OBJ-GRIPS
";
    assert_eq!(print::blocks(&read(text), 20_000, 1), text);
}
