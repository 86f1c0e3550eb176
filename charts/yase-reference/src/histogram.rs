//! Coverage of played cases: how many contain each element of charts, log line and semantics.

mod parsed_line;

use std::collections::BTreeMap;

use yase::expression::Trigger;
use yase::statechart::{NodeId, NodeKind, Statechart, Transition};

use crate::random::{Case, POINTS, Variant, differs_somewhere, has};
use parsed_line::{Line, lines};

/// The number of played charts in which each row occurred.
#[derive(Clone, Default)]
pub struct Histogram {
    rows: BTreeMap<String, u64>,
}

const KINDS: [NodeKind; 15] = [
    NodeKind::Or,
    NodeKind::And,
    NodeKind::Basic,
    NodeKind::End,
    NodeKind::Start,
    NodeKind::Condition,
    NodeKind::Junction,
    NodeKind::Choice,
    NodeKind::Fork,
    NodeKind::Join,
    NodeKind::ShallowHistory,
    NodeKind::DeepHistory,
    NodeKind::Terminate,
    NodeKind::EntryPoint,
    NodeKind::ExitPoint,
];

impl Histogram {
    fn add(&mut self, row: impl Into<String>, occurred: bool) {
        *self.rows.entry(row.into()).or_insert(0) += u64::from(occurred);
    }

    /// Adds the counts of another.
    pub fn join(&mut self, other: &Histogram) {
        for (row, count) in &other.rows {
            *self.rows.entry(row.clone()).or_insert(0) += count;
        }
    }

    pub(crate) fn count(&mut self, case: &Case, log: &[String]) {
        let nodes = case.chart.nodes().map(|(id, _)| (short_path(&case.chart, id), id)).collect();
        let seen = Seen { case, chart: &case.chart, log, lines: lines(log), nodes };
        self.count_chart(&seen);
        self.count_reading(case);
        for (row, occurred) in DERIVED_ROWS {
            self.add(row, occurred(&seen));
        }
    }

    fn count_chart(&mut self, seen: &Seen<'_>) {
        let chart = seen.chart;
        for kind in KINDS {
            let nodes = chart.nodes().skip(1).any(|(_, node)| node.kind == kind);
            self.add(format!("node {kind:?}"), nodes);
        }
        let depth = |kind: NodeKind| chart.nodes().map(|(id, _)| depth(chart, id, kind)).max().unwrap_or(0);
        self.add("depth OR 2", depth(NodeKind::Or) >= 3);
        self.add("depth OR 3", depth(NodeKind::Or) >= 4);
        self.add("depth AND 2", depth(NodeKind::And) >= 2);
        self.add("depth AND 3", depth(NodeKind::And) >= 3);
        let in_and = |kind: NodeKind| {
            chart.nodes().any(|(_, node)| {
                node.kind == kind
                    && node.parent.is_some_and(|parent| chart.node(parent).kind == NodeKind::And)
            })
        };
        for kind in [
            NodeKind::Basic,
            NodeKind::And,
            NodeKind::ShallowHistory,
            NodeKind::DeepHistory,
            NodeKind::EntryPoint,
            NodeKind::ExitPoint,
        ] {
            self.add(format!("within AND {kind:?}"), in_and(kind));
        }
    }

    fn count_reading(&mut self, case: &Case) {
        for profile in ["yase", "uml", "scxml"] {
            self.add(format!("profile {profile}"), case.variant == Variant::Profile(profile));
        }
        for (index, (name, _)) in POINTS.iter().enumerate() {
            self.add(format!("value {name}"), has(case.semantics, index));
        }
        for (index, (name, _)) in POINTS.iter().enumerate().filter(|(index, _)| differs_somewhere(*index)) {
            let alone = matches!(case.variant, Variant::Flipped(_, flipped) if flipped == index);
            self.add(format!("point {name}"), alone);
        }
        self.add("points mixed", case.variant == Variant::Mixed);
        self.add("chooser declared", matches!(case.policy, crate::chooser::ChoicePolicy::Declared));
        self.add("chooser seeded", matches!(case.policy, crate::chooser::ChoicePolicy::Seeded(_)));
        self.add("chooser scripted", matches!(case.policy, crate::chooser::ChoicePolicy::Scripted(_)));
    }

    /// The counts, one row per line.
    pub fn text(&self) -> String {
        let lines: Vec<String> = self.rows.iter().map(|(row, count)| format!("{count:8} {row}")).collect();
        lines.join("\n")
    }

