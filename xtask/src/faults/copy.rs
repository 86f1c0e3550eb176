//! A copy of the workspace with its own target folder.

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use super::patch::FaultTest;

/// For each test that ran, whether it passed.
pub(crate) type TestResults = BTreeMap<FaultTest, bool>;

/// A copy of the workspace.
pub(crate) struct WorkspaceCopy {
    /// Its folder.
    pub(crate) sources: PathBuf,
    /// Its target folder.
    pub(crate) target: PathBuf,
}

impl WorkspaceCopy {
    /// Copies all files under version control into a folder of the target folder. Unchanged files
    /// are not touched, so that they are not rebuilt.
    pub(crate) fn make(root: &Path, name: &str) -> Result<WorkspaceCopy, Box<dyn Error>> {
        let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
        let folder = root.join(target).join(name);
        let copy = WorkspaceCopy { sources: folder.join("sources"), target: folder.join("build") };
        let listed = Command::new("git").current_dir(root).args(["ls-files", "-z"]).output()?;
        if !listed.status.success() {
            return Err(format!("git ls-files: {}", String::from_utf8_lossy(&listed.stderr)).into());
        }
        let files: BTreeSet<PathBuf> =
            String::from_utf8(listed.stdout)?.split_terminator('\0').map(PathBuf::from).collect();
        for file in files.iter().filter(|file| root.join(file).is_file()) {
            copy.sync_file(root, file)?;
        }
        remove_others(&copy.sources, &copy.sources, &files)?;
        Ok(copy)
    }

    fn sync_file(&self, root: &Path, file: &Path) -> Result<(), Box<dyn Error>> {
        let (bytes, path) = (fs::read(root.join(file))?, self.sources.join(file));
        if fs::read(&path).is_ok_and(|before| before == bytes) {
            return Ok(());
        }
        fs::create_dir_all(path.parent().unwrap_or(&self.sources))?;
        Ok(fs::write(path, bytes)?)
    }

    pub(crate) fn read(&self, file: &str) -> Result<String, Box<dyn Error>> {
        Ok(fs::read_to_string(self.sources.join(file))?)
    }

    pub(crate) fn write(&self, file: &str, text: &str) -> Result<(), Box<dyn Error>> {
        let path = self.sources.join(file);
        fs::create_dir_all(path.parent().unwrap_or(&self.sources))?;
        Ok(fs::write(path, text)?)
    }

    /// Does something while files have other texts; afterwards they are restored, and new ones
    /// removed.
    pub(crate) fn with<R>(
        &self,
        changed: &BTreeMap<String, String>,
        act: impl FnOnce() -> R,
    ) -> Result<R, Box<dyn Error>> {
        let sound: Vec<_> = changed.keys().map(|file| (file, self.read(file).ok())).collect();
        for (file, text) in changed {
            self.write(file, text)?;
        }
        let result = act();
        for (file, text) in sound {
            match text {
                Some(text) => self.write(file, &text)?,
                None => fs::remove_file(self.sources.join(file))?,
            }
        }
        Ok(result)
    }

    /// Builds a program and runs some of its tests.
    pub(crate) fn run_tests(
        &self,
        program: &str,
        tests: &[&FaultTest],
    ) -> Result<TestResults, Box<dyn Error>> {
        let built = self.cargo(program, &["--no-run"])?;
        if !built.status.success() {
            let errors = String::from_utf8_lossy(&built.stderr);
            return Err(format!("it does not compile: {errors}").into());
        }
        let mut arguments = vec!["--", "--exact"];
        arguments.extend(tests.iter().map(|test| test.name.as_str()));
        let output = String::from_utf8_lossy(&self.cargo(program, &arguments)?.stdout).into_owned();
        Ok(tests.iter().filter_map(|&test| Some((test.clone(), passed(&output, &test.name)?))).collect())
    }

    /// Runs cargo without optimisation: the programs are small and run for seconds.
    fn cargo(&self, program: &str, arguments: &[&str]) -> Result<Output, Box<dyn Error>> {
        let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        command.current_dir(&self.sources).args(["test", "--locked"]).args(program.split(' '));
        command.env("CARGO_TARGET_DIR", &self.target).env("CARGO_INCREMENTAL", "1");
        command.env("CARGO_PROFILE_DEV_OPT_LEVEL", "0").env("CARGO_PROFILE_DEV_DEBUG", "false");
        Ok(command.args(arguments).output()?)
    }
}

/// Whether a test passed, according to the output of its program.
fn passed(output: &str, name: &str) -> Option<bool> {
    let line =
        output.lines().find_map(|line| line.strip_prefix("test ")?.strip_prefix(name)?.strip_prefix(" "))?;
    Some(line.ends_with("... ok"))
}

fn remove_others(root: &Path, folder: &Path, files: &BTreeSet<PathBuf>) -> Result<(), Box<dyn Error>> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            remove_others(root, &path, files)?;
        } else if !files.contains(path.strip_prefix(root)?) {
            fs::remove_file(path)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_test_passes_fails_or_does_not_run() {
        let output = "running 2 tests\ntest a::b ... ok\ntest a::bc ... FAILED\n";
        assert_eq!(["a::b", "a::bc", "a"].map(|name| passed(output, name)), [Some(true), Some(false), None]);
        assert_eq!(passed("test a - should panic ... ok\n", "a"), Some(true));
    }
}
