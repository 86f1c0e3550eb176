//! SCION's traces: events in, configurations out.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::Value as Json;
use yase::expression::{ActionKind, ExpressionKind};
use yase::{NodeKind, Semantics, Source, Statechart, Timestamp};
use yase_scxml::{DataValue, Document, ScxmlEvent, Session, read};

use crate::suites::{self, Neighbours};

/// A chart with its trace.
struct Case {
    name: String,
    path: PathBuf,
    trace: Json,
}

fn cases(folder: &Path) -> Vec<Case> {
    let mut cases = Vec::new();
    for group in sorted(folder).into_iter().filter(|path| path.is_dir()) {
        for path in
            sorted(&group).into_iter().filter(|path| path.extension().is_some_and(|end| end == "scxml"))
        {
            let Ok(trace) = std::fs::read_to_string(path.with_extension("json")) else { continue };
            let name = path.strip_prefix(folder).unwrap().with_extension("").display().to_string();
            cases.push(Case { name, path, trace: serde_json::from_str(&trace).unwrap() });
        }
    }
    cases
}

fn sorted(folder: &Path) -> Vec<PathBuf> {
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
}

fn document(case: &Case) -> Result<Document, String> {
    let source = Source::new(case.name.as_str(), std::fs::read_to_string(&case.path).unwrap());
    let (document, found) = read(&source);
    match found.iter().find(|found| found.is_error()) {
        Some(error) => Err(error.to_string()),
        None => document.ok_or_else(|| "there is no document".into()),
    }
}

/// Whether nothing in the chart depends on data: conditions are those of the chart, contents raise,
/// log, or send names.
fn is_data_free(document: &Document) -> bool {
    let chart = document.statechart();
    let nodes = chart.nodes().flat_map(|(_, node)| node.entry.iter().chain(&node.exit));
    let segments = chart.transitions().flat_map(|(_, transition)| &transition.expression.actions);
    let plain = nodes.chain(segments).all(|action| match &action.kind {
        ActionKind::Script(text) => {
            !["<assign", "<script", "<foreach", "<if"].iter().any(|data| text.contains(data))
        }
        _ => true,
    });
    let guards = chart.transitions().filter_map(|(_, transition)| transition.expression.guard.as_ref());
    document.variables() == 0 && plain && guards.into_iter().all(|guard| !holds_script(&guard.kind))
}

fn holds_script(kind: &ExpressionKind) -> bool {
    match kind {
        ExpressionKind::Script(_) => true,
        ExpressionKind::Not(operand) => holds_script(&operand.kind),
        ExpressionKind::And(operands) | ExpressionKind::Or(operands) => {
            operands.iter().any(|operand| holds_script(&operand.kind))
        }
        _ => false,
    }
}

/// A script that is missing in the local copy of the suite.
fn missing_script(case: &Case) -> Option<String> {
    let text = std::fs::read_to_string(&case.path).unwrap();
    let names = text.split("<script src=\"").skip(1).filter_map(|rest| rest.split('"').next());
    let mut missing = names.filter(|name| !case.path.parent().unwrap().join(name).exists());
    missing.next().map(str::to_owned)
}

