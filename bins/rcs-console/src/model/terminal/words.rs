//! The words of a board's terminal (IV.2, IV.3): numbers are pushed on a stack, and words pop them, as in FORTH. A word
//! that affects the run becomes a request in modern words ([`operator`]).

use interfaces::{ProcessId, operator::Variable};
use levels::ladder::Ladder;
use taskdata::load::{BlockNumber, source::BLOCK_LINES};

use super::{BOARDS, Board, Mode, library::Library, pointer::target, said, teach::PoseLesson};
use crate::rcs_console::{
    model::{
        Text, Tone,
        views::{SHOW_WORDS, VOCABULARIES, fields_named, lines},
    },
    picture::Picture,
};

const WORDS: [&str; 17] = [
    "GO",
    "SSGO",
    "^C",
    ".R",
    ":R",
    ":S",
    "LIST",
    "LOAD",
    "OLOAD",
    "LINE-LOAD",
    "OFFSET",
    "LOC",
    "BOARD",
    "EDIT",
    "TEACH",
    "DB-DONE",
    "%",
];

/// Words that execute a process once, such as PRIM-LEVEL (IV.3.3 step 13; VI.2, VI.5); some are not in the manual.
static LEVELS: [(&str, ProcessId, &str); 9] = [
    ("TASK-LEVEL", ProcessId::Task, "TASK"),
    ("SUBTASK-LEVEL", ProcessId::Subtask, "SUBTASK"),
    ("EMOVE-LEVEL", ProcessId::Emove, "EMOVE"),
    ("PRIM-LEVEL", ProcessId::Prim, "PRIM"),
    ("T3I-LEVEL", ProcessId::T3i, "T3I"),
    ("QC-LEVEL", ProcessId::QuickChange, "QUICK-CHANGE"),
    ("GRIP-LEVEL", ProcessId::Grip, "GRIP"),
    ("VG-LEVEL", ProcessId::VGrip, "V-GRIP"),
    ("TG-LEVEL", ProcessId::ToolGrip, "TOOL-GRIP"),
];

#[derive(Debug, Default)]
pub struct Outcome {
    pub asks: Vec<String>,
    pub said: Vec<Text>,
    pub edits: Option<BlockNumber>,
    pub teaches: Option<PoseLesson>,
    pub listed: Option<BlockNumber>,
}

pub struct Interpreter<'a> {
    pub board: &'a mut Board,
    pub library: &'a mut Library,
    pub picture: Option<&'a Picture>,
    pub last: Option<&'a Picture>,
    stack: Vec<u32>,
    pub(super) outcome: Outcome,
}

/// True if a line consists of words of a terminal; otherwise it is a request in modern words.
#[must_use]
pub fn is_of_terminal(line: &str, mode: Mode) -> bool {
    let first = line.split_whitespace().next().unwrap_or_default();
    let is_word = WORDS.contains(&first)
        || LEVELS.iter().any(|(word, ..)| *word == first)
        || SHOW_WORDS.iter().any(|word| word.word == first)
        || VOCABULARIES.iter().any(|(word, _)| *word == first)
        || said::of_word(first).is_some();
    let writes = line.split_whitespace().any(|word| word == "<=");
    is_word || writes || mode == Mode::Show || first.parse::<u32>().is_ok()
}

/// The words of a board's terminal for completion.
#[must_use]
pub fn known(board: u8) -> Vec<&'static str> {
    let levels = LEVELS.iter().filter(|(_, process, _)| process.board() == board).map(|(word, ..)| *word);
    let shown = SHOW_WORDS.iter().filter(|word| word.board == board).map(|word| word.word);
    let vocabularies = VOCABULARIES.iter().map(|(word, _)| *word);
    WORDS.into_iter().chain(levels).chain(shown).chain(vocabularies).collect()
}

impl<'a> Interpreter<'a> {
    pub fn new(
        board: &'a mut Board,
        library: &'a mut Library,
        picture: Option<&'a Picture>,
        last: Option<&'a Picture>,
    ) -> Self {
        Self { board, library, picture, last, stack: Vec::new(), outcome: Outcome::default() }
    }

