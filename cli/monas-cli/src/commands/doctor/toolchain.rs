//! Checks of the toolchain that builds projects.

use std::process::Command;

use super::CheckResult;

const AREA: &str = "toolchain";
/// The oldest compiler that builds Monas, from the workspace's manifest.
const MIN_RUST_VERSION: &str = env!("CARGO_PKG_RUST_VERSION");

pub(crate) fn findings() -> Vec<CheckResult> {
    vec![compiler(version("rustc").as_deref()), builder(version("cargo").as_deref())]
}

/// The first line that a program prints for `--version`.
fn version(program: &str) -> Option<String> {
    let output =
        Command::new(program).arg("--version").output().ok().filter(|output| output.status.success())?;
    String::from_utf8(output.stdout).ok()?.lines().next().map(str::to_owned)
}

fn compiler(said: Option<&str>) -> CheckResult {
    let install = "install it from https://rustup.rs to build projects; running needs none";
    let Some(said) = said else { return CheckResult::warning(AREA, "there is no rustc", install) };
    let number = said.split_whitespace().nth(1).unwrap_or_default();
    match numbers(number) >= numbers(MIN_RUST_VERSION) {
        true => CheckResult::ok(AREA, said),
        false => CheckResult::error(
            AREA,
            format!("{said} is older than {MIN_RUST_VERSION}"),
            "`rustup update` installs a newer one",
        ),
    }
}

fn builder(said: Option<&str>) -> CheckResult {
    match said {
        Some(said) => CheckResult::ok(AREA, said),
        None => CheckResult::warning(AREA, "there is no cargo", "it comes with rustc: https://rustup.rs"),
    }
}

/// A version as numbers that compare in order.
fn numbers(version: &str) -> Vec<u32> {
    version.split(['.', '-']).map_while(|part| part.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::doctor::CheckStatus;

    #[test]
    fn an_old_compiler_is_distinguished_from_a_new_one() {
        assert_eq!(compiler(Some("rustc 1.70.0 (90c541806 2023-05-31)")).state, CheckStatus::Error);
        assert_eq!(compiler(Some("rustc 1.100.0-nightly (x)")).state, CheckStatus::Ok);
        assert_eq!(compiler(None).state, CheckStatus::Warning);
    }
}
