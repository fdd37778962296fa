//! `rcs-gateway person`: adds, removes and lists the persons who may open the page.

use os_io::console;

use crate::{
    cli::PersonCommand,
    error::Error,
    page::people::{self, People},
};

/// Carries out a command. Fails if the file cannot be used, or the person already exists or is missing.
pub fn run(command: &PersonCommand) -> Result<(), Error> {
    let text = match command {
        PersonCommand::Add { name, role, people } => {
            let secret = people::add(people, name, *role)?;
            format!("{secret}\nThis is the secret of {name}, {role}. It is not shown again.\n")
        }
        PersonCommand::Remove { name, people } => {
            people::remove(people, name)?;
            return Ok(());
        }
        PersonCommand::List { people } => People::load(people)?.to_string(),
    };
    Ok(console::answer(&text)?)
}