/// Plays a trace and returns the first difference, if any.
fn play(case: &Case, document: &Document, semantics: Semantics) -> Result<(), String> {
    let platform = Neighbours { folder: case.path.parent().unwrap().to_owned(), ..Neighbours::default() };
    let mut session = match Session::with_semantics(document, platform, semantics) {
        Ok(session) => session,
        Err(found) => return Err(found.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")),
    };
    let chart = document.statechart();
    session.start(Timestamp::ZERO).map_err(|error| error.to_string())?;
    compare(&session, chart, &case.trace["initialConfiguration"], "at the beginning")?;
    let mut now = Timestamp::ZERO;
    for (index, step) in case.trace["events"].as_array().unwrap().iter().enumerate() {
        if let Some(after) = step["after"].as_u64() {
            now = now + Duration::from_millis(after);
            session.advance_to(now).map_err(|error| error.to_string())?;
        }
        let name = step["event"]["name"].as_str().unwrap();
        let event = ScxmlEvent::new(name).with_data(data(&step["event"]["data"]));
        session.send(event).map_err(|error| error.to_string())?;
        compare(
            &session,
            chart,
            &step["nextConfiguration"],
            &format!("after `{name}`, the event number {index}"),
        )?;
    }
    Ok(())
}

fn data(json: &Json) -> DataValue {
    match json {
        Json::Null => DataValue::Undefined,
        Json::Bool(value) => DataValue::Bool(*value),
        Json::Number(number) => DataValue::Number(number.as_f64().unwrap()),
        Json::String(text) => DataValue::Text(text.clone()),
        Json::Array(items) => DataValue::Array(items.iter().map(data).collect()),
        Json::Object(members) => {
            DataValue::Object(members.iter().map(|(name, value)| (name.clone(), data(value))).collect())
        }
    }
}

fn compare(
    session: &Session<Neighbours>,
    chart: &Statechart,
    expected: &Json,
    when: &str,
) -> Result<(), String> {
    let atomic = |name: &&str| {
        let mut nodes = chart.nodes().filter(|(_, node)| node.name == *name);
        nodes.any(|(_, node)| matches!(node.kind, NodeKind::Basic | NodeKind::End))
    };
    let expected: BTreeSet<&str> =
        expected.as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    let found: BTreeSet<&str> = session.configuration().into_iter().filter(atomic).collect();
    if expected == found {
        return Ok(());
    }
    Err(format!("{when}: {found:?} where the trace has {expected:?}"))
}

#[test]
fn traces_are_as_on_record_under_scxml() {
    let Some(folder) = suites::folder("scion") else {
        println!("SCION's suite is not there: nothing was run");
        return;
    };
    let mut counts: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    let mut differences = BTreeMap::new();
    for case in cases(&folder) {
        let document = match document(&case) {
            Ok(document) => document,
            Err(error) => {
                println!("refused: {error}");
                continue;
            }
        };
        if let Some(missing) = missing_script(&case) {
            println!("not there: {} needs {missing}", case.name);
            continue;
        }
        let kind = if is_data_free(&document) { "scion data-free" } else { "scion with data" };
        let count = counts.entry(kind).or_default();
        count.1 += 1;
        match play(&case, &document, Semantics::scxml()) {
            Ok(()) => count.0 += 1,
            Err(difference) => {
                differences.insert(case.name, difference);
            }
        }
    }
    for (kind, (passed, all)) in &counts {
        println!("{kind}: {passed} of {all}");
    }
    check(&differences, include_str!("scion-scxml.txt"));
    for (kind, (passed, _)) in counts {
        assert!(passed >= suites::recorded(kind), "{kind}: {passed}");
    }
}

/// Every difference is recorded with its reason, and every recorded one occurs.
fn check(differences: &BTreeMap<String, String>, record: &str) {
    let lines = record.lines().filter(|line| !line.starts_with('#'));
    let recorded: BTreeMap<&str, &str> = lines.filter_map(|line| line.split_once(": ")).collect();
    for (name, difference) in differences {
        println!("{name}: {difference}");
        assert!(recorded.contains_key(name.as_str()), "{name} is not on record: {difference}");
    }
    for (name, reason) in recorded {
        assert!(!reason.trim().is_empty(), "{name} has no reason");
        assert!(differences.contains_key(name), "{name} is on record and does not differ any more");
    }
}

/// The recorded differences under the semantics `yase` are exactly those that occur.
#[test]
fn differences_under_yase_are_those_on_record() {
    let Some(folder) = suites::folder("scion") else {
        println!("SCION's suite is not there: nothing was run");
        return;
    };
    let (mut differences, mut same) = (BTreeMap::new(), 0);
    for case in cases(&folder) {
        let Ok(document) = document(&case) else { continue };
        if !is_data_free(&document) {
            continue;
        }
        match play(&case, &document, Semantics::yase()) {
            Ok(()) => same += 1,
            Err(difference) => {
                differences.insert(case.name, difference);
            }
        }
    }
    println!("the same under yase: {same} of {}", same + differences.len());
    check(&differences, include_str!("scion-yase.txt"));
}