    /// Execute a line up to its first wrong word.
    #[must_use]
    pub fn interpret(mut self, line: &str) -> Outcome {
        let words: Vec<&str> = line.split_whitespace().collect();
        let mut at = 0;
        while let Some(word) = words.get(at) {
            let behind = words.get(at + 1..).unwrap_or_default();
            match self.word(word, behind) {
                Ok(used) => at += 1 + used,
                Err(why) => {
                    self.outcome.said.push(Text::new(Tone::Trouble, format!("!!{word}: {why}")));
                    break;
                }
            }
        }
        self.outcome
    }

    pub(super) fn say(&mut self, text: impl Into<String>) {
        self.outcome.said.push(Text::plain(text));
    }

    /// Execute one word. Returns the number of following words that belong to it.
    fn word(&mut self, word: &str, rest: &[&str]) -> Result<usize, String> {
        let behind = rest.first().copied();
        if let Ok(number) = word.parse() {
            self.stack.push(number);
            return Ok(0);
        }
        match word {
            ":R" => self.board.mode = Mode::Run,
            ":S" => self.board.mode = Mode::Show,
            "GO" => self.go()?,
            "SSGO" => self.on(0).map(|()| self.outcome.asks.push("board 0 go".to_owned()))?,
            "^C" => self.stop()?,
            ".R" => self.on(2).map(|()| self.outcome.asks.push("robot-init".to_owned()))?,
            "LIST" => self.list()?,
            "EDIT" => self.edit()?,
            "TEACH" => return self.teach(rest),
            "LOAD" => {
                let number = self.pop("n LOAD")?;
                self.load(BlockNumber { offset: self.board.offset, number })?;
            }
            "OLOAD" => {
                let number = self.pop("offset n OLOAD")?;
                let offset = self.pop("offset n OLOAD")?;
                self.load(BlockNumber { offset, number })?;
            }
            "LINE-LOAD" => self.line_load()?,
            "OFFSET" => return self.offset(behind),
            "LOC" => return self.locate(behind),
            "BOARD" => return self.turn_to(behind),
            "<=" => return self.write(rest),
            "DB-DONE" => self.on(6).map(|()| self.outcome.asks.push("db-done on".to_owned()))?,
            "%" => return self.comment(rest),
            _ => return self.named(word),
        }
        Ok(0)
    }

    fn named(&mut self, word: &str) -> Result<usize, String> {
        if let Some((_, process, name)) = LEVELS.iter().find(|(level, ..)| *level == word) {
            self.on(process.board())?;
            self.execute(name);
            return Ok(0);
        }
        if let Some(show) = SHOW_WORDS.iter().find(|show| show.word == word) {
            self.on(show.board)?;
            self.board.shown = Some(show);
            return Ok(0);
        }
        if let Some((name, process)) = VOCABULARIES.iter().find(|(name, _)| *name == word) {
            if let Some(process) = process {
                self.on(process.board())?;
            }
            self.board.vocabulary = name;
            let about = process.map_or_else(
                || "for all processes of this board".to_owned(),
                |process| {
                    let tables = Ladder::processes()[process.position()].tables.iter();
                    let tables: Vec<_> = tables.map(|table| table.name).collect();
                    format!("{process}: tables {}", tables.join(", "))
                },
            );
            self.say(format!("  {name}: {about}"));
            return Ok(0);
        }
        if let Some(text) = said::of_word(word) {
            self.say(format!("  {text}"));
            return Ok(0);
        }
        if self.board.mode == Mode::Show {
            return self.show(word);
        }
        Err("this is not a word of the terminal; :S shows variables, ? lists the words".to_owned())
    }

