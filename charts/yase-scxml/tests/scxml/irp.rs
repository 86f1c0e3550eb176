//! The W3C's tests of SCXML processors: each document must reach its state `pass`.

use std::collections::BTreeMap;
use std::fmt::{self, Display, Formatter};
use std::path::Path;

use yase::{Source, Timestamp};
use yase_scxml::{Session, read};

use crate::suites::Neighbours;

/// Time limit: a document that has not finished by then hangs.
const TIMEOUT: Timestamp = Timestamp::from_millis(120_000);

/// A row of the suite's `index.csv`.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) id: String,
    pub(crate) level: String,
    pub(crate) mandatory: bool,
    pub(crate) automatic: bool,
    /// `null` and `ecma`, where the row has such a document.
    pub(crate) documents: Vec<&'static str>,
    pass_state: String,
}

/// Result of one document.
#[derive(Clone, Debug)]
pub(crate) struct Result {
    pub(crate) row: Row,
    pub(crate) kind: &'static str,
    /// Why it did not pass.
    pub(crate) failure: Option<String>,
}

/// Results of all documents.
#[derive(Clone, Debug, Default)]
pub(crate) struct Report {
    pub(crate) results: Vec<Result>,
    /// Rows that need JavaScript, HTTP or XPath, by level.
    pub(crate) out_of_scope: BTreeMap<String, Vec<String>>,
}

/// Runs every document of the suite that is in scope.
pub(crate) fn run(folder: &Path) -> Report {
    let mut report = Report::default();
    for row in rows(folder) {
        if matches!(row.level.as_str(), "J" | "H" | "X") {
            report.out_of_scope.entry(row.level).or_default().push(row.id);
            continue;
        }
        for kind in row.documents.clone() {
            let path = folder.join(kind).join(format!("test{}.scxml", row.id));
            let failure = outcome(&path, &row.pass_state).err();
            report.results.push(Result { row: row.clone(), kind, failure });
        }
    }
    report
}

fn rows(folder: &Path) -> Vec<Row> {
    let index = std::fs::read_to_string(folder.join("index.csv")).unwrap_or_default();
    let mut lines = index.lines();
    let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let rows = lines.map(|line| {
        let fields: BTreeMap<&str, &str> = header.iter().copied().zip(line.split(',')).collect();
        let field = |name: &str| fields.get(name).copied().unwrap_or_default();
        let documents = ["null", "ecma"].into_iter().filter(|kind| field(kind) == "1");
        Row {
            id: field("id").into(),
            level: field("level").into(),
            mandatory: field("conformance") == "mandatory",
            automatic: field("auto") == "auto",
            documents: documents.collect(),
            pass_state: field("pass_state").into(),
        }
    });
    rows.collect()
}

fn outcome(path: &Path, pass_state: &str) -> std::result::Result<(), String> {
    let text = std::fs::read_to_string(path).map_err(|error| error.to_string())?;
    let source = Source::new(path.display().to_string(), text);
    let (document, found) = read(&source);
    if let Some(error) = found.iter().find(|found| found.is_error()) {
        return Err(error.to_string());
    }
    let document = document.ok_or("there is no document")?;
    let folder = path.parent().unwrap_or(Path::new(".")).to_owned();
    let platform = Neighbours { folder, ..Neighbours::default() };
    let mut session = Session::new(&document, platform)
        .map_err(|found| found.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))?;
    session.start(Timestamp::ZERO).map_err(|error| error.to_string())?;
    session.advance_to(TIMEOUT).map_err(|error| error.to_string())?;
    match session.configuration().as_slice() {
        [state] if *state == pass_state => Ok(()),
        states => Err(format!("it is in {}", states.join(", "))),
    }
}

impl Report {
    /// The number of documents of the null data model that pass, and their total.
    pub(crate) fn null(&self) -> (usize, usize) {
        let rows: Vec<_> =
            self.results.iter().filter(|result| result.kind == "null" && result.row.automatic).collect();
        (rows.iter().filter(|result| result.failure.is_none()).count(), rows.len())
    }

    /// The number of mandatory automatic rows all of whose documents pass, and their total.
    pub(crate) fn mandatory(&self) -> (usize, usize) {
        self.rows(|row| row.mandatory && row.automatic)
    }

    fn rows(&self, which: impl Fn(&Row) -> bool) -> (usize, usize) {
        let mut rows: BTreeMap<&str, bool> = BTreeMap::new();
        for result in self.results.iter().filter(|result| which(&result.row)) {
            *rows.entry(&result.row.id).or_insert(true) &= result.failure.is_none();
        }
        (rows.values().filter(|passes| **passes).count(), rows.len())
    }

    /// The documents that do not pass, each with the reason.
    pub(crate) fn failures(&self) -> Vec<String> {
        let failed = self.results.iter().filter_map(|result| {
            let failure = result.failure.as_ref()?;
            Some(format!("{}/test{} ({}): {failure}", result.kind, result.row.id, result.row.level))
        });
        failed.collect()
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "level  mandatory      other rows")?;
        for level in ["N", "E1", "E2", "E3", "E4"] {
            let counted = |row: &Row| row.level == level && row.mandatory && row.automatic;
            let (passed, all) = self.rows(counted);
            let (other, others) = self.rows(|row| row.level == level && !counted(row));
            writeln!(f, "{level:<5}  {passed:>3} of {all:<3}     {other:>3} of {others:<3}")?;
        }
        let (passed, all) = self.mandatory();
        writeln!(f, "all    {passed:>3} of {all:<3}")?;
        let (passed, all) = self.null();
        writeln!(f, "null   {passed:>3} of {all:<3} documents")?;
        for failure in self.failures() {
            writeln!(f, "failed {failure}")?;
        }
        for (level, ids) in &self.out_of_scope {
            let why = match level.as_str() {
                "J" => "JavaScript",
                "H" => "HTTP",
                _ => "XPath",
            };
            writeln!(f, "out of scope, needs {why}: {} rows: {}", ids.len(), ids.join(" "))?;
        }
        Ok(())
    }
}