    /// The rows that never occurred.
    pub fn missing(&self) -> Vec<&String> {
        self.rows.iter().filter(|(_, count)| **count == 0).map(|(row, _)| row).collect()
    }

    /// The number of charts that were played.
    pub fn played(&self) -> u64 {
        ["declared", "seeded", "scripted"].iter().map(|name| self.row(&format!("chooser {name}"))).sum()
    }

    /// The number of charts in which a row occurred.
    pub fn row(&self, row: &str) -> u64 {
        self.rows.get(row).copied().unwrap_or(0)
    }
}

/// The number of nodes of a kind among a node and its ancestors.
fn depth(chart: &Statechart, node: NodeId, kind: NodeKind) -> usize {
    std::iter::once(node).chain(chart.ancestors(node)).filter(|&node| chart.node(node).kind == kind).count()
}

/// A played case and its log.
struct Seen<'a> {
    case: &'a Case,
    chart: &'a Statechart,
    log: &'a [String],
    lines: Vec<Line<'a>>,
    nodes: BTreeMap<String, NodeId>,
}

fn short_path(chart: &Statechart, node: NodeId) -> String {
    let path = chart.path(node);
    path.split_once('/').map_or(path.clone(), |(_, rest)| rest.to_owned())
}

impl Seen<'_> {
    fn says(&self, part: &str) -> bool {
        self.log.iter().any(|line| line.contains(part))
    }

    fn kind(&self, name: &str) -> Option<NodeKind> {
        self.node(name).map(|node| self.chart.node(node).kind)
    }

    fn node(&self, name: &str) -> Option<NodeId> {
        self.nodes.get(name).copied()
    }

    /// The first segments of the transitions in a line, if their sources and targets identify them.
    fn fired<'s>(&'s self, line: &'s Line<'_>) -> impl Iterator<Item = &'s Transition> {
        line.selected.iter().flat_map(move |compound| {
            let mut ends = compound.split(" -> ").map(|name| name.split(" + ").next().unwrap_or(name));
            let (source, target) = (ends.next().unwrap_or_default(), ends.next().unwrap_or_default());
            let found = (self.node(source), self.node(target));
            let all = self.chart.transitions().map(|(_, transition)| transition);
            all.filter(move |it| (Some(it.source), Some(it.target)) == found)
        })
    }

    fn any_fired(&self, wanted: impl Fn(&Transition, &Line<'_>) -> bool) -> bool {
        self.lines.iter().any(|line| self.fired(line).any(|transition| wanted(transition, line)))
    }

    fn any_selected_through(&self, kinds: &[NodeKind]) -> bool {
        let through = |compound: &str| {
            compound.split([' ']).any(|name| self.kind(name).is_some_and(|kind| kinds.contains(&kind)))
        };
        self.lines.iter().any(|line| line.selected.iter().any(|compound| through(compound)))
    }

    fn any_taken_from(&self, kinds: &[NodeKind]) -> bool {
        let from = |line: &Line<'_>| {
            line.taken.split([' ']).any(|name| self.kind(name).is_some_and(|kind| kinds.contains(&kind)))
        };
        self.lines.iter().any(from)
    }

    fn any_exit(&self, wanted: impl Fn(&Line<'_>, NodeId) -> bool) -> bool {
        self.lines
            .iter()
            .any(|line| line.exits.iter().filter_map(|name| self.node(name)).any(|node| wanted(line, node)))
    }

    fn is_inside(&self, node: NodeId, outer: NodeId) -> bool {
        self.chart.ancestors(node).any(|above| above == outer)
    }

    fn in_sibling_regions(&self, a: NodeId, b: NodeId) -> bool {
        let common = self.chart.ancestors(a).find(|&above| above == b || self.is_inside(b, above));
        common.is_some_and(|common| self.chart.node(common).kind == NodeKind::And && common != b)
            && !self.is_inside(b, a)
    }
}

type Row = (&'static str, fn(&Seen<'_>) -> bool);

