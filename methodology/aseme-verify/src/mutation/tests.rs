use super::*;

const ROLE: &str = "Role: r
Liveness:
r = A . (B | C | D)
Constants:
near = 0.25
Transitions:
A -> (B|C|D) : [late] / StartTimeout(late, 100ms)
CONDITION -> B !1 : [Ball.found && Ball.distance <= near]
CONDITION -> C : [Ball.distance > 2]
";

fn of(text: &str) -> Vec<Mutant> {
    mutants(&Source::new("r.srm", text)).expect("the role is in order")
}

/// The descriptions of the mutants whose names start with an element.
fn descriptions(mutants: &[Mutant], element: &str) -> Vec<String> {
    let here = mutants.iter().filter_map(|mutant| {
        let name = mutant.name.strip_prefix(element)?.strip_prefix(" #")?;
        Some(format!("{name}{}", &mutant.description[element.len()..]))
    });
    here.collect()
}

#[test]
fn a_guard_is_changed_in_every_part() {
    let guard = "the guard `[Ball.found && Ball.distance <= near]`";
    assert_eq!(
        descriptions(&of(ROLE), "CONDITION -> B"),
        [
            format!("guard-negated: {guard} becomes `[!(Ball.found && Ball.distance <= near)]`"),
            format!("guard-removed: {guard} is removed"),
            format!("part-dropped: {guard} becomes `[Ball.distance <= near]`"),
            format!("part-dropped-2: {guard} becomes `[Ball.found]`"),
            format!("and-or: {guard} becomes `[Ball.found || Ball.distance <= near]`"),
            format!("comparison: {guard} becomes `[Ball.found && Ball.distance < near]`"),
            String::from("target: the target is `C`"),
            String::from("transition-removed: it is never taken"),
        ]
    );
}

#[test]
fn numbers_go_a_step_up_and_a_step_down() {
    let mutants = of(ROLE);
    let numbers: Vec<&str> = mutants
        .iter()
        .filter(|mutant| mutant.kind == MutationKind::Number)
        .map(|mutant| mutant.description.as_str())
        .collect();
    assert_eq!(
        numbers,
        [
            "CONDITION -> C: the guard `[Ball.distance > 2]` becomes `[Ball.distance > 3]`",
            "CONDITION -> C: the guard `[Ball.distance > 2]` becomes `[Ball.distance > 1]`",
            "near: the constant is 0.275 instead of 0.25",
            "near: the constant is 0.225 instead of 0.25",
        ]
    );
    let of_constant = mutants.last().expect("there are some");
    assert_eq!(&ROLE[of_constant.span.start..of_constant.span.end], "near = 0.25");
}

#[test]
fn a_timer_runs_another_time_or_is_not_started() {
    let actions: Vec<String> =
        descriptions(&of(ROLE), "A -> (B|C|D)").into_iter().filter(|it| !it.starts_with("guard")).collect();
    assert_eq!(
        actions,
        [
            "timeout: `late` runs 50ms instead of 100ms",
            "timeout-2: `late` runs 200ms instead of 100ms",
            "timeout-3: `late` is never started",
            "target: the target is `r/END`",
            "transition-removed: it is never taken",
        ]
    );
}

#[test]
fn each_mutant_has_the_span_of_its_change_and_is_unique() {
    let source = Source::new("r.srm", ROLE);
    let mutants = of(ROLE);
    let (chart, _) = aseme_models::statechart_of(&source);
    for (index, mutant) in mutants.iter().enumerate() {
        assert!(mutant.chart != chart, "{}", mutant.name);
        assert!(
            mutants[..index].iter().all(|it| it.chart != mutant.chart && it.name != mutant.name),
            "{}",
            mutant.name
        );
    }
    let line = |name: &str| {
        let mutant = mutants.iter().find(|mutant| mutant.name == name).expect(name);
        source.position(mutant.span.start).0
    };
    assert_eq!(line("CONDITION -> C #comparison"), 9);
    assert_eq!(
        line("START -> A #transition-removed"),
        3,
        "no entry is about it: it stands where the formula does"
    );
}

#[test]
fn a_disabled_transition_has_only_enabling_mutants() {
    let mutants =
        of("Liveness:\nr = A ~ || (B . C)\nTransitions:\n*~ -> END : [false]\n(B.C) -> END : [false]\n");
    assert_eq!(descriptions(&mutants, "A~ -> END"), ["guard-negated: the guard `[false]` becomes `[true]`"]);
    assert_eq!(
        descriptions(&mutants, "(B.C) -> END"),
        [
            "guard-negated: the guard `[false]` becomes `[true]`",
            "guard-removed: the guard `[false]` is removed"
        ],
        "without a guard it is taken when what it leaves is complete"
    );
}

#[test]
fn the_order_is_reversed_only_where_it_matters() {
    let role = |one: &str, other: &str| {
        let text =
            format!("Liveness:\nr = A | B\nTransitions:\nCONDITION -> A{one}\nCONDITION -> B{other}\n");
        descriptions(&of(&text), "CONDITION -> A")
            .into_iter()
            .filter(|it| it.starts_with("priority"))
            .collect::<Vec<_>>()
    };
    assert_eq!(role(" : [M.x > 1]", " : [M.x <= 1]"), Vec::<String>::new(), "only one of them can be open");
    let both = ["priority: `CONDITION -> B` is tried before it"];
    assert_eq!(role(" : [M.x > 1]", " : [M.x > 2]"), both);
    assert_eq!(role(" !1 : [M.x > 1]", " : [M.y]"), both);
    let swapped =
        of("Liveness:\nr = A | B\nTransitions:\nCONDITION -> A !4 : [M.x]\nCONDITION -> B !2 : [M.y]\n");
    let swapped = swapped.iter().find(|mutant| mutant.kind == MutationKind::Priority).expect("it is made");
    let priorities: Vec<i32> =
        swapped.chart.transitions().map(|(_, it)| it.priority).filter(|it| *it > 0).collect();
    assert_eq!(priorities, [2, 4]);
}

#[test]
fn entries_and_exits_lose_their_actions() {
    let mutants = of("Liveness:\nr = A\nStates:\nA : entry = StartTimeout(t, 2s), exit = raise(over)\n");
    assert_eq!(descriptions(&mutants, "A entry").len(), 3);
    assert_eq!(descriptions(&mutants, "A exit"), ["action-removed: the action `raise(over)` is removed"]);
}

#[test]
fn a_model_without_a_chart_has_no_mutants() {
    let wrong = mutants(&Source::new("a.srm", "Liveness:\nr = A .\n")).expect_err("it cannot be read");
    assert!(wrong.iter().all(|wrong| wrong.source.is_some()));
}
