//! Names that must not occur in the code of a crate. Without them a crate is usable alone, testable
//! without waiting, and the same on every machine.

use super::TidyFinding;
use super::source::{code, without_tests};
use super::workspace::{Crate, TextFile, Workspace};

/// Threads, sockets, files, the environment, other processes.
const OUTSIDE_WORLD: [&str; 5] = ["std::thread", "std::net", "std::fs", "std::env", "std::process"];

/// The wall clock and collections with random order.
const NONDETERMINISM: [&str; 4] = ["std::time::Instant", "std::time::SystemTime", "HashMap", "HashSet"];

/// Standard output and standard error.
const PRINTING: [&str; 4] = ["println!", "print!", "eprintln!", "eprint!"];

/// Names that must not occur in one crate.
struct Absence {
    crate_name: &'static str,
    names: &'static [&'static [&'static str]],
    /// Prefixes of the paths under `src` of files and folders that are exempt.
    except: &'static [&'static str],
    because: &'static str,
}

const ABSENCES: [Absence; 29] = [
    Absence {
        crate_name: "narukom",
        names: &[&OUTSIDE_WORLD, &NONDETERMINISM, &PRINTING, &["Agent", "Activity", "Statechart"]],
        except: &[],
        because: "the owner of a hub decides when messages move",
    },
    Absence {
        crate_name: "yase",
        names: &[&OUTSIDE_WORLD, &NONDETERMINISM, &PRINTING, &["narukom", "Blackboard", "Activity"]],
        except: &[],
        because: "the machine accesses its environment only through the trait Host",
    },
    Absence {
        crate_name: "yase-expression",
        names: &[&OUTSIDE_WORLD, &NONDETERMINISM, &PRINTING, &["Machine", "Statechart", "narukom"]],
        except: &[],
        because: "an expression knows the data of one moment, not what runs it",
    },
    Absence {
        crate_name: "yase-scxml",
        names: &[&OUTSIDE_WORLD, &NONDETERMINISM, &PRINTING, &["narukom", "Blackboard", "Activity"]],
        except: &[],
        because: "a session runs on a clock and a platform that its caller provides",
    },
    Absence {
        crate_name: "yase-explore",
        names: &[&OUTSIDE_WORLD, &NONDETERMINISM, &PRINTING, &["narukom", "Blackboard", "Activity"]],
        except: &[],
        because: "an exploration is a function of the chart and its environment",
    },
    Absence {
        crate_name: "yase-export",
        names: &[&OUTSIDE_WORLD, &NONDETERMINISM, &PRINTING, &["Machine", "Host", "narukom"]],
        except: &[],
        because: "a drawing needs the model only",
    },
    Absence {
        crate_name: "yase-codegen",
        names: &[&OUTSIDE_WORLD, &NONDETERMINISM, &PRINTING, &["narukom", "Blackboard", "Activity"]],
        except: &[],
        because: "generated code is a function of the chart",
    },
    Absence {
        crate_name: "aseme",
        names: &[&OUTSIDE_WORLD, &NONDETERMINISM, &PRINTING, &["Machine", "narukom"]],
        except: &[],
        because: "roles are text and data; how a chart is run is not theirs",
    },
    Absence {
        crate_name: "aseme-models",
        names: &[&OUTSIDE_WORLD, &NONDETERMINISM, &PRINTING, &["Machine", "narukom"]],
        except: &[],
        because: "models are text and data; running them is the task of other crates",
    },
    Absence {
        crate_name: "aseme-verify",
        names: &[&OUTSIDE_WORLD, &NONDETERMINISM, &PRINTING, &["narukom", "Blackboard"]],
        except: &[],
        because: "a chart is explored without its program, and with the same result on every machine",
    },
    Absence {
        crate_name: "aseme-codegen",
        names: &[&["std::thread", "std::net", "std::process"], &NONDETERMINISM, &PRINTING, &["Machine"]],
        except: &[],
        because: "generated code is the same on every build",
    },
    Absence {
        crate_name: "monas-tape",
        names: &[&["std::net"], &NONDETERMINISM, &PRINTING, &["Agent", "Talws"]],
        except: &[],
        because: "a tape stores messages independently of their senders",
    },
    Absence {
        crate_name: "monas-tape",
        names: &[&["std::thread", "std::time::Instant", "std::time::SystemTime"]],
        except: &["writer"],
        because: "only the writer has a thread",
    },
    Absence {
        crate_name: "monas-robot",
        names: &[&OUTSIDE_WORLD, &NONDETERMINISM, &PRINTING, &["Nao", "monas_sim", "Talws"]],
        except: &[],
        because: "it defines the interface of bodies, not a body",
    },
    Absence {
        crate_name: "monas-core",
        names: &[&OUTSIDE_WORLD, &NONDETERMINISM, &PRINTING, &["Talws", "monas_sim", "monas_soccer"]],
        except: &[],
        because: "agents and charts run in any time and on any thread",
    },
    Absence {
        crate_name: "monas-config",
        names: &[&["std::thread", "std::net", "std::process"], &NONDETERMINISM, &PRINTING, &["Talws"]],
        except: &[],
        because: "a configuration is a function of its files",
    },
    Absence {
        crate_name: "monas-module",
        names: &[&["std::thread", "std::net", "std::process"], &NONDETERMINISM, &PRINTING, &["Talws"]],
        except: &[],
        because: "loading a module runs none of its activities",
    },
    Absence {
        crate_name: "monas-log",
        names: &[&["std::net", "std::process", "HashMap", "HashSet", "Talws"]],
        except: &[],
        because: "the log is written to files and the console only",
    },
    Absence {
        crate_name: "monas-runtime",
        names: &[
            &["std::net", "std::process", "HashMap", "HashSet"],
            &PRINTING,
            &["monas_sim", "monas_soccer"],
        ],
        except: &[],
        because: "the runtime runs any agent on any body",
    },
    Absence {
        crate_name: "monas-vision",
        names: &[&OUTSIDE_WORLD, &NONDETERMINISM, &PRINTING, &["narukom", "Activity", "monas_robot"]],
        except: &[],
        because: "what an image shows is a function of the image and the pose of its camera",
    },
    Absence {
        crate_name: "monas-sim",
        names: &[&OUTSIDE_WORLD, &NONDETERMINISM, &PRINTING, &["Talws", "Activity", "Statechart"]],
        except: &[],
        because: "the field is a pure function of its commands and its seed",
    },
    Absence {
        crate_name: "monas-soccer",
        names: &[&OUTSIDE_WORLD, &NONDETERMINISM, &PRINTING, &["monas_sim", "Nao", "Talws"]],
        except: &[],
        because: "soccer is played on any body and by any runtime",
    },
    Absence {
        crate_name: "monas-match",
        names: &[&["std::thread", "std::net", "std::env", "std::process"], &NONDETERMINISM, &PRINTING],
        except: &[],
        because: "a match runs in simulated time; pacing and display belong to its callers",
    },
    Absence {
        crate_name: "monas-eval",
        names: &[
            &["std::thread", "std::net", "std::env", "Instant", "SystemTime"],
            &NONDETERMINISM,
            &PRINTING,
        ],
        except: &[],
        because: "its caller measures the time",
    },
    Absence {
        crate_name: "narukom-build",
        names: &[&["std::thread", "std::net"], &NONDETERMINISM],
        except: &[],
        because: "generated code is the same on every build",
    },
    Absence {
        crate_name: "monas-project",
        names: &[&["std::net", "std::thread", "monas_match"], &PRINTING],
        except: &[],
        because: "it writes files of a project and knows neither a terminal nor a sport",
    },
    Absence {
        crate_name: "monas-deploy",
        names: &[&["std::net", "monas_match"], &PRINTING],
        except: &[],
        because: "it reaches a robot through ssh only, and the command line prints its results",
    },
    Absence {
        crate_name: "monas-terminal",
        names: &[&["std::net", "std::process::Command", "monas_match"], &PRINTING],
        except: &[],
        because: "it knows none of the commands, and writes to the writers it is given",
    },
    Absence {
        crate_name: "monas-cli",
        names: &[&["std::net"], &PRINTING],
        except: &[],
        because: "what it writes goes to the writers it is given, so that tests can read it",
    },
];