/// Rows derived from lines, or from chart and lines together.
const DERIVED_ROWS: [Row; 88] = [
    ("R1 a chart rests at START", |it| it.says("  waits at")),
    ("R2 an AND is left from inside", |it| {
        it.any_exit(|line, node| {
            it.chart.node(node).kind == NodeKind::And
                && it.fired(line).any(|transition| it.is_inside(transition.source, node))
        })
    }),
    ("R2 from one region into another", |it| {
        it.any_fired(|transition, _| it.in_sibling_regions(transition.source, transition.target))
    }),
    ("R2 internal", |it| it.any_fired(|it, _| it.internal && it.source == it.target)),
    ("R2 local", |it| it.any_fired(|it, _| it.internal && it.source != it.target)),
    ("R2 external to itself", |it| it.any_fired(|it, _| !it.internal && it.source == it.target)),
    ("R3 a higher priority is taken", |it| it.any_fired(|it, _| it.priority > 0)),
    ("R3 a lower priority is taken", |it| it.any_fired(|it, _| it.priority < 0)),
    ("R3 guarded before else", |it| {
        it.any_fired(|a, _| {
            a.expression.guard.is_some()
                && it.chart.transitions().any(|(_, b)| b.source == a.source && b.expression.guard.is_none())
        })
    }),
    ("R4 one event", |it| {
        triggered(it, |trigger| matches!(trigger, Trigger::OneOf(names) if names.len() == 1))
    }),
    ("R4 one of two events", |it| {
        triggered(it, |trigger| matches!(trigger, Trigger::OneOf(names) if names.len() > 1))
    }),
    ("R4 not an event", |it| triggered(it, |trigger| matches!(trigger, Trigger::Not(_)))),
    ("R4 any event", |it| triggered(it, |trigger| matches!(trigger, Trigger::Any))),
    ("R4 a message", |it| it.lines.iter().any(|line| line.event == "a" && !line.selected.is_empty())),
    ("R4 an event of more tokens", |it| {
        it.lines.iter().any(|line| line.event.starts_with("e.") && !line.selected.is_empty())
    }),
    ("R4 an event of no known name", |it| it.lines.iter().any(|line| line.event == "?")),
    ("R5 a guard is false", |it| it.says(" = false")),
    ("R5 a guard errs", |it| it.says("  guard failed")),
    ("R5 an error event is taken", |it| {
        it.lines.iter().any(|line| line.event.starts_with("error") && !line.selected.is_empty())
    }),
    ("R6 through CONDITION", |it| it.any_selected_through(&[NodeKind::Condition])),
    ("R6 through JUNCTION", |it| it.any_selected_through(&[NodeKind::Junction])),
    ("R6 through an ENTRY point", |it| it.any_selected_through(&[NodeKind::EntryPoint])),
    ("R6 through an EXIT point", |it| it.any_selected_through(&[NodeKind::ExitPoint])),
    ("R7 inner first", |it| {
        it.any_fired(|inner, line| {
            let outer = |it: &Transition| names(it, line.event);
            it.chart.transitions().any(|(_, other)| it.is_inside(inner.source, other.source) && outer(other))
        })
    }),
    ("R7 both in one micro-step", |it| it.lines.iter().any(|line| line.selected.len() > 1)),
    ("R8 preempted", |it| it.lines.iter().any(|line| !line.preempted.is_empty())),
    ("R9 held", |it| {
        it.lines.iter().any(|line| !line.event.is_empty() && line.event != "-" && !line.held.is_empty())
    }),
    ("R9 interrupts", |it| it.any_fired(|it, _| it.interrupts)),
    ("R9 cancelled", |it| it.says("  cancel ")),
    ("R10 exits, effects and entries", |it| {
        it.lines.iter().any(|line| !line.exits.is_empty() && line.effects && !line.entries.is_empty())
    }),
    ("R10 an exit action", |it| it.says("(exit ")),
    ("R10 an entry action", |it| it.says("(entry ")),
    ("R10 shallow history", |it| it.any_selected_through(&[NodeKind::ShallowHistory])),
    ("R10 deep history", |it| it.any_selected_through(&[NodeKind::DeepHistory])),
    ("R10 history by default", |it| it.any_taken_from(&[NodeKind::ShallowHistory, NodeKind::DeepHistory])),
    ("R10 START in the same step", |it| it.any_taken_from(&[NodeKind::Start])),
    ("R11 a guard of START is read", |it| {
        it.lines.iter().any(|line| line.reads.iter().any(|read| read.contains("START -> ")))
    }),
    ("R12 CHOICE", |it| it.any_taken_from(&[NodeKind::Choice])),
    ("R12 no branch", |it| it.says("error: ") && !it.says("error: endless")),
    ("R12 FORK", |it| it.any_selected_through(&[NodeKind::Fork])),
    ("R12 JOIN together", |it| {
        it.case.semantics.join == yase::JoinMode::Together && it.any_selected_through(&[NodeKind::Join])
    }),
    ("R12 JOIN together of a composite", |it| {
        it.case.semantics.join == yase::JoinMode::Together
            && it.any_fired(|transition, _| {
                it.chart.node(transition.target).kind == NodeKind::Join
                    && it.chart.node(transition.source).kind != NodeKind::Basic
            })
    }),
    ("R12 JOIN, each", |it| {
        it.case.semantics.join == yase::JoinMode::Each && it.any_selected_through(&[NodeKind::Join])
    }),
    ("R12 JOIN, all have arrived", |it| {
        let is_join = |name: &&str| it.kind(name) == Some(NodeKind::Join);
        it.case.semantics.join == yase::JoinMode::Each
            && selected(it, |_, names| names.iter().rev().skip(1).any(is_join))
    }),
    ("R13 TERMINATE behind CHOICE or START", |it| {
        it.lines
            .iter()
            .any(|line| line.taken.split(' ').any(|name| it.kind(name) == Some(NodeKind::Terminate)))
    }),
    ("R13 TERMINATE beside another transition", |it| {
        it.lines.iter().any(|line| {
            let stops =
                |compound: &&&str| compound.split(' ').any(|name| it.kind(name) == Some(NodeKind::Terminate));
            line.selected.len() > 1 && line.selected.iter().any(|compound| stops(&compound))
        })
    }),
    ("R13 TERMINATE", |it| it.any_selected_through(&[NodeKind::Terminate])),
    ("R13 END of the root", |it| {
        it.lines.iter().any(|line| {
            let end = |name: &&str| !name.contains('/') && it.kind(name) == Some(NodeKind::End);
            line.entries.iter().any(end)
        })
    }),
    ("R14 an AND has completed", |it| completed(it, NodeKind::And)),
    ("R14 an OR has completed", |it| completed(it, NodeKind::Or)),
    ("R14 a BASIC state has completed", |it| completed(it, NodeKind::Basic)),
    ("R15 a composite is left by a guard", |it| {
        it.any_fired(|transition, line| {
            line.event == "-"
                && transition.expression.guard.is_some()
                && it.chart.node(transition.source).kind != NodeKind::Basic
                && it.chart.node(transition.source).kind != NodeKind::Start
        })
    }),
    ("R16 raised", |it| it.says("raise(")),
    ("R16 dropped", |it| it.says(": dropped")),
    ("R16 deferred", |it| it.says("; defer in")),
    ("R16 done.state", |it| it.lines.iter().any(|line| line.event.starts_with("done.state"))),
    ("R17 endless", |it| it.says("error: endless")),
    ("R17 comes to rest", |it| !it.says("error: ")),
    ("R18 a message wakes a guard", |it| {
        it.case.script.inputs.iter().any(|(time, input)| {
            let now = yase::Timestamp::from_millis(*time).to_string();
            matches!(input, crate::script::Input::Message(..))
                && it.lines.iter().any(|line| line.event == "-" && now.strip_suffix(" s") == Some(line.time))
        })
    }),
    ("R19 a region inherits", |it| it.says("  inherit ")),
    ("R19 delivered to a region", |it| it.says("  deliver 1")),
    ("R19 published", |it| it.says("  publish ")),
    ("R19 an assignment fails", |it| it.says("  action failed")),
    ("R19 process_messages", |it| it.says("process_messages")),
    ("R20 an activity starts", |it| it.says("  start ")),
    ("R20 takes its time", |it| {
        it.chart.nodes().any(|(_, node)| node.duration.is_some_and(|time| !time.is_zero()))
    }),
    ("R20 done", |it| it.says("returns Done")),
    ("R20 ongoing", |it| it.says("returns Ongoing")),
    ("R20 failed", |it| it.says("returns Failed")),
    ("R20 stopped", |it| it.says("  stop ")),
    ("R21 an expiry is taken", |it| {
        it.lines.iter().any(|line| line.event.starts_with('v') && !line.selected.is_empty())
    }),
    ("R21 a timer in a guard", |it| {
        it.chart.transitions().any(|(_, it)| it.expression.to_string().contains("[v"))
    }),
    ("R21 TimeoutCheck", |it| {
        it.chart.transitions().any(|(_, it)| it.expression.to_string().contains("TimeoutCheck"))
    }),
    ("R22 asked", |it| it.log.last().is_some_and(|last| last != "asked []")),
    ("R22 not the first option", |it| it.log.last().is_some_and(|last| last.contains("(1,"))),
    ("R22 a weighted segment behind a connector", |it| {
        let weighted = |from: &str, to: &str| {
            let ends = (it.node(from), it.node(to));
            it.chart.transitions().any(|(_, segment)| {
                segment.weight.is_some() && (Some(segment.source), Some(segment.target)) == ends
            })
        };
        it.lines.iter().flat_map(|line| &line.selected).any(|compound| {
            let names: Vec<&str> = compound.split(" -> ").collect();
            names.windows(2).skip(1).any(|pair| weighted(pair[0], pair[1]))
        })
    }),
    ("R22 a weighted transition", |it| it.any_fired(|it, _| it.weight.is_some())),
    ("R23 more than twenty lines", |it| it.lines.len() > 20),
    ("R24 two activities start in one step", |it| {
        it.log.windows(2).any(|pair| pair.iter().all(|line| line.starts_with("  start ")))
    }),
    ("R25 segments through a point", |it| {
        it.case.semantics.firing == yase::Firing::EachSegment
            && it.any_selected_through(&[NodeKind::EntryPoint, NodeKind::ExitPoint])
    }),
    ("R25 a region arrives at an exit point", |it| {
        selected(it, |it, names| names.last().is_some_and(|name| it.kind(name) == Some(NodeKind::ExitPoint)))
    }),
    ("R25 all regions have arrived at an exit point", |it| {
        let all = it.case.semantics.exit_points == yase::ExitPointArrival::All;
        all && selected(it, |it, names| {
            let point = names.iter().find(|name| it.kind(name) == Some(NodeKind::ExitPoint));
            let owner = point.and_then(|name| it.chart.node(it.node(name)?).parent);
            let is_and = owner.is_some_and(|owner| it.chart.node(owner).kind == NodeKind::And);
            is_and && names.last() != point
        })
    }),
    ("R26 deferred against transitions", |it| {
        it.case.semantics.deferral == yase::Deferral::Innermost && it.says("; defer in")
    }),
    ("R27 TERMINATE exits its source", |it| {
        let stops = |name: &&str| it.kind(name) == Some(NodeKind::Terminate);
        it.case.semantics.terminate == yase::TerminateExit::Source
            && it.lines.iter().any(|line| {
                let mut names = line.selected.iter().flat_map(|compound| compound.split(" -> "));
                !line.exits.is_empty() && names.any(|name| stops(&name))
            })
    }),
    ("UML an entry point that leads nowhere", |it| {
        it.case.semantics.structure == yase::StructureRules::Uml
            && selected(it, |it, names| {
                names.last().is_some_and(|name| it.kind(name) == Some(NodeKind::EntryPoint))
            })
    }),
    ("UML a composite without START", |it| {
        let lacks = |node: NodeId| {
            let mut inside = it.chart.children(node).iter().map(|&child| it.chart.node(child).kind);
            it.chart.node(node).kind == NodeKind::Or && inside.all(|kind| kind != NodeKind::Start)
        };
        it.lines.iter().any(|line| line.entries.iter().filter_map(|name| it.node(name)).any(lacks))
    }),
    ("UML an activity of a composite", |it| {
        let is_composite = |name: &str| {
            let mut nodes = it.chart.nodes().map(|(_, node)| node);
            nodes.any(|node| node.activity.as_deref() == Some(name) && node.kind != NodeKind::Basic)
        };
        it.log.iter().filter_map(|line| line.strip_prefix("  start ")).any(is_composite)
    }),
    ("UML from a composite to its exit point", |it| {
        it.any_fired(|transition, _| {
            let target = it.chart.node(transition.target);
            target.kind == NodeKind::ExitPoint && target.parent == Some(transition.source)
        })
    }),
];

/// Whether a selected transition matches the names of the nodes on its path.
fn selected(seen: &Seen<'_>, fits: impl Fn(&Seen<'_>, &[&str]) -> bool) -> bool {
    let compounds = seen.lines.iter().flat_map(|line| &line.selected);
    compounds.map(|compound| compound.split(" -> ").collect::<Vec<_>>()).any(|names| fits(seen, &names))
}

fn names(transition: &Transition, event: &str) -> bool {
    match &transition.expression.trigger {
        Some(Trigger::OneOf(names)) => names.iter().any(|name| name.text() == event),
        _ => false,
    }
}

fn triggered(seen: &Seen<'_>, wanted: impl Fn(&Trigger) -> bool) -> bool {
    seen.any_fired(|transition, line| {
        line.event != "-" && transition.expression.trigger.as_ref().is_some_and(&wanted)
    })
}

fn completed(seen: &Seen<'_>, kind: NodeKind) -> bool {
    seen.any_fired(|transition, line| {
        let expression = &transition.expression;
        line.event == "-"
            && expression.trigger.is_none()
            && expression.guard.is_none()
            && seen.chart.node(transition.source).kind == kind
    })
}
