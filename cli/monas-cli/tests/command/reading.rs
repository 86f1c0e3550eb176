//! Runs the commands of a chapter of `docs` and checks what the chapter says they print.
//!
//! The lines of a block of the language `sh` are executed one after the other, in a separate
//! folder. A line that ends with ` &` runs in the background until the end of the chapter, and `#
//! ends with 3` gives the exit code of a command that fails. The lines of a following `text` block
//! must occur in the output, with `...` for what is left out; commands that only look at a run are
//! repeated until they do, since the run has just begun. A block with the name of a file (`xml
//! robot.xml`) is written to that file first.

use std::fs;
use std::process::Command;

use crate::kit::{Answer, root};
use crate::running::{Running, in_folder};

/// Commands that only look at a run.
const READ_ONLY_COMMANDS: [&str; 3] = ["monas chart show ", "monas topic list ", "monas agent list"];

/// Maximum number of repetitions of commands that only read.
const REPETITIONS: usize = 20;

/// The blocks of a chapter.
enum Block {
    File { name: String, text: String },
    Commands(Vec<String>),
    Shown(Vec<String>),
}

fn blocks(chapter: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut lines = chapter.lines();
    while let Some(line) = lines.next() {
        let Some(fence) = line.strip_prefix("```") else { continue };
        let inside: Vec<String> =
            lines.by_ref().take_while(|line| *line != "```").map(str::to_owned).collect();
        match fence.split_once(' ') {
            Some((_, name)) => blocks.push(Block::File { name: name.into(), text: inside.join("\n") + "\n" }),
            None if fence == "sh" => blocks.push(Block::Commands(inside)),
            None if fence == "text" => blocks.push(Block::Shown(inside)),
            None => {}
        }
    }
    blocks
}

/// A chapter that is being run.
pub(crate) struct Reading {
    pub(crate) folder: tempfile::TempDir,
    background: Vec<Running>,
    /// The output of the last block, and its commands that only look.
    said: String,
    looking: Vec<String>,
    /// The hashes of all runs so far.
    pub(crate) hashes: Vec<String>,
    commands: usize,
}

impl Reading {
    fn run(&mut self, line: &str) {
        self.commands += 1;
        let typed = line.strip_prefix("monas ").expect("a command of this program");
        if let Some(typed) = typed.strip_suffix(" &") {
            let words: Vec<&str> = typed.split(' ').collect();
            // A run with a control socket can be inspected from then on.
            let begin = if words.contains(&"--control") { "control socket: " } else { "running, " };
            return self.background.push(Running::of(&mut self.command(&words), begin));
        }
        let (typed, code) = typed.split_once(" # ends with ").unwrap_or((typed, "0"));
        let words = words(typed);
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let answer = self.command(&words).output().expect("the command starts");
        let Answer { code: ended, out, err } = answer.into();
        assert_eq!(ended, code.parse().ok(), "{words:?}: {out}{err}");
        self.hashes.extend(out.lines().filter(|line| line.starts_with("hash: ")).map(str::to_owned));
        self.said += &(out + &err);
    }

    fn command(&self, words: &[&str]) -> Command {
        let mut command = in_folder(self.folder.path(), words);
        command.current_dir(self.folder.path());
        command
    }

    fn read(&mut self, block: Block) {
        match block {
            Block::File { name, text } => {
                fs::write(self.folder.path().join(name), text).expect("the folder takes files");
            }
            Block::Commands(lines) => {
                self.said.clear();
                self.looking.clone_from(&lines);
                self.looking
                    .retain(|line| READ_ONLY_COMMANDS.iter().any(|command| line.starts_with(command)));
                lines.iter().for_each(|line| self.run(line));
            }
            Block::Shown(_) if self.commands == 0 => {}
            Block::Shown(lines) => {
                for _ in 0..REPETITIONS {
                    if lines.iter().all(|line| self.said.contains(shown(line))) {
                        break;
                    }
                    self.looking.clone().iter().for_each(|line| self.run(line));
                }
                for line in lines {
                    assert!(self.said.contains(shown(&line)), "`{line}` is not in\n{}", self.said);
                }
            }
        }
    }
}

/// The words of a command; what single quotes enclose is one.
fn words(line: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    for (number, part) in line.split('\'').enumerate() {
        let is_quoted = number % 2 == 1;
        for (index, word) in part.split(' ').enumerate() {
            match words.last_mut() {
                Some(last) if is_quoted && index > 0 => last.extend([" ", word]),
                Some(last) if index == 0 => last.push_str(word),
                _ => words.push(word.to_owned()),
            }
        }
    }
    words
}

/// The part of a line that is shown: the rest of it, or the lines in its place, may be left out as
/// `...`.
fn shown(line: &str) -> &str {
    line.trim().trim_end_matches("...").trim_end()
}

/// Runs a chapter with at least this many commands in a folder.
pub(crate) fn read_in(folder: tempfile::TempDir, name: &str, min: usize) -> Reading {
    let chapter = fs::read_to_string(root().join("docs").join(name)).expect("the chapter");
    let mut reading = Reading {
        folder,
        background: vec![],
        said: String::new(),
        looking: vec![],
        hashes: vec![],
        commands: 0,
    };
    blocks(&chapter).into_iter().for_each(|block| reading.read(block));
    assert!(reading.commands >= min, "{name} has its commands");
    for running in reading.background.drain(..) {
        assert_eq!(running.interrupt().code, Some(130));
    }
    reading
}
