//! Gives the commit for `--version`, if the source is a git repository, and lists the files of `data/` with their bytes.

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
    list_data()
}

/// Write the list of the files that the programs carry.
fn list_data() -> io::Result<()> {
    let here = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").ok_or(io::ErrorKind::NotFound)?);
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or(io::ErrorKind::NotFound)?);
    let root = here.join("../..").canonicalize()?;
    let mut files = Vec::new();
    collect(&root.join("data"), &mut files)?;
    files.sort();
    let entries = files.iter().map(|file| {
        let path = file.strip_prefix(&root).unwrap_or(file);
        format!("    Carried {{ path: {path:?}, bytes: include_bytes!({file:?}) }},\n")
    });
    fs::write(out.join("files.rs"), format!("&[\n{}]\n", entries.collect::<String>()))?;
    // Cargo looks at every file below.
    println!("cargo::rerun-if-changed={}", root.join("data").display());
    Ok(())
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
