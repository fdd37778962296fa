//! The terminal as text: settings, show word, and typed lines with their answers, newest first.

use interfaces::{CommonMemory, ProcessId, operator::BOARDS as RUNNING};

use super::{Board, BoardTerminal, Mode, Typed, pointer::nine};
use crate::rcs_console::{
    model::{Operating, Section, Text, Tone, session::Exchange, views::lines},
    picture::Picture,
};

#[must_use]
pub fn sections(
    terminal: &BoardTerminal,
    operating: Option<&Operating>,
    picture: &Picture,
    last: Option<&Picture>,
) -> Vec<Section> {
    let is_used = !terminal.typed.is_empty() || operating.is_some_and(|operating| operating.count() > 0);
    let mut sections = vec![Section::new(title(&terminal.board), about(operating, picture, is_used))];
    if let Some(word) = terminal.board.shown {
        let title = format!("{}: {}", word.word, word.about);
        sections.push(Section::new(title, lines(word.buffers, picture, last)));
    }
    sections.extend(recorded(&terminal.board, &picture.memory));
    sections.push(Section::new("entered, newest first", conversation(terminal, operating)));
    sections
}

fn title(board: &Board) -> String {
    let processes: Vec<String> = board.processes().map(|process| process.to_string()).collect();
    let what = match board.number {
        0 => "Diagnostics, the pulse".to_owned(),
        12 => "Graphics".to_owned(),
        8 => "Quick Change, grippers, pedestal".to_owned(),
        _ => processes.join(", "),
    };
    let mode = if board.mode == Mode::Run { ":R" } else { ":S" };
    format!("board {}: {what}; {}; offset {}; {mode}", board.number, board.vocabulary, board.offset)
}

/// The pose that the record button has displayed on the terminal of the Prim board (III.3.3).
fn recorded(board: &Board, memory: &CommonMemory) -> Option<Section> {
    if board.number != ProcessId::Prim.board() {
        return None;
    }
    let status = &memory.prim.status;
    let pose = memory.changing_pose(status.recorded_pose?)?;
    let heads = ["wrist", "tool", "finger"];
    let mut lines: Vec<Text> = heads
        .into_iter()
        .zip(nine(pose))
        .map(|(head, values)| Text::plain(format!(" {head:<8}{values}")))
        .collect();
    if status.recording {
        let text = " E-move and Prim are suspended until carriage return: Enter";
        lines.push(Text::new(Tone::Marked, text));
    }
    Some(Section::new("recorded pose, 0.01 in", lines))
}

/// The boards and the source of commands. Before the first input, the possible inputs follow.
fn about(operating: Option<&Operating>, picture: &Picture, is_used: bool) -> Vec<Text> {
    let operator = &picture.external.operator;
    let state = |board: u8| match (operator.is_stopped(board), operator.is_stopped(0)) {
        (_, true) if board == 0 => "no pulse",
        (true, _) => "STOPPED",
        (false, _) if board == 0 => "pulse",
        (false, _) => "runs",
    };
    let boards: Vec<String> = RUNNING.iter().map(|board| format!("{board} {}", state(*board))).collect();
    let tone = if operator.stopped == 0 { Tone::Plain } else { Tone::Marked };
    let mut lines = vec![Text::new(tone, format!(" boards  {}", boards.join("   ")))];
    if operator.db_done {
        let text = " DB-DONE is in: Task does not wait for the Data System; % DB-DONE takes it out";
        lines.push(Text::new(Tone::Marked, text));
    }
    match operating {
        Some(operating) => {
            lines.push(Text::plain(format!(" {}", operating.status)));
            if let Some(lost) = &operating.lost {
                lines.push(Text::new(Tone::Trouble, format!("!!{lost}")));
            }
        }
        None => lines.push(Text::new(Tone::Faint, " this console is read-only: --operate works on a run")),
    }
    if is_used {
        return lines;
    }
    let hints = [
        " words: GO ^C .R  n LIST  863 12 12 LINE-LOAD  TAI  LOC name  :S name Tab=board",
        " today: PAUSE   MOVE ...   job wait, go, skip   vise open PFIXTURE   panel auto",
    ];
    lines.extend(hints.map(|text| Text::new(Tone::Faint, text)));
    lines
}

/// The typed lines and the requests, newest first. A request follows the words that sent it.
fn conversation(terminal: &BoardTerminal, operating: Option<&Operating>) -> Vec<Text> {
    let mut all: Vec<((u64, u8), Vec<Text>)> = Vec::new();
    all.extend(terminal.typed.iter().map(|typed| ((typed.after, 1), of_words(typed))));
    if let Some(operating) = operating {
        let numbered = operating.numbered();
        all.extend(numbered.map(|(ordinal, exchange)| ((ordinal, 0), of_request(exchange))));
    }
    // Words without a request have equal keys and keep their order.
    all.sort_by_key(|(key, _)| *key);
    all.into_iter().rev().flat_map(|(_, lines)| lines).collect()
}

fn of_words(typed: &Typed) -> Vec<Text> {
    let head = Text::new(Tone::Marked, format!(" board {}: {}", typed.board, typed.line));
    std::iter::once(head).chain(typed.said.iter().cloned()).collect()
}

fn of_request(exchange: &Exchange) -> Vec<Text> {
    let (tone, text) = match &exchange.answer {
        None => (Tone::Faint, "  not answered yet".to_owned()),
        Some(Ok(text)) => {
            (Tone::Plain, format!("  {text}   {}", exchange.stages.join(" ")).trim_end().to_owned())
        }
        Some(Err(why)) => (Tone::Trouble, format!("!!refused: {why}")),
    };
    vec![Text::new(Tone::Marked, format!(" : {}", exchange.line)), Text::new(tone, text)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::pose::Pose;
    use interfaces::{ChangingPose, pose_range};

    #[test]
    fn recorded_pose_is_shown_on_the_prim_terminal() {
        let mut memory = CommonMemory::default();
        let number = pose_range::PRIM + 9;
        let pose = Pose { wrist: [0, -4145, -4602], tool: [0, -7145, -1483], finger: [3000, -7145, -1483] };
        memory.prim.poses[0] = ChangingPose { number: Some(number), pose };
        let board = |number| Board { number, ..Board::default() };
        assert!(recorded(&board(2), &memory).is_none(), "no pose was recorded");
        (memory.prim.status.recorded_pose, memory.prim.status.recording) = (Some(number), true);
        assert!(recorded(&board(6), &memory).is_none(), "Task has its own terminal");
        let lines = recorded(&board(2), &memory).unwrap().lines;
        let lines: Vec<&str> = lines.iter().map(|line| line.text.as_str()).collect();
        assert_eq!(lines[1], " tool          0    -7145    -1483");
        assert_eq!(lines[3], " E-move and Prim are suspended until carriage return: Enter");
    }
}