pub(crate) fn check(workspace: &Workspace) -> Vec<TidyFinding> {
    let mut findings = Vec::new();
    for absence in &ABSENCES {
        let members = workspace.crates.iter().filter(|member| member.name == absence.crate_name);
        for member in members {
            findings.extend(workspace.sources(member).flat_map(|file| check_file(absence, member, file)));
        }
    }
    findings
}

fn check_file(absence: &Absence, member: &Crate, file: &TextFile) -> Vec<TidyFinding> {
    if absence.except.iter().any(|except| excepted(member, file, except)) {
        return Vec::new();
    }
    let code = without_tests(&code(&file.text));
    let names = absence.names.iter().flat_map(|names| names.iter());
    let found = names.flat_map(|name| mentions(&code, name).into_iter().map(move |line| (line, *name)));
    let message = |name: &str| format!("`{}` never knows `{name}`: {}", absence.crate_name, absence.because);
    found.map(|(line, name)| TidyFinding::new(&file.path, line, message(name))).collect()
}

fn excepted(member: &Crate, file: &TextFile, except: &str) -> bool {
    let inside = file.path.strip_prefix(member.folder.join("src")).unwrap_or(&file.path);
    inside.to_str().is_some_and(|inside| inside.starts_with(except))
}

/// The lines of code that name a path such as `std::thread`, directly or imported with braces.
fn mentions(code: &str, path: &str) -> Vec<usize> {
    let mut lines: Vec<usize> = occurrences(code, path).map(|index| line_of(code, index)).collect();
    let imported = imports(code).into_iter().filter(|(_, import)| covers(import, path));
    lines.extend(imported.map(|(index, _)| line_of(code, index)));
    lines.sort_unstable();
    lines.dedup();
    lines
}

