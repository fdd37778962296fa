//! The list of watched fields, saved between sessions in the user's configuration, one field or buffer per line.

use std::{
    env, fs, io,
    path::{Path, PathBuf},
};

use os_io::replace::replace;

use crate::rcs_console::model::buffers::{is_within, paths};

/// Path of the list; `None` without a home directory.
#[must_use]
pub fn place() -> Option<PathBuf> {
    let set = |name| env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let configuration = set("XDG_CONFIG_HOME").or_else(|| set("HOME").map(|home| home.join(".config")));
    configuration.map(|directory| directory.join("rcs-ii").join("watch"))
}

/// The saved list, or an empty one. Names of another version of the buffers are skipped.
#[must_use]
pub fn load(path: &Path) -> Vec<String> {
    let text = fs::read_to_string(path).unwrap_or_default();
    let known = |name: &&str| paths().any(|field| is_within(field, name));
    text.lines().map(str::trim).filter(known).map(str::to_owned).collect()
}

/// Save the list. Fails with the error of the system.
pub fn save(path: &Path, list: &[String]) -> io::Result<()> {
    path.parent().map_or(Ok(()), fs::create_dir_all)?;
    let text: String = list.iter().flat_map(|name| [name.as_str(), "\n"]).collect();
    replace(path, text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn saved_list_loads_without_unknown_names() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("below").join("watch");
        assert!(load(&path).is_empty());
        let list = ["task.status".to_owned(), "no.such.field".to_owned(), "t3i.status.echo".to_owned()];
        save(&path, &list).unwrap();
        assert_eq!(load(&path), ["task.status", "t3i.status.echo"]);
    }
}
