//! Sets the commit for `--version`, if the source is a git repository, and embeds in the programs the files of `data/`
//! and the sources of the decision tables, which the console shows.

use std::{
    env, fs, io,
    path::{Path, PathBuf},
    process::Command,
};

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=build.rs");
    // Each commit adds a line to this file.
    if let Some(log) = git(&["rev-parse", "--path-format=absolute", "--git-path", "logs/HEAD"]) {
        println!("cargo::rerun-if-changed={log}");
    }
    let commit = git(&["rev-parse", "--short=9", "HEAD"]);
    println!("cargo::rustc-env=RCS_COMMIT={}", commit.unwrap_or_default());
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").ok_or(io::ErrorKind::NotFound)?);
    let root = root.join("..").canonicalize()?;
    list_data(&root)?;
    list_tables(&root)
}

/// Write the list of the embedded data files.
fn list_data(root: &Path) -> io::Result<()> {
    let entries = files(&root.join("data"))?.into_iter().map(|file| {
        let path = file.strip_prefix(root).unwrap_or(&file);
        format!("    Carried {{ path: {path:?}, bytes: include_bytes!({file:?}) }},\n")
    });
    write("files.rs", entries)
}

/// Write the list of the sources with decision tables.
fn list_tables(root: &Path) -> io::Result<()> {
    let mut entries = Vec::new();
    for file in files(&root.join("crates/levels/src"))? {
        let is_rust = file.extension().is_some_and(|extension| extension == "rs");
        if is_rust && fs::read_to_string(&file)?.contains("decision_table!") {
            let path = file.strip_prefix(root).unwrap_or(&file);
            entries.push(format!("    ({path:?}, include_str!({file:?})),\n"));
        }
    }
    write("tables.rs", entries)
}

/// Write a list as an expression of Rust.
fn write(name: &str, entries: impl IntoIterator<Item = String>) -> io::Result<()> {
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or(io::ErrorKind::NotFound)?);
    fs::write(out.join(name), format!("&[\n{}]\n", entries.into_iter().collect::<String>()))
}

/// All files below a directory, sorted by path. A change of one of them makes cargo run this script again.
fn files(directory: &Path) -> io::Result<Vec<PathBuf>> {
    println!("cargo::rerun-if-changed={}", directory.display());
    let mut files = Vec::new();
    collect(directory, &mut files)?;
    files.sort();
    Ok(files)
}

fn collect(directory: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(directory)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else {
            files.push(path);
        }
    }
    Ok(())
}
