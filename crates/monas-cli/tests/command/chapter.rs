//! The chapters in `docs`: each of their commands does what the chapter says.

use std::fs;
use std::path::Path;

use crate::generate::project;
use crate::kit::{Answer, command, copy, root};

/// A command of the chapter: its words, how it ends, and what is to be read after it or one of the same block.
struct Step {
    words: Vec<String>,
    code: i32,
}

/// The blocks of commands, each with the lines that are shown below it.
fn blocks(chapter: &str) -> Vec<(Vec<Step>, Vec<String>)> {
    let mut blocks: Vec<(Vec<Step>, Vec<String>)> = Vec::new();
    let mut fence = "";
    for line in chapter.lines() {
        match (line, fence) {
            ("```sh", "") => {
                blocks.push((Vec::new(), Vec::new()));
                fence = "sh";
            }
            ("```text", "") => fence = "text",
            ("```", _) => fence = "",
            (line, "sh") => {
                let (typed, comment) = line.split_once(" # ends with ").unwrap_or((line, "0"));
                let words = typed.strip_prefix("monas ").expect("a command of this program");
                let words = words.split(' ').map(str::to_owned).collect();
                let step = Step { words, code: comment.parse().expect("a number") };
                blocks.last_mut().expect("a block").0.push(step);
            }
            (line, "text") => blocks.last_mut().expect("a block").1.push(line.to_owned()),
            _ => {}
        }
    }
    blocks
}

fn run(step: &Step, folder: &Path) -> Answer {
    let words: Vec<&str> = step.words.iter().map(String::as_str).collect();
    let answer: Answer = command(&words).current_dir(folder).output().expect("the command starts").into();
    assert_eq!(answer.code, Some(step.code), "{words:?}: {}{}", answer.out, answer.err);
    answer
}

#[test]
fn each_command_of_the_chapter_on_properties_does_what_it_says() {
    let project = project();
    let folder = project.path();
    copy(&root().join("docs"), &folder.join("docs"));
    let chapter = fs::read_to_string(root().join("docs/properties.md")).expect("the chapter");
    let blocks = blocks(&chapter);
    assert_eq!(blocks.len(), 2, "the chapter has its commands");
    for (steps, shown) in &blocks {
        let answers = steps.iter().map(|step| run(step, folder));
        let said: String = answers.map(|answer| answer.out + &answer.err).collect();
        for line in shown {
            assert!(said.contains(line.as_str()), "`{line}` is not in\n{said}");
        }
    }
}

#[test]
fn each_command_of_the_chapter_does_what_it_says() {
    let project = project();
    let folder = project.path();
    copy(&root().join("config"), &folder.join("config"));
    let chapter = fs::read_to_string(root().join("docs/attack.md")).expect("the chapter");
    let blocks = blocks(&chapter);
    assert!(blocks.len() >= 9, "the chapter has its commands");
    let mut hashes = Vec::new();
    for (steps, shown) in &blocks {
        let mut said = String::new();
        for step in steps {
            let answer = run(step, folder);
            hashes.extend(answer.out.lines().find(|line| line.starts_with("hash: ")).map(str::to_owned));
            said += &(answer.out + &answer.err);
        }
        for line in shown {
            assert!(said.contains(line.as_str()), "`{line}` is not in\n{said}");
        }
    }
    assert_eq!(hashes.len(), 2);
    assert_eq!(hashes[0], hashes[1], "interpreted and generated");
    for drawing in ["attack.svg", "extended_attacker.svg"] {
        let (drawn, shown) = (fs::read(folder.join(drawing)), fs::read(root().join("docs").join(drawing)));
        assert!(
            drawn.expect("it is drawn") == shown.expect("it is shown"),
            "docs/{drawing} is not up to date"
        );
    }
}