    /// Show mode: print type and value of a variable (IV.2.6).
    fn show(&mut self, name: &str) -> Result<usize, String> {
        let picture = self.picture.ok_or("the run has published no tick yet")?;
        let here: Vec<&str> = self.board.buffers();
        let mut fields = fields_named(name, &here);
        let variable = variable_named(name);
        self.board.variable = variable.filter(|variable| variable.owner().board() == self.board.number);
        if let Some(whole) = self.board.variable.map(Variable::text) {
            fields.retain(|field| *field != whole);
            fields.push(whole);
        }
        if fields.is_empty() {
            let elsewhere = fields_named(name, &[]).into_iter().chain(variable.map(Variable::text)).next();
            if let Some(path) = elsewhere {
                let board = ProcessId::ALL.iter().find(|process| path.starts_with(process.field()));
                return Err(board.map_or_else(
                    || format!("it is the input {path}"),
                    |process| format!("board {} has it: {path}", process.board()),
                ));
            }
            return Err(
                "there is no such variable; names are those of chapters V and VI, or of screen 2".to_owned()
            );
        }
        let mut shown = Vec::new();
        for field in &fields {
            shown.extend(lines(&[field], picture, self.last));
            shown.extend(target(field, picture, self.library).into_iter().map(Text::plain));
        }
        self.outcome.said.extend(shown.into_iter().take(BLOCK_LINES));
        if let Some(variable) = self.board.variable {
            let (form, owner) = (variable.form(), variable.owner());
            self.say(format!("  {variable} <= {form}, while {owner} is stopped or held"));
        }
        Ok(0)
    }

    /// `% r DB-DONE`: the routine of block 903 is commented out (IV.3.2 step 1).
    fn comment(&mut self, rest: &[&str]) -> Result<usize, String> {
        match rest {
            ["r", "DB-DONE", ..] | ["DB-DONE", ..] => {
                self.on(6)?;
                self.outcome.asks.push("db-done off".to_owned());
                Ok(1 + usize::from(rest.first() == Some(&"r")))
            }
            _ => Err("% DB-DONE was expected: no other routine can be commented out".to_owned()),
        }
    }

    /// `<= VALUE`: write the last variable shown (IV.2.6).
    fn write(&mut self, value: &[&str]) -> Result<usize, String> {
        let known: Vec<&str> = self.board.variables().map(Variable::text).collect();
        let variable = self.board.variable.ok_or_else(|| {
            let number = self.board.number;
            match known.as_slice() {
                [] => format!("board {number} has no variable that can be written"),
                known => {
                    format!("a variable that can be written was expected before it: {}", known.join(", "))
                }
            }
        })?;
        self.outcome.asks.push(format!("write {variable} {}", value.join(" ")));
        Ok(value.len())
    }

    pub(super) fn pop(&mut self, form: &str) -> Result<u32, String> {
        self.stack.pop().ok_or_else(|| format!("a number is missing: {form}"))
    }

    /// Check that the terminal is set to this board.
    pub(super) fn on(&self, board: u8) -> Result<(), String> {
        if self.board.number == board {
            return Ok(());
        }
        let number = self.board.number;
        Err(format!(
            "it is a word of board {board}, this terminal speaks to board {number}: Tab turns to the next"
        ))
    }

    fn go(&mut self) -> Result<(), String> {
        match self.board.number {
            0 => Err("on board 0 it is SSGO, which gives the pulse".to_owned()),
            12 => Err("board 12 had the graphics: screen 1 shows them, and always runs".to_owned()),
            number => {
                self.outcome.asks.push(format!("board {number} go"));
                Ok(())
            }
        }
    }

    fn stop(&mut self) -> Result<(), String> {
        match self.board.number {
            12 => Err("board 12 had the graphics: screen 1 shows them, and needs no stop".to_owned()),
            number => {
                self.outcome.asks.push(format!("board {number} stop"));
                Ok(())
            }
        }
    }

    /// Add a pass; passes of the same process become one request.
    fn execute(&mut self, name: &str) {
        let request = format!("execute {name}");
        let passes = self.outcome.asks.last().and_then(|last| last.strip_prefix(&request)).map(|rest| {
            let passes: u8 = rest.trim().parse().unwrap_or(1);
            passes.saturating_add(1)
        });
        match passes {
            Some(passes) => {
                self.outcome.asks.pop();
                self.outcome.asks.push(format!("{request} {passes}"));
            }
            None => self.outcome.asks.push(request),
        }
    }

    fn turn_to(&mut self, behind: Option<&str>) -> Result<usize, String> {
        let number = behind.and_then(|number| number.parse().ok());
        let found = number.filter(|number| BOARDS.contains(number));
        self.board.turn_to(found.ok_or("BOARD 0, 2, 4, 6, 8 or 12 was expected")?);
        Ok(1)
    }
}

