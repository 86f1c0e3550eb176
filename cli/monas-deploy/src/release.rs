//! A release: the program, the configuration with all files it names, and their hashes.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use monas::ConfigurationBundle;
use sha2::{Digest, Sha256};

use crate::robot::{KeptRecordings, Robot};
use crate::shell::quoted;

/// The hashes of all other files, in the format of `sha256sum -c`.
const HASH_FILE: &str = "SHA256SUMS";

/// The files of a release, by path.
pub struct Release {
    /// The first digits of the hash of all files.
    pub name: String,
    /// The program's name.
    pub program: String,
    files: BTreeMap<String, ReleaseFile>,
}

struct ReleaseFile {
    content: Vec<u8>,
    is_program: bool,
}

impl Release {
    /// Collects the release of a program for a robot.
    ///
    /// # Errors
    /// A file cannot be read, or lies outside of the folder of the configuration.
    pub fn gather(robot: &Robot, program: &Path) -> io::Result<Release> {
        let name = program.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let configuration = ConfigurationBundle::of(&robot.config);
        let root = configuration.root().to_owned();
        let mut files = BTreeMap::new();
        let plain = |content: Vec<u8>| ReleaseFile { content, is_program: false };
        for (path, _, content) in configuration.files() {
            files.insert(path.to_owned(), plain(content.to_vec()));
        }
        let folder = folder_of(&robot.config, &root);
        for file in &robot.files {
            files.insert(inside(&folder, file)?, plain(read(file)?));
        }
        files.insert(format!("bin/{name}"), ReleaseFile { content: read(program)?, is_program: true });
        let start = start(&name, &root, robot);
        files.insert("start".into(), ReleaseFile { content: start.into_bytes(), is_program: true });
        let sums = sums(&files);
        let digest = Sha256::digest(&sums);
        files.insert(HASH_FILE.into(), plain(sums.into_bytes()));
        Ok(Release { name: hexadecimal(&digest[..8]), program: name, files })
    }

    /// The number of files, and their size in bytes.
    pub fn size(&self) -> (usize, usize) {
        (self.files.len(), self.files.values().map(|file| file.content.len()).sum())
    }

    /// The paths of the files.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str)
    }

    /// Writes the release as a tar archive.
    ///
    /// # Errors
    /// The stream cannot be written.
    pub fn write(&self, into: impl io::Write) -> io::Result<()> {
        let mut archive = tar::Builder::new(into);
        for (path, file) in &self.files {
            let mut header = tar::Header::new_gnu();
            header.set_size(file.content.len() as u64);
            header.set_mode(if file.is_program { 0o755 } else { 0o644 });
            archive.append_data(&mut header, path, &file.content[..])?;
        }
        archive.finish()
    }
}

/// The script that starts the program.
fn start(program: &str, config: &str, robot: &Robot) -> String {
    let mut line = format!("exec ./bin/{} run {}", quoted(program), quoted(config));
    if let Some(KeptRecordings { count, megabytes }) = &robot.recordings {
        // Beside the folder of releases. Writing to a String does not fail.
        let _ = write!(line, " --record ../../recordings/ --keep {count} --keep-size {megabytes}MB");
    }
    robot.arguments.iter().for_each(|argument| {
        // Writing to a String does not fail.
        let _ = write!(line, " {}", quoted(argument));
    });
    format!("#!/bin/sh\n# Runs this release.\ncd \"$(dirname \"$0\")\" || exit 1\n{line}\n")
}

fn sums(files: &BTreeMap<String, ReleaseFile>) -> String {
    let line = |(path, file): (&String, &ReleaseFile)| {
        format!("{}  {path}\n", hexadecimal(&Sha256::digest(&file.content)))
    };
    files.iter().map(line).collect()
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The folder to which the configuration's paths are relative.
fn folder_of(config: &Path, root: &str) -> PathBuf {
    let depth = root.split('/').count();
    let whole = std::path::absolute(config).unwrap_or_else(|_| config.to_owned());
    whole.ancestors().nth(depth).map(Path::to_owned).unwrap_or_default()
}

fn inside(folder: &Path, file: &Path) -> io::Result<String> {
    let (folder, whole) = (folder.canonicalize()?, file.canonicalize().map_err(|error| about(file, &error))?);
    let path = whole.strip_prefix(&folder).map_err(|_| {
        io::Error::other(format!(
            "{} is not in {}, the folder of the configuration and its files",
            file.display(),
            folder.display()
        ))
    })?;
    let parts = path.components().map(|part| part.as_os_str().to_string_lossy());
    Ok(parts.collect::<Vec<_>>().join("/"))
}

fn read(path: &Path) -> io::Result<Vec<u8>> {
    fs::read(path).map_err(|error| about(path, &error))
}

fn about(path: &Path, error: &io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("{}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn robot(folder: &Path) -> Robot {
        Robot {
            name: "nao".into(),
            address: "nao@10.0.2.2".into(),
            ssh: vec!["ssh".into()],
            target: None,
            config: folder.join("agents.xml"),
            files: Vec::new(),
            arguments: vec!["--for".into(), "1 s".into()],
            folder: "monas".into(),
            service: "none".into(),
            settle: Duration::from_secs(1),
            recordings: None,
        }
    }

    #[test]
    fn a_release_is_named_after_its_content() {
        let folder = tempfile::tempdir().unwrap();
        let program = folder.path().join("team");
        fs::write(&program, "program").unwrap();
        fs::write(folder.path().join("agents.xml"), "<agent><name>A</name></agent>").unwrap();
        let robot = robot(folder.path());
        let release = Release::gather(&robot, &program).unwrap();
        assert_eq!(release.paths().collect::<Vec<_>>(), [HASH_FILE, "agents.xml", "bin/team", "start"]);
        assert_eq!(release.name, Release::gather(&robot, &program).unwrap().name);
        fs::write(&program, "another").unwrap();
        assert_ne!(release.name, Release::gather(&robot, &program).unwrap().name);
    }

    #[test]
    fn arguments_of_the_start_script_are_quoted() {
        let robot = robot(Path::new("team"));
        let script = start("team", "agents.xml", &robot);
        assert!(script.ends_with("exec ./bin/team run agents.xml --for '1 s'\n"), "{script}");
        let recordings = Some(KeptRecordings { count: "5".into(), megabytes: "100".into() });
        let script = start("team", "agents.xml", &Robot { recordings, arguments: Vec::new(), ..robot });
        let line = "exec ./bin/team run agents.xml --record ../../recordings/ --keep 5 --keep-size 100MB\n";
        assert!(script.ends_with(line), "{script}");
    }

    #[test]
    fn sums_are_those_of_sha256sum() {
        let file = ReleaseFile { content: b"abc".to_vec(), is_program: false };
        let sums = sums(&BTreeMap::from([("x".to_owned(), file)]));
        assert_eq!(sums, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad  x\n");
    }
}
