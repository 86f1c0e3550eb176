//! A change of behaviour in all methodologies, a fault or a change request, as a file: prose,
//! `Class:`, `Player:`, and for each methodology `Methodology:` followed by unified diffs or
//! `Cannot be made:` with the reason.

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::Path;

use crate::faults::patch;

/// The construction of a player, as in `monas eval`.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Methodology {
    Direct,
    Agents,
    Aseme,
}

impl Methodology {
    pub(crate) const ALL: [Methodology; 3] = [Methodology::Direct, Methodology::Agents, Methodology::Aseme];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Methodology::Direct => "direct",
            Methodology::Agents => "agents",
            Methodology::Aseme => "aseme",
        }
    }

    /// Whether a file is a hand-written source of this methodology.
    pub(crate) fn owns(self, file: &str) -> bool {
        let prefixes: &[&str] = match self {
            Methodology::Direct => &["soccer/monas-eval/src/direct", "soccer/monas-eval/src/thresholds/"],
            Methodology::Agents => {
                &["soccer/monas-eval/src/agents", "soccer/monas-eval/src/thresholds/", "config/evaluation/"]
            }
            Methodology::Aseme => &["models/"],
        };
        prefixes.iter().any(|prefix| file.starts_with(prefix))
    }
}

/// The fault in one methodology.
pub(crate) enum Edit {
    /// The file of each diff, and the diff.
    Diffs(Vec<(String, String)>),
    /// Why the fault has no place in this methodology.
    CannotBeMade(String),
}

/// A fault or a change request, in all methodologies.
#[derive(Default)]
pub(crate) struct BehaviourPatch {
    pub(crate) name: String,
    /// A description of the fault.
    pub(crate) prose: String,
    /// Its class, which names it in tables.
    pub(crate) class: String,
    /// `goalie` or `attacker`: the role whose model is changed.
    pub(crate) player: String,
    pub(crate) edits: BTreeMap<Methodology, Edit>,
}

/// All faults of a folder, sorted by name.
pub(crate) fn read(folder: &Path) -> Result<Vec<BehaviourPatch>, Box<dyn Error>> {
    let mut faults = Vec::new();
    for entry in fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "patch") {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            faults.push(parse(&name, &fs::read_to_string(&path)?)?);
        }
    }
    faults.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(faults)
}

fn parse(name: &str, text: &str) -> Result<BehaviourPatch, String> {
    let mut fault = BehaviourPatch { name: name.to_owned(), ..BehaviourPatch::default() };
    let (head, methodologies) =
        text.split_once("\nMethodology: ").ok_or_else(|| format!("{name}: no `Methodology:`"))?;
    for line in head.lines() {
        match line.split_once(": ") {
            Some(("Class", class)) => fault.class = class.trim().to_owned(),
            Some(("Player", player)) => fault.player = player.trim().to_owned(),
            _ => fault.prose.push_str(line.trim()),
        }
    }
    for section in methodologies.split("\nMethodology: ") {
        let (methodology, body) = section.split_once('\n').unwrap_or((section, ""));
        let methodology = Methodology::ALL.into_iter().find(|it| it.name() == methodology.trim());
        let methodology =
            methodology.ok_or_else(|| format!("{name}: a methodology is direct, agents or aseme"))?;
        fault.edits.insert(
            methodology,
            edit(body).ok_or_else(|| format!("{name}: no edit for {}", methodology.name()))?,
        );
    }
    let is_complete = !fault.prose.is_empty()
        && !fault.class.is_empty()
        && ["goalie", "attacker"].contains(&fault.player.as_str())
        && fault.edits.len() == Methodology::ALL.len();
    is_complete
        .then_some(fault)
        .ok_or_else(|| format!("{name}: prose, class, player or a methodology is missing"))
}

fn edit(body: &str) -> Option<Edit> {
    if let Some(reason) = body.trim().strip_prefix("Cannot be made: ") {
        return Some(Edit::CannotBeMade(reason.trim().to_owned())).filter(|_| !reason.trim().is_empty());
    }
    // Blank lines may separate the last diff from the next methodology; diffs have a space there.
    let body = format!("{}\n", body.trim_end_matches('\n'));
    let mut diffs: Vec<(String, String)> = Vec::new();
    for line in body.split_inclusive('\n') {
        if let Some(file) = line.strip_prefix("--- a/") {
            diffs.push((file.trim().to_owned(), line.to_owned()));
        } else if let Some((_, diff)) = diffs.last_mut() {
            diff.push_str(line);
        }
    }
    (!diffs.is_empty()).then_some(Edit::Diffs(diffs))
}