/// The writable variable with a name: its path, or the end of the path.
fn variable_named(name: &str) -> Option<Variable> {
    let end = name.replace('-', "_").to_lowercase();
    let is_named = |variable: &Variable| {
        variable.text().strip_suffix(&end).is_some_and(|front| front.is_empty() || front.ends_with('.'))
    };
    Variable::ALL.iter().copied().find(is_named)
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::pose::Pose;
    use interfaces::{ChangingPose, CommonMemory, ExternalInputs, pose_range};
    use rcs_core::{name::Name10, tick::Tick};
    use std::path::Path;
    use taskdata::files::TrajParaId;

    struct Bench {
        board: Board,
        library: Library,
        picture: Picture,
    }

    impl Bench {
        fn new(number: u8) -> Self {
            let mut board = Board::default();
            board.turn_to(number);
            let (external, memory) = (ExternalInputs::default(), CommonMemory::default());
            Self {
                board,
                library: Library::of(Path::new(env!("CARGO_MANIFEST_DIR")).join("../data")),
                picture: Picture { tick: Tick(7), external, memory, timing: None },
            }
        }

        fn enter(&mut self, line: &str) -> Outcome {
            Interpreter::new(&mut self.board, &mut self.library, Some(&self.picture), None).interpret(line)
        }

        fn asks(&mut self, line: &str) -> String {
            let outcome = self.enter(line);
            assert!(outcome.said.iter().all(|line| line.tone != Tone::Trouble), "{:?}", outcome.said);
            outcome.asks.join("; ")
        }

        fn said(&mut self, line: &str) -> String {
            let said = self.enter(line).said;
            said.into_iter().map(|line| line.text).collect::<Vec<_>>().join("\n")
        }
    }

    #[test]
    fn words_of_chapter_four_become_requests() {
        for (board, line, requests) in [
            (6, "863 12 12 LINE-LOAD", "line-load 863 12 12"),
            (6, "GO", "board 6 go"),
            (0, "SSGO", "board 0 go"),
            (2, "^C", "board 2 stop"),
            (2, ".R", "robot-init"),
            (2, "PRIM-LEVEL PRIM-LEVEL II", "execute PRIM 2"),
            (2, "PRIM-LEVEL EMOVE-LEVEL", "execute PRIM; execute EMOVE"),
            (8, "QC-LEVEL GO", "execute QUICK-CHANGE; board 8 go"),
            (6, "188 LOAD 641 LOAD GO", "board 6 go"),
            (6, "DB-DONE", "db-done on"),
            (6, "% r DB-DONE", "db-done off"),
            (2, ":S located <= NONE", "write emove.estimates.located NONE"),
            (2, ":S emove.estimates.held <= LINKBAR1_BH 2", "write emove.estimates.held LINKBAR1_BH 2"),
            (6, ":S regrip <= LCLEVIS_IH", "write subtask.regrip LCLEVIS_IH"),
        ] {
            assert_eq!(Bench::new(board).asks(line), requests, "{board}: {line}");
        }
    }

    #[test]
    fn word_is_known_only_on_its_board() {
        for (board, line, why) in [
            (6, ".R", "word of board 2"),
            (2, "TAI", "word of board 6"),
            (0, "GO", "SSGO"),
            (12, "GO", "graphics"),
            (2, "863 12 12 LINE-LOAD", "word of board 6"),
            (6, "12 LINE-LOAD", "a number is missing"),
            (6, "21000 OFFSET ! 863 12 12 LINE-LOAD", "offset 16000"),
            (4, "TDEF", "word of board 6"),
            (6, "NONSENSE", "not a word of the terminal"),
            (6, "BOARD 3", "BOARD 0, 2, 4, 6, 8 or 12"),
            (6, ":S command-in <= MOVE", "task.ledger, task.updates.pending, subtask.regrip"),
            (6, "% lld", "no other routine"),
            (2, "DB-DONE", "word of board 6"),
            (6, ":S located <= NONE", "a variable that can be written was expected"),
            (6, ":S calibration <= NONE", "board 8 has it"),
            (4, ":S <= NONE", "board 4 has no variable"),
            (2, "located <= NONE", "not a word of the terminal; :S shows variables"),
        ] {
            let mut bench = Bench::new(board);
            let outcome = bench.enter(line);
            assert!(outcome.asks.is_empty(), "{line}");
            let said = outcome.said.last().expect("why not");
            assert!(said.tone == Tone::Trouble && said.text.contains(why), "{line}: {}", said.text);
        }
    }

    #[test]
    fn blocks_are_listed_and_words_located() {
        let mut bench = Bench::new(6);
        let block = bench.said("863 LIST");
        assert!(block.contains("commands.blk") && block.contains(" 12 == PAUSE"), "{block}");
        assert!(bench.said("21000 OFFSET ! 610 LIST").contains("HOME-POS"));
        assert!(bench.said("12000 OFFSET ! 3 LIST").contains("crates/levels/src/prim"));
        assert!(bench.said("OFFSET").contains("16000 Task"));
        assert!(bench.said("LOC LOCATE-OBJ").contains("crates/levels/src/emove/tables/locate_obj.rs:"));
        assert!(bench.said("LOC SAFE-P").contains("610 at 21000, line "));
        assert!(bench.said("16000 903 OLOAD").contains("IV.3.2"));
        assert_eq!(bench.asks("21000 610 OLOAD"), "load 21000 610");
        assert!(bench.said("21000 999 OLOAD").contains("there is no block 999"));
        assert!(bench.said("WUNLOAD").contains("SIGINT"));
    }

    #[test]
    fn show_mode_shows_the_variables_of_the_board() {
        let mut bench = Bench::new(6);
        bench.picture.external.hws.number = 41;
        assert!(bench.said(":S command-#-in").contains("hws.number"));
        assert!(bench.said("command-#-in").contains("41"), "it stays in show mode");
        assert!(bench.said("frame-command-in").contains("board 2 has it"));
        assert!(bench.said("bogus-variable").contains("no such variable"));
        assert_eq!((bench.said(":R TAI"), bench.board.shown.unwrap().word), (String::new(), "TAI"));
    }

    #[test]
    fn show_mode_follows_a_pointer_to_its_record() {
        let mut bench = Bench::new(6);
        assert!(!bench.said(":S task.subtask.pose").contains("T-POSE"), "no record yet");
        let number = pose_range::TASK + 3;
        bench.picture.memory.task.subtask.pose = Some(number);
        let pose = Pose { wrist: [0, -4145, -4602], tool: [0, -7145, -1483], finger: [3000, -7145, -1483] };
        bench.picture.memory.task.poses[1] = ChangingPose { number: Some(number), pose };
        let said = bench.said("pose-^-in");
        assert!(said.contains("T-POSE-2") && said.contains("      0    -7145    -1483"), "{said}");
        let store = bench.library.store().unwrap();
        let data = store.view();
        let pose = data.pose_named(&Name10::clipped("TOOL-TRNS")).unwrap().number();
        let movetable = data.movetable_named(&Name10::clipped("LK-GRP-1")).unwrap();
        let place = data.locpt_named(&Name10::clipped("PFIXTURE")).unwrap();
        let mut bench = Bench::new(2);
        bench.picture.memory.emove.prim.pose = pose;
        bench.picture.memory.emove.prim.movetable = movetable;
        bench.picture.memory.emove.prim.trajectory_parameters = TrajParaId::new(1);
        bench.picture.memory.subtask.emove.site.record = place;
        for (line, found) in [
            (":S ^-pose", "   6497    -2366     1569"),
            ("^-movtab", "to     -300        0      0      -mtb-   LK-GRP-1"),
            ("^-traj-para", "  fac "),
            ("locpt-^-in", "  PFIXTURE, at PFIX-P"),
        ] {
            let said = bench.said(line);
            assert!(said.contains(found), "{line}: {said}");
        }
        bench.picture.memory.emove.prim.pose = 999_999;
        assert!(bench.said("^-pose").contains("not in the blocks"));
    }
}
