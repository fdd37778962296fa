//! Version, manual pages, completions and reference page, from a program's command line.

#![forbid(unsafe_code)]

mod markdown;
mod removed;
mod values;

use std::{
    env, error,
    error::Error as _,
    ffi::OsString,
    fs, io,
    num::{ParseFloatError, ParseIntError},
    path::Path,
    process,
};

use clap::{
    Arg, Command, Parser, ValueEnum,
    error::{ContextKind, ContextValue, ErrorKind},
};
use clap_complete::{Generator, Shell};
use diagnostics::nearest;
use os_io::{text::plain, units::Units};

pub use markdown::markdown;
pub use removed::{KEYS_MOVED, RemovedTls};
pub use values::{DataArgument, data_directory, default_data, fault_file, job, names, robot, with_names};

/// The version, with the commit if it is known.
pub const VERSION: &str = if env!("RCS_COMMIT").is_empty() {
    env!("CARGO_PKG_VERSION")
} else {
    concat!(env!("CARGO_PKG_VERSION"), " (", env!("RCS_COMMIT"), ")")
};

const GENERATE: &str = "generate"; // must be first and alone

const UNITS: &str = "units"; // option and variable
const UNITS_VARIABLE: &str = "RCS_UNITS";

/// `--generate DIR` writes the pages and ends the process. `--units` or else `RCS_UNITS` sets the units.
#[must_use]
pub fn parse<P: Parser>() -> P {
    let arguments: Vec<_> = env::args_os().map(length_as_value).collect();
    let mut command = command::<P>();
    // The units are needed to parse the other arguments. A wrong value is refused below.
    match units(&arguments, env::var_os(UNITS_VARIABLE)) {
        Ok(units) => units.show(),
        Err(wrong) => refuse(&command.error(ErrorKind::InvalidValue, wrong)),
    }
    if let [_, option, directory] = arguments.as_slice()
        && option.to_str() == Some("--generate")
    {
        process::exit(match generate(&command, Path::new(directory)) {
            Ok(()) => 0,
            Err(error) => {
                os_io::stderr_line!("{}: {}: {error}", command.get_name(), Path::new(directory).display());
                2
            }
        });
    }
    let mut matches = command.try_get_matches_from_mut(&arguments).unwrap_or_else(|mut error| {
        let first = arguments.get(1);
        if let Some(near) = misspelt_subcommand(&command, first) {
            // clap parses the misspelt word as a job, and no argument may follow a job.
            if error.kind() == ErrorKind::ArgumentConflict {
                let word = first.map(|word| word.to_string_lossy().into_owned()).unwrap_or_default();
                error = clap::Error::new(ErrorKind::InvalidSubcommand).with_cmd(&command);
                error.insert(ContextKind::InvalidSubcommand, ContextValue::String(word));
            }
            let tip = format!("a similar subcommand exists: '{near}'");
            error.remove(ContextKind::SuggestedSubcommand);
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
        }
        let expected = error.source().and_then(expected_number);
        if let (Some(expected), Some(argument), Some(value)) =
            (expected, given(&error, ContextKind::InvalidArg), given(&error, ContextKind::InvalidValue))
        {
            let text = format!("invalid value '{value}' for '{argument}': {expected} was expected");
            error = command.error(ErrorKind::ValueValidation, text);
        }
        refuse(&error)
    });
    P::from_arg_matches_mut(&mut matches).unwrap_or_else(|error| refuse(&error.format(&mut command)))
}

/// The expected form of a number.
fn expected_number(source: &(dyn error::Error + 'static)) -> Option<&'static str> {
    if source.is::<ParseIntError>() {
        return Some("a whole number");
    }
    source.is::<ParseFloatError>().then_some("a number")
}

fn given(error: &clap::Error, kind: ContextKind) -> Option<&str> {
    match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text),
        _ => None,
    }
}

/// Prints an error and ends the process. Control characters do not reach the terminal.
fn refuse(error: &clap::Error) -> ! {
    let is_plain = |text: &str| plain(text) == text;
    let mut given = env::args_os().chain(env::var_os(UNITS_VARIABLE));
    if given.all(|text| text.to_str().is_some_and(is_plain)) {
        error.exit();
    }
    os_io::stderr_line!("{}", error.render().to_string().trim_end());
    process::exit(error.exit_code())
}

/// Units from the option, else from the variable, else inches. Only a wrong variable is an error here.
fn units(arguments: &[OsString], variable: Option<OsString>) -> Result<Units, String> {
    let texts = || arguments.iter().skip(1).map(|argument| argument.to_str().unwrap_or_default());
    let option = format!("--{UNITS}");
    let follows = texts().zip(texts().skip(1)).find(|(name, _)| *name == option).map(|(_, value)| value);
    let joined = || texts().find_map(|text| text.strip_prefix(&option)?.strip_prefix('='));
    if let Some(value) = follows.or_else(joined) {
        return Ok(value.parse().unwrap_or_default());
    }
    let variable = variable.filter(|value| !value.is_empty());
    variable.map_or(Ok(Units::default()), |value| {
        value.to_string_lossy().parse().map_err(|wrong| format!("{UNITS_VARIABLE}: {wrong}"))
    })
}