/// The positions of a path in code as whole words.
fn occurrences<'a>(code: &'a str, path: &'a str) -> impl Iterator<Item = usize> + 'a {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    code.match_indices(path).map(|(index, _)| index).filter(move |&index| {
        !code[..index].ends_with(is_part) && !code[index + path.len()..].starts_with(is_part)
    })
}

fn line_of(code: &str, index: usize) -> usize {
    code[..index].matches('\n').count() + 1
}

fn covers(import: &str, path: &str) -> bool {
    import.strip_prefix(path).is_some_and(|rest| rest.is_empty() || rest.starts_with("::"))
}

/// Every path imported by `use`, with braces expanded, and the position of its `use`.
fn imports(code: &str) -> Vec<(usize, String)> {
    let mut imports = Vec::new();
    for index in occurrences(code, "use") {
        let tree = code[index + "use".len()..].split(';').next().unwrap_or_default();
        let tree: String = tree.replace(" as ", "@").chars().filter(|c| !c.is_whitespace()).collect();
        let mut paths = Vec::new();
        multiply_out(&tree, "", &mut paths);
        imports.extend(paths.into_iter().map(|path| (index, path)));
    }
    imports
}

/// `a::{b, c::{d, e}}` is `a::b`, `a::c::d` and `a::c::e`.
fn multiply_out(tree: &str, before: &str, paths: &mut Vec<String>) {
    let Some((stem, branches)) = tree.split_once('{') else {
        let path = tree.split('@').next().unwrap_or_default();
        return paths.push(format!("{before}{path}"));
    };
    let branches = branches.strip_suffix('}').unwrap_or(branches);
    let stem = format!("{before}{stem}");
    for branch in split_outside_braces(branches) {
        multiply_out(branch, &stem, paths);
    }
}

fn split_outside_braces(text: &str) -> Vec<&str> {
    let (mut depth, mut start, mut parts) = (0_i32, 0, Vec::new());
    for (index, c) in text.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(&text[start..index]);
                start = index + 1;
            }
            _ => {}
        }
    }
    parts.push(&text[start..]);
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_written_out_is_found_as_whole_words() {
        let code = "fn a() {\n std::thread::spawn(b);\n my_std::thread(); std::threads(); \n}";
        assert_eq!(mentions(code, "std::thread"), [2]);
    }

    #[test]
    fn a_path_imported_with_braces_is_found() {
        let code = "use std::{fmt, io::{self, Read}};\nuse std::{\n    net::{TcpStream as Stream},\n    sync::Arc,\n};\n";
        assert_eq!(mentions(code, "std::net"), [2]);
        assert_eq!(mentions(code, "std::io"), [1]);
        assert!(mentions(code, "std::fs").is_empty());
    }

    #[test]
    fn a_finding_has_a_reason() {
        let member = Crate {
            name: "yase".into(),
            folder: "charts/yase".into(),
            library: None,
            dependencies: Vec::new(),
        };
        let file = TextFile {
            path: "charts/yase/src/machine.rs".into(),
            text: "// HashMap\nuse std::collections::HashMap;\n#[cfg(test)]\nmod tests { use std::fs; }\n"
                .into(),
        };
        let findings = check_file(&ABSENCES[1], &member, &file);
        let texts: Vec<String> = findings.iter().map(ToString::to_string).collect();
        assert_eq!(
            texts,
            [
                "charts/yase/src/machine.rs:2: `yase` never knows `HashMap`: the machine accesses its environment only through the trait Host"
            ]
        );
    }

    #[test]
    fn a_folder_can_be_exempt() {
        let member = Crate {
            name: "monas-tape".into(),
            folder: "messages/monas-tape".into(),
            library: None,
            dependencies: Vec::new(),
        };
        let thread = |path: &str| TextFile { path: path.into(), text: "use std::thread;\n".into() };
        let only_writer = ABSENCES
            .iter()
            .find(|absence| absence.except.contains(&"writer"))
            .expect("the writer is an exception");
        assert!(check_file(only_writer, &member, &thread("messages/monas-tape/src/writer.rs")).is_empty());
        assert_eq!(check_file(only_writer, &member, &thread("messages/monas-tape/src/reader.rs")).len(), 1);
    }
}
