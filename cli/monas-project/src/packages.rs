//! The names of the packages that a project has or depends on.

use std::fs;
use std::path::{Path, PathBuf};

use crate::manifest::{table, value};

/// The folder of the package of that name in a project, whose packages are in its folder or at most
/// two levels below. Names that differ in hyphens and underscores only are one name of a crate.
pub(crate) fn package_folder(project: &Path, name: &str) -> Option<PathBuf> {
    let below = folders(project);
    let inner: Vec<PathBuf> = below.iter().flat_map(|folder| folders(folder)).collect();
    let is_it = |folder: &PathBuf| {
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).unwrap_or_default();
        let package = table(&manifest, "[package]").and_then(|table| value(table, "name"));
        package.is_some_and(|package| package.replace('-', "_") == name.replace('-', "_"))
    };
    std::iter::once(project.to_path_buf()).chain(below).chain(inner).find(is_it)
}

/// The folders in a folder, sorted.
fn folders(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut folders: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
    folders.sort_unstable(); // independent of the file system's order
    folders
}

/// Whether a lock file has a package of that name from a registry or repository. A second one of
/// the name would make `cargo --package NAME` ambiguous.
pub(crate) fn is_locked(lock: &Path, name: &str) -> bool {
    let lock = fs::read_to_string(lock).unwrap_or_default();
    let mut packages = lock.split("[[package]]");
    packages.any(|package| value(package, "name") == Some(name) && value(package, "source").is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packages_are_found_by_the_names_of_their_manifests() {
        let project = tempfile::tempdir().expect("a folder");
        let package = |folder: &str, name: &str| {
            let folder = project.path().join(folder);
            fs::create_dir_all(&folder).expect("folders");
            fs::write(folder.join("Cargo.toml"), format!("[package]\nname = \"{name}\"\n")).expect("a file");
            folder
        };
        let (legs, eyes) = (package("legs", "long-legs"), package("modules/eyes", "eyes"));
        assert_eq!(package_folder(project.path(), "long_legs"), Some(legs));
        assert_eq!(package_folder(project.path(), "eyes"), Some(eyes));
        assert_eq!(package_folder(project.path(), "modules"), None);
    }

    #[test]
    fn only_packages_from_elsewhere_are_locked() {
        let project = tempfile::tempdir().expect("a folder");
        let lock = project.path().join("Cargo.lock");
        assert!(!is_locked(&lock, "serde"));
        let text = "version = 4\n\n[[package]]\nname = \"look\"\nversion = \"0.1.0\"\n\n\
                    [[package]]\nname = \"serde\"\nversion = \"1.0.0\"\nsource = \"registry+https://example.org\"\n";
        fs::write(&lock, text).expect("a file");
        assert!(is_locked(&lock, "serde") && !is_locked(&lock, "look") && !is_locked(&lock, "serd"));
    }
}
