//! What builds projects.

use std::process::Command;

use super::Finding;

const AREA: &str = "toolchain";
/// The oldest compiler that builds Monas, as the workspace says.
const OLDEST: &str = env!("CARGO_PKG_RUST_VERSION");

pub(super) fn findings() -> Vec<Finding> {
    vec![compiler(version("rustc").as_deref()), builder(version("cargo").as_deref())]
}

/// The first line that a program says of its version.
fn version(program: &str) -> Option<String> {
    let output =
        Command::new(program).arg("--version").output().ok().filter(|output| output.status.success())?;
    String::from_utf8(output.stdout).ok()?.lines().next().map(str::to_owned)
}

fn compiler(said: Option<&str>) -> Finding {
    let install = "https://rustup.rs installs one; running needs none, building a project does";
    let Some(said) = said else { return Finding::odd(AREA, "there is no rustc", install) };
    let number = said.split_whitespace().nth(1).unwrap_or_default();
    match numbers(number) >= numbers(OLDEST) {
        true => Finding::well(AREA, said),
        false => Finding::wrong(
            AREA,
            format!("{said} is older than {OLDEST}"),
            "`rustup update` brings a newer one",
        ),
    }
}

fn builder(said: Option<&str>) -> Finding {
    match said {
        Some(said) => Finding::well(AREA, said),
        None => Finding::odd(AREA, "there is no cargo", "it comes with rustc: https://rustup.rs"),
    }
}

/// A version as numbers that can be compared.
fn numbers(version: &str) -> Vec<u32> {
    version.split(['.', '-']).map_while(|part| part.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::State;
    use super::*;

    #[test]
    fn an_old_compiler_is_told_from_a_new_one() {
        assert_eq!(compiler(Some("rustc 1.70.0 (90c541806 2023-05-31)")).state, State::Wrong);
        assert_eq!(compiler(Some("rustc 1.100.0-nightly (x)")).state, State::Well);
        assert_eq!(compiler(None).state, State::Odd);
    }
}
