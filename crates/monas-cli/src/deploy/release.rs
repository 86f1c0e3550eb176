//! What is brought to a robot: the program, the configuration with all that it names, and the hashes of these.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use monas::Provenance;
use sha2::{Digest, Sha256};

use super::quoted;
use super::robots::RobotEntry;

/// The hashes of all other files, as `sha256sum -c` takes them.
const SUMS: &str = "SHA256SUMS";

/// Files, by their paths in the release.
pub(super) struct Release {
    /// The first digits of the hash of all of it.
    pub(super) name: String,
    /// The program's name.
    pub(super) program: String,
    files: BTreeMap<String, File>,
}

struct File {
    content: Vec<u8>,
    is_program: bool,
}

impl Release {
    /// The release of a program for a robot.
    ///
    /// # Errors
    /// A file cannot be read, or lies elsewhere than the configuration does.
    pub(super) fn gather(robot: &RobotEntry, program: &Path) -> io::Result<Release> {
        let name = program.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let configuration = Provenance::of(&robot.config);
        let root = configuration.root().to_owned();
        let mut files = BTreeMap::new();
        let plain = |content: Vec<u8>| File { content, is_program: false };
        for (path, _, content) in configuration.files() {
            files.insert(path.to_owned(), plain(content.to_vec()));
        }
        let folder = folder_of(&robot.config, &root);
        for file in &robot.files {
            files.insert(inside(&folder, file)?, plain(read(file)?));
        }
        files.insert(format!("bin/{name}"), File { content: read(program)?, is_program: true });
        let start = start(&name, &root, &robot.arguments);
        files.insert("start".into(), File { content: start.into_bytes(), is_program: true });
        let sums = sums(&files);
        let digest = Sha256::digest(&sums);
        files.insert(SUMS.into(), plain(sums.into_bytes()));
        Ok(Release { name: hexadecimal(&digest[..8]), program: name, files })
    }

    /// How many files there are, and of how many bytes.
    pub(super) fn size(&self) -> (usize, usize) {
        (self.files.len(), self.files.values().map(|file| file.content.len()).sum())
    }

    /// The paths of the files.
    pub(super) fn paths(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str)
    }

    /// Writes it as a tar archive.
    ///
    /// # Errors
    /// What it is written into takes no more.
    pub(super) fn write(&self, into: impl io::Write) -> io::Result<()> {
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

/// The script that the service starts.
fn start(program: &str, config: &str, arguments: &[String]) -> String {
    let mut line = format!("exec ./bin/{} run {}", quoted(program), quoted(config));
    arguments.iter().for_each(|argument| {
        // A text takes whatever it is given.
        let _ = write!(line, " {}", quoted(argument));
    });
    format!("#!/bin/sh\n# Runs this release.\ncd \"$(dirname \"$0\")\" || exit 1\n{line}\n")
}

fn sums(files: &BTreeMap<String, File>) -> String {
    let line =
        |(path, file): (&String, &File)| format!("{}  {path}\n", hexadecimal(&Sha256::digest(&file.content)));
    files.iter().map(line).collect()
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The folder from which the paths of a configuration's files are.
fn folder_of(config: &Path, root: &str) -> PathBuf {
    let depth = root.split('/').count();
    let whole = std::path::absolute(config).unwrap_or_else(|_| config.to_owned());
    whole.ancestors().nth(depth).map(Path::to_owned).unwrap_or_default()
}

fn inside(folder: &Path, file: &Path) -> io::Result<String> {
    let (folder, whole) = (folder.canonicalize()?, file.canonicalize().map_err(|error| about(file, &error))?);
    let path = whole.strip_prefix(&folder).map_err(|_| {
        io::Error::other(format!(
            "{} does not lie in {}, where the configuration and what it names are",
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
