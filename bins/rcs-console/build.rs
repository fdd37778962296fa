//! Lists the sources of the decision tables, which the source view shows.

use std::{env, fmt::Write as _, fs, io, path::Path};

fn main() -> io::Result<()> {
    let levels =
        Path::new(&env::var("CARGO_MANIFEST_DIR").unwrap_or_default()).join("../../crates/levels/src");
    let levels = levels.canonicalize()?;
    println!("cargo::rerun-if-changed={}", levels.display());
    let mut list = String::from("&[\n");
    let mut open = vec![levels.clone()];
    while let Some(directory) = open.pop() {
        let mut entries: Vec<_> = fs::read_dir(directory)?.collect::<Result<_, _>>()?;
        entries.sort_by_key(fs::DirEntry::path);
        for path in entries.into_iter().map(|entry| entry.path()) {
            if path.is_dir() {
                open.push(path);
                continue;
            }
            let is_rust = path.extension().is_some_and(|extension| extension == "rs");
            if is_rust && fs::read_to_string(&path)?.contains("decision_table!") {
                let name = path.strip_prefix(&levels).map_err(io::Error::other)?;
                let name = format!("crates/levels/src/{}", name.display());
                writeln!(list, "    ({name:?}, include_str!({:?})),", path.display().to_string())
                    .map_err(io::Error::other)?;
            }
        }
    }
    list.push(']');
    fs::write(Path::new(&env::var("OUT_DIR").unwrap_or_default()).join("tables.rs"), list)
}
