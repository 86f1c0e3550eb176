//! One folder per check, named by its code. `fault.*` contains the fault, `near.*` is similar
//! without it; `fault.txt` and `near.txt` are the expected findings. `MONAS_BLESS=1` rewrites them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use aseme_verify::{
    CheckSettings, Finding, ProgramSymbols, RecordedCoverage,
    check::{CHECKS, CheckReport, check},
};
use yase::vocabulary::{FieldEntry, MessageEntry, TopicEntry, TopicKind, ValueType};
use yase::{FieldId, NodeKind, Severity, Source, TopicId, TypeEnvironment};

fn folder(id: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/verify").join(id.to_lowercase())
}

/// The models in a folder whose names have a prefix, sorted.
fn models(folder: &Path, begin: &str) -> Vec<PathBuf> {
    let files = folder.read_dir().unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut files: Vec<PathBuf> = files.map(|entry| entry.unwrap().path()).collect();
    let is_meant = |file: &Path| {
        let name = file.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        name.starts_with(begin) && !name.ends_with(".txt")
    };
    files.retain(|file| is_meant(file));
    files.sort();
    assert!(!files.is_empty(), "no {begin} in {}", folder.display());
    files
}

fn report(file: &Path) -> CheckReport {
    let name = file.file_name().and_then(|name| name.to_str()).unwrap();
    let mut settings = CheckSettings::default();
    settings.events.extend(["kick".into(), "shot".into()]);
    settings.states = 500;
    let id = file.parent().and_then(Path::file_name).and_then(|name| name.to_str());
    let of_names = matches!(id, Some("m17" | "m18" | "m29")) || name.contains("known");
    settings.recorded = recorded(file);
    settings.world = of_names.then(|| world(name));
    let report = check(&Source::new(name, std::fs::read_to_string(file).unwrap()), &settings);
    assert!(!report.is_unreadable(), "{}: {:?}", file.display(), report.findings);
    report
}

/// The coverage of a run that entered only the first state, if the file name requests one.
fn recorded(file: &Path) -> Vec<RecordedCoverage> {
    if !file.file_name().is_some_and(|name| name.to_string_lossy().contains("recorded")) {
        return Vec::new();
    }
    let (chart, _) =
        aseme_models::statechart_of(&Source::new("r.srm", std::fs::read_to_string(file).unwrap()));
    let entered = chart.nodes().map(|(id, _)| id).find(|&id| chart.node(id).kind == NodeKind::Basic);
    let fired = chart.transitions().map(|(id, _)| id).next();
    vec![RecordedCoverage {
        chart,
        entered: entered.into_iter().collect(),
        fired: fired.into_iter().collect(),
    }]
}

/// A program in which Look publishes a ball and nothing reads the news. The activity Hearsay
/// declares no topics. For a bringer, Bring ends on the ball and Judge derives news from it.
fn world(model: &str) -> ProgramSymbols {
    let field = |id, name: &str, kind| FieldEntry { id: FieldId(id), name: name.into(), kind };
    let topic = |id, path: &str, message: &str| TopicEntry {
        id: TopicId(id),
        path: path.into(),
        kind: TopicKind::State,
        message: message.into(),
    };
    let vocabulary = TypeEnvironment {
        topics: vec![
            topic(0, "soccer/ball", "Ball"),
            topic(1, "soccer/news", "News"),
            topic(2, "body/eyes", "Eyes"),
        ],
        messages: vec![
            MessageEntry {
                name: "Ball".into(),
                fields: vec![field(0, "found", ValueType::Bool), field(1, "distance", ValueType::Number)],
            },
            MessageEntry { name: "News".into(), fields: vec![field(0, "good", ValueType::Bool)] },
            MessageEntry { name: "Eyes".into(), fields: vec![field(0, "open", ValueType::Bool)] },
        ],
        ..TypeEnvironment::default()
    };
    let paths = |paths: &[&str]| Some(paths.iter().map(|&path| path.to_owned()).collect::<BTreeSet<_>>());
    let mut activities =
        BTreeMap::from([("Look", paths(&["soccer/ball"])), ("Turn", paths(&[])), ("Walk", paths(&[]))]);
    let mut readers = BTreeMap::from([
        ("Look", paths(&["body/eyes"])),
        ("Turn", paths(&["soccer/ball"])),
        ("Walk", paths(&[])),
    ]);
    if model.contains("hearsay") {
        activities.insert("Hearsay", None);
        readers.insert("Hearsay", None);
    }
    let mut ended_by = BTreeMap::new();
    if model.contains("bringer") {
        activities.extend([("Bring", paths(&[])), ("Judge", paths(&["soccer/news"]))]);
        readers.extend([("Bring", paths(&["soccer/ball"])), ("Judge", paths(&["soccer/ball"]))]);
        ended_by.insert("Bring".to_owned(), BTreeSet::from(["soccer/ball".to_owned()]));
    }
    let named =
        |list: BTreeMap<&str, _>| list.into_iter().map(|(name, topics)| (name.to_owned(), topics)).collect();
    ProgramSymbols {
        vocabulary,
        activities: named(activities),
        readers: named(readers),
        ended_by,
        elsewhere: BTreeSet::from(["body/eyes".into()]),
    }
}

