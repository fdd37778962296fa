//! The task data, and the commands of the workstation controller that the searches send.

use std::{path::Path, sync::OnceLock};

use interfaces::HwsCommand;
use taskdata::{
    files::TaskData,
    load::{Step, Store, job::own_command},
};

fn store() -> &'static Store {
    static STORE: OnceLock<Store> = OnceLock::new();
    STORE.get_or_init(|| match Store::load(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"))) {
        Ok((store, _)) => store,
        Err(report) => panic!("{report}"),
    })
}

/// The data of the cell.
pub fn data() -> TaskData<'static> {
    store().view()
}

/// Commands by their lines in a job, without `==`.
pub fn commands(lines: &[&str]) -> Vec<HwsCommand> {
    let read = |line: &&str| match own_command(line, store()).map(|line| line.step) {
        Ok(Step::Command(command)) => command,
        other => panic!("{line}: {other:?}"),
    };
    lines.iter().map(read).collect()
}