impl BehaviourPatch {
    /// The files that it changes in a methodology, with the fault.
    pub(crate) fn apply(
        &self,
        methodology: Methodology,
        read: impl Fn(&str) -> Result<String, Box<dyn Error>>,
    ) -> Result<BTreeMap<String, String>, Box<dyn Error>> {
        match self.edits.get(&methodology) {
            Some(Edit::Diffs(diffs)) => {
                patch::apply(&format!("{} ({})", self.name, methodology.name()), diffs, read)
            }
            Some(Edit::CannotBeMade(reason)) => Err(format!("{}: {reason}", self.name).into()),
            None => Err(format!("{}: nothing for {}", self.name, methodology.name()).into()),
        }
    }
}

impl BehaviourPatch {
    /// The lines of code, positions and files that it changes in the sources of a methodology,
    /// without tests.
    pub(crate) fn extent(&self, methodology: Methodology) -> (usize, usize, usize) {
        let Some(Edit::Diffs(diffs)) = self.edits.get(&methodology) else { return (0, 0, 0) };
        let own: Vec<&str> =
            diffs.iter().filter(|(file, _)| methodology.owns(file)).map(|(_, diff)| diff.as_str()).collect();
        let lines = own.iter().flat_map(|diff| diff.lines());
        let is_code = |line: &str| {
            let code = line.strip_prefix(['+', '-']).map(str::trim);
            code.is_some_and(|code| !code.is_empty() && !code.starts_with("//") && !code.starts_with('#'))
        };
        let is_header = |line: &str| line.starts_with("+++ ") || line.starts_with("--- ");
        let changed = lines.clone().filter(|line| !is_header(line) && is_code(line)).count();
        (changed, lines.filter(|line| line.starts_with("@@")).count(), own.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "It is wrong.\n\nClass: wrong sign\nPlayer: goalie\n\nMethodology: direct\n--- a/x.rs\n+++ b/x.rs\n@@ -1,2 +1,2 @@\n one\n-two\n+three\n\nMethodology: agents\nCannot be made: it has none.\n\nMethodology: aseme\n--- a/x.srm\n+++ b/x.srm\n@@ -1 +1 @@\n-one\n+two\n";

    #[test]
    fn a_fault_has_an_edit_or_a_reason_for_each_way() {
        let fault = parse("f", TEXT).unwrap();
        assert_eq!((fault.class.as_str(), fault.player.as_str()), ("wrong sign", "goalie"));
        assert_eq!(
            fault.apply(Methodology::Direct, |_| Ok("one\ntwo\n".into())).unwrap()["x.rs"],
            "one\nthree\n"
        );
        assert!(
            matches!(&fault.edits[&Methodology::Agents], Edit::CannotBeMade(why) if why == "it has none.")
        );
        assert_eq!(fault.apply(Methodology::Aseme, |_| Ok("one\n".into())).unwrap()["x.srm"], "two\n");
    }

    #[test]
    fn comments_and_tests_are_no_edits() {
        let of_models = TEXT.replace("x.srm", "models/x.srm").replace("+two\n", "+two\n+# why\n");
        let fault = parse("f", &of_models).unwrap();
        assert_eq!(
            Methodology::ALL.map(|methodology| fault.extent(methodology)),
            [(0, 0, 0), (0, 0, 0), (2, 1, 1)]
        );
    }

    #[test]
    fn incomplete_faults_are_rejected() {
        for (part, instead) in [
            ("It is wrong.", ""),
            ("Class: wrong sign", ""),
            ("goalie", "referee"),
            ("Methodology: agents\nCannot be made: it has none.\n", ""),
            ("Cannot be made: it has none.", ""),
            ("Methodology: aseme", "Methodology: other"),
        ] {
            assert!(parse("f", &TEXT.replace(part, instead)).is_err(), "without {part}");
        }
    }
}