/// A finding and its trace.
fn text(finding: &Finding) -> String {
    let trace = finding.trace.iter().flat_map(|trace| trace.lines());
    std::iter::once(format!("{finding}\n")).chain(trace.map(|line| format!("    {line}\n"))).collect()
}

fn compare(folder: &Path, name: &str, reports: &[CheckReport]) {
    let findings = reports.iter().flat_map(|report| &report.findings);
    let actual: String = findings.map(text).collect();
    let golden = folder.join(name);
    if std::env::var_os("MONAS_BLESS").is_some() {
        std::fs::write(&golden, &actual).unwrap();
    }
    let expected = std::fs::read_to_string(&golden).unwrap_or_default();
    assert!(actual == expected, "{} differs; MONAS_BLESS=1 accepts it:\n{actual}", golden.display());
}

#[test]
fn each_check_finds_its_fault_and_not_what_is_near_it() {
    for check in CHECKS {
        let folder = folder(check.id);
        let of_check =
            |report: &CheckReport| report.findings.iter().filter(|it| it.diagnostic.code == check.id).count();
        let faults: Vec<CheckReport> = models(&folder, "fault").iter().map(|file| report(file)).collect();
        for (report, file) in faults.iter().zip(models(&folder, "fault")) {
            assert!(of_check(report) > 0, "{}: {:?}", file.display(), report.findings);
        }
        let near: Vec<CheckReport> = models(&folder, "near").iter().map(|file| report(file)).collect();
        for (report, file) in near.iter().zip(models(&folder, "near")) {
            assert_eq!(of_check(report), 0, "{}: {:?}", file.display(), report.findings);
        }
        compare(&folder, "fault.txt", &faults);
        compare(&folder, "near.txt", &near);
        let worst =
            faults.iter().flat_map(|report| &report.findings).filter(|it| it.diagnostic.code == check.id);
        let worst = worst.map(|it| it.diagnostic.severity).max();
        assert_eq!(worst, Some(check.severity), "{} finds what its table says", check.id);
    }
}

#[test]
fn findings_point_into_the_file_and_say_what_to_do() {
    for check in CHECKS {
        for file in models(&folder(check.id), "fault") {
            for finding in report(&file).findings {
                let diagnostic = finding.diagnostic;
                assert!(
                    diagnostic.source.is_some() && diagnostic.span.end > diagnostic.span.start,
                    "{diagnostic}"
                );
                let is_information =
                    diagnostic.severity == Severity::Information || diagnostic.code.starts_with('E');
                assert!(diagnostic.hint.is_some() || is_information, "{diagnostic}");
            }
        }
    }
}

#[test]
fn the_table_is_in_order_and_names_each_check_once() {
    assert!(CHECKS.windows(2).all(|pair| pair[0].id < pair[1].id));
    assert!(CHECKS.iter().all(|check| !check.title.ends_with('.') && !check.title.is_empty()));
}

#[test]
fn a_chart_that_cannot_be_explored_is_reported_with_the_reason() {
    let role = "Role: r\nLiveness:\nr = look . turn\nTransitions:\nlook -> turn : [In(nowhere)]\n";
    let report = check(&Source::new("r.srm", role), &CheckSettings::default());
    let found: Vec<String> = report.findings.iter().map(ToString::to_string).collect();
    assert_eq!(report.explored, None, "{found:?}");
    let reason = "there is no state `nowhere` (from `r/look` to `r/turn`)";
    assert!(
        matches!(found.as_slice(), [one] if one.starts_with("r.srm:5:20: warning[E0140]: not explored: ") && one.contains(reason)),
        "{found:?}"
    );
}

