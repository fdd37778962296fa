//! The tables of docs/neighbours.md equal the code; `RCS_WRITE_DOCS=1 cargo test -p sessions --test page` writes them.

use std::{env, fmt::Write as _, fs, path::Path};

use neighbours::{
    layout::Table,
    mailbox::{Place, TABLE},
    pedestal::{cell, command, gripper, status, table},
    vision::{areas, picture, request},
    workstation,
};
use sessions::network::Role;

fn mailboxes() -> String {
    let mut page = "| address | bytes | mailbox | written by |\n|---|---|---|---|\n".to_owned();
    for role in Role::ALL {
        let own = role.to_controller().iter().map(|place| (place, role.text()));
        let mut places: Vec<(&Place, &str)> =
            role.from_controller().iter().map(|place| (place, "controller")).chain(own).collect();
        places.sort_by_key(|(place, _)| place.address);
        for (place, writer) in places {
            let ours = if TABLE.contains(place) { "" } else { " (CHOSEN, not in Table IX.1)" };
            let Place { name, address, size } = place;
            writeln!(page, "| {address:05X} | {size} | {name}{ours} | {writer} |").expect("a text takes it");
        }
    }
    page
}

/// Put the generated tables between their marks. Returns the missing marks.
fn generate(page: &str) -> (String, Vec<&'static str>) {
    const LAYOUTS: [(&str, Table); 14] = [
        ("workstation command", workstation::command::CommandLayout::TABLE),
        ("workstation status", workstation::status::StatusLayout::TABLE),
        ("cell line", workstation::cell::LineLayout::TABLE),
        ("cell status", workstation::cell::CellStatusLayout::TABLE),
        ("pedestal command", command::CommandLayout::TABLE),
        ("pedestal status", status::StatusLayout::TABLE),
        ("pedestal gripper", gripper::GripperLayout::TABLE),
        ("pedestal table", table::TableLayout::TABLE),
        ("pedestal sensors", cell::SensorsLayout::TABLE),
        ("pedestal orders", cell::OrdersLayout::TABLE),
        ("vision request", request::RequestLayout::TABLE),
        ("vision response", areas::AreasLayout::TABLE),
        ("vision picture", picture::HeadLayout::TABLE),
        ("vision part", picture::PartLayout::TABLE),
    ];
    let layouts = LAYOUTS.iter().map(|(mark, table)| (*mark, table.markdown()));
    let (mut page, mut missing) = (page.to_owned(), Vec::new());
    for (mark, table) in layouts.chain([("mailboxes", mailboxes())]) {
        let (begin, end) = (format!("<!-- generated: {mark} -->\n"), "<!-- end -->\n");
        let from = page.find(&begin).map(|at| at + begin.len());
        let to = from.and_then(|from| page[from..].find(end).map(|at| from + at));
        match from.zip(to) {
            Some((from, to)) => page.replace_range(from..to, &table),
            None => missing.push(mark),
        }
    }
    (page, missing)
}

#[test]
fn neighbour_tables_of_the_page_equal_the_code() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/neighbours.md");
    let page = fs::read_to_string(&file).expect("a page");
    let (generated, missing) = generate(&page);
    assert_eq!(missing, [""; 0], "marks in {}", file.display());
    if env::var_os("RCS_WRITE_DOCS").is_some() {
        fs::write(&file, generated).expect("the page can be written");
        return;
    }
    let stale = page.lines().zip(generated.lines()).find(|(is, should)| is != should);
    assert_eq!(stale, None, "stale: RCS_WRITE_DOCS=1 cargo test -p sessions --test page");
    assert_eq!(page, generated);
}