/// Adds a blank before a negative length with a unit, `-1813.8mm`, which clap takes for an option.
fn length_as_value(argument: OsString) -> OsString {
    let is_length = |text: &str| {
        text.starts_with('-') && text.parse::<f64>().is_err() && Units::Inches.length(text).is_ok()
    };
    match argument.to_str() {
        Some(text) if is_length(text) => format!(" {text}").into(),
        _ => argument,
    }
}

/// Parses a length in the units of the command line; returns inches. The error states the expected form.
pub fn length(text: &str) -> Result<f64, String> {
    Units::of_process().length(text)
}

/// The subcommand that was probably meant: clap parses a misspelt one as a job.
fn misspelt_subcommand<'c>(command: &'c Command, first: Option<&OsString>) -> Option<&'c str> {
    let first = first?.to_str()?;
    let names = || command.get_subcommands().map(Command::get_name);
    nearest(first, names()).filter(|_| names().all(|name| name != first))
}

/// Adds the version and `--generate`.
#[must_use]
pub fn command<P: Parser>() -> Command {
    let generate = Arg::new(GENERATE)
        .long(GENERATE)
        .value_name("DIR")
        .exclusive(true)
        .help("Write manual pages, shell completions and the reference page into a directory, and exit");
    let units = Arg::new(UNITS)
        .long(UNITS)
        .value_name("UNIT")
        .global(true)
        .value_parser(Units::WORDS)
        .help(
            "Units that texts show and that lengths are typed in: `in` (also in/s and lb) or `mm` (also mm/s and N); \
             files, logs and JSON keep the manual's units [default: RCS_UNITS, else in]",
        );
    P::command().version(VERSION).arg(generate).arg(units)
}

/// Writes `man/*.1`, `completions/*` and `PROGRAM.md`.
pub fn generate(command: &Command, directory: &Path) -> io::Result<()> {
    let name = command.get_name().to_owned();
    let (manual, completions) = (directory.join("man"), directory.join("completions"));
    fs::create_dir_all(&manual)?;
    fs::create_dir_all(&completions)?;
    clap_mangen::generate_to(command.clone(), &manual)?;
    for shell in Shell::value_variants() {
        let mut text = Vec::new();
        clap_complete::generate(*shell, &mut command.clone(), &name, &mut text);
        fs::write(completions.join(shell.file_name(&name)), text)?;
    }
    fs::write(directory.join(format!("{name}.md")), markdown(command))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A program.
    #[derive(Debug, Parser)]
    #[command(name = "program", after_help = "Examples:\n  program one")]
    struct Program {
        #[command(subcommand)]
        command: Sub,
    }

    #[derive(Debug, clap::Subcommand)]
    enum Sub {
        /// Do one thing | or another
        ///
        /// Then a second one.
        One {
            /// How often
            ///
            /// More than once is unusual.
            #[arg(long, value_name = "N", default_value_t = 1)]
            times: u8,
        },
    }

    #[test]
    fn the_option_decides_over_the_variable() {
        let of = |arguments: &[&str], variable: Option<&str>| {
            let arguments: Vec<OsString> = arguments.iter().map(OsString::from).collect();
            units(&arguments, variable.map(OsString::from))
        };
        assert_eq!(of(&["program"], None), Ok(Units::Inches));
        assert_eq!(of(&["program"], Some("mm")), Ok(Units::Millimetres));
        assert_eq!(of(&["program", "one", "--units", "in"], Some("mm")), Ok(Units::Inches));
        assert_eq!(of(&["program", "--units=mm", "one"], None), Ok(Units::Millimetres));
        assert_eq!(of(&["program"], Some("")), Ok(Units::Inches));
        assert_eq!(
            of(&["program"], Some("cm")),
            Err("RCS_UNITS: in or mm was expected, found cm".to_owned())
        );
        let wrong = command::<Program>().try_get_matches_from(["program", "--units", "cm", "one"]);
        assert_eq!(wrong.unwrap_err().kind(), ErrorKind::InvalidValue);
    }

    #[test]
    fn a_negative_length_with_a_unit_is_a_value() {
        #[derive(Debug, Parser)]
        #[command(allow_negative_numbers = true)]
        struct Point {
            #[arg(num_args = 3, value_parser = length)]
            point: Vec<f64>,
            #[arg(long)]
            tilt: f64,
        }
        let arguments = ["point", "-25.4mm", "-2", "-3in", "--tilt", "-20"].map(OsString::from);
        let Point { point, tilt } = Point::try_parse_from(arguments.map(length_as_value)).unwrap();
        assert_eq!((point, tilt), (vec![-1.0, -2.0, -3.0], -20.0));
        for other in ["-x", "--in", "-", "-mm"] {
            assert_eq!(length_as_value(other.into()), OsString::from(other));
        }
    }

    #[test]
    fn the_pages_come_from_the_definition() {
        let place = tempfile::tempdir().unwrap();
        generate(&command::<Program>(), place.path()).unwrap();
        let read = |name: &str| fs::read_to_string(place.path().join(name)).unwrap();
        assert!(read("man/program-one.1").contains("How often"));
        assert!(read("completions/program.bash").contains("--times"));
        let page = read("program.md");
        assert!(page.starts_with("# program\n\nA program.\n"), "{page}");
        assert!(
            page.contains("- `--times <N>` (default `1`): How often. More than once is unusual."),
            "{page}"
        );
        assert!(page.contains("Do one thing \\| or another.\n\nThen a second one.\n"), "{page}");
        assert!(page.contains("```text\nExamples:\n  program one\n```"), "{page}");
    }
}