#[test]
fn the_projects_own_roles_are_without_findings_that_matter() {
    for name in ["goalie.srm", "attacker.srm", "extended_attacker.srm", "extended_attacker.iac", "attack.eac"]
    {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models").join(name);
        let report = report(&path);
        println!("{name}: {:?}", report.explored);
        let findings = report.findings.iter().filter(|it| it.diagnostic.severity > Severity::Information);
        let findings: Vec<String> = findings.map(ToString::to_string).collect();
        // two activities of the thesis begin with a small letter, and no program is there to ask
        let is_about_letters = |it: &String| it.contains("warning[M21]: `passBall` has no formula");
        let findings: Vec<&String> = findings.iter().filter(|it| !is_about_letters(it)).collect();
        assert_eq!(findings, [""; 0], "{name}");
    }
}

/// Names in a formula that only look like formulas are reported where they stand.
#[test]
fn a_name_like_that_of_a_formula_is_reported() {
    let about_names = |text: &str| -> Vec<String> {
        let report = check(&Source::new("r.srm", text), &CheckSettings::default());
        report.findings.iter().filter(|it| it.diagnostic.code == "M21").map(ToString::to_string).collect()
    };
    let expected = "r.srm:1:9: warning[M21]: `b` has no formula and is taken for an activity (write its formula, or check the role with the program that has the activity)";
    assert_eq!(about_names("r = A . b . (c | b)\nc = D"), [expected]);
    assert_eq!(about_names("r = a . b"), [""; 0]);
}

/// Consequences of a misspelt name are not reported beside it.
#[test]
fn a_misspelt_name_is_the_only_finding() {
    let text = "Role: r\nLiveness:\nr = Stand . acton\naction = (Search | chase)~\nchase = Walk\n\
                Transitions:\nCONDITION -> Search : [!Ball.found]\nCONDITION -> chase : [Ball.found]\n";
    let report = check(&Source::new("r.srm", text), &CheckSettings::default());
    let found: Vec<&str> = report.findings.iter().map(|it| it.diagnostic.code).collect();
    assert_eq!(found, ["E0217"]);
}

/// The rules and outcomes of a protocol are held against the messages of the program.
#[test]
fn rules_and_outcomes_read_what_the_program_has() {
    let text = "AIP:\nParticipant: a\n  engaging_rules = [Ball.fuond && Ball.distance < 2]\n  outcomes = [News.good] or [Ball.]\nParticipant: b\nProtocol: p\n  participants = a, b\n";
    let found = |world: Option<ProgramSymbols>| -> Vec<String> {
        let mut settings = CheckSettings::default();
        settings.world = world;
        check(&Source::new("p.aip", text), &settings).findings.iter().map(ToString::to_string).collect()
    };
    let linked = found(Some(world("p")));
    let unknown = "p.aip:2:1: error[M17]: in `[Ball.fuond && Ball.distance < 2]` of `a`: the message `Ball` has no field `fuond` (did you mean `found`?)";
    assert!(linked.iter().any(|it| it == unknown), "{linked:?}");
    let unreadable = |it: &String| it.contains("error[E0838]: `[Ball.` of `a` is not a condition");
    assert_eq!(linked.iter().filter(|it| unreadable(it)).count(), 1, "{linked:?}");
    assert_eq!(found(None).iter().filter(|it| it.contains("M17")).count(), 0);
}

/// Of 24 activities that may run in any order any set may have published before the guard.
#[test]
fn a_stale_guard_is_found_behind_any_number_of_alternatives() {
    let mut world = world("bringer");
    let names: Vec<String> = (0..24).map(|number| format!("Note{number}")).collect();
    for name in &names {
        world.activities.insert(name.clone(), Some([format!("team/{name}")].into()));
        world.readers.insert(name.clone(), Some(BTreeSet::new()));
    }
    // one of them derives the news, but another one may be chosen
    world.activities.insert("Note7".into(), Some(["soccer/news".to_owned()].into()));
    let role = format!(
        "Role: r\nLiveness:\nr = (Bring . ({})+ . [Walk])~ || Judge~\nTransitions:\nCONDITION -> Walk : [News.good]\n",
        names.join("|")
    );
    let mut settings = CheckSettings::default();
    settings.states = 0;
    settings.world = Some(world);
    let report = check(&Source::new("r.srm", role), &settings);
    let stale = report.findings.iter().filter(|finding| finding.diagnostic.code == "M29");
    let messages: Vec<&str> = stale.map(|finding| finding.diagnostic.message.as_str()).collect();
    assert_eq!(messages.len(), 1, "{messages:?}");
    assert!(messages[0].contains("reads `soccer/news`"), "{messages:?}");
}
