//! One of the robots: all that its chart can do, as far as the others can tell.
//!
//! A chart is explored alone, with whatever its guards ask and its triggers wait for free to be. Each step is kept with what has to do with others: the message
//! that it hears, what it asks of messages that it has heard, what it says, and which waiting it ends. States that do the same for the others are one class.

use std::collections::BTreeMap;
use std::sync::Arc;

use yase::explore::{Move, Pending, Seen, Watch, Watched, watch};
use yase::expression::{Expression, ExpressionKind, ScriptId, Trigger};
use yase::statechart::{Constant, ConstantValue};
use yase::{Diagnostic, NodeId, NodeKind, Source, Statechart, Status, TransitionId};

use super::words::{self, Called, Place, Word, actions, called, paths, triggers};
use crate::check::abstraction::Abstraction;
use crate::check::conformance::graph::{Graph, Shows, Way};
use crate::check::subject::Subject;
use crate::check::{Settings, World};
use crate::properties::cone;

/// What a field is set to, as far as that is known.
pub(super) type Setting = (String, Option<String>);

/// What a step of a robot is to the others.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
pub(super) struct Deed {
    /// The message that it hears, by its place among those that the robot hears.
    pub(super) hears: Option<usize>,
    /// Whether nobody in the chart takes what it hears, now or later.
    pub(super) drops: bool,
    /// The conditions on messages of others that it reads, and their values.
    pub(super) asks: Vec<(ScriptId, bool)>,
    /// What it says, by place among what the robot says, with the fields that it sets.
    pub(super) says: Vec<(usize, Vec<Setting>)>,
    /// The waits that it ends.
    pub(super) leaves: Vec<usize>,
}

impl Deed {
    fn is_seen(&self) -> bool {
        *self != Deed::default()
    }
}

/// A message of a robot, another one or itself, that a chart reads or waits for.
#[derive(Clone, Debug)]
pub(super) struct Hearing {
    pub(super) called: Called,
    /// What its arrival is called in triggers, if any waits for it.
    pub(super) event: Option<String>,
    /// A transition that waits for it or reads it.
    pub(super) way: TransitionId,
}

/// A state in which a chart waits for others.
#[derive(Clone, Debug)]
pub(super) struct Wait {
    pub(super) node: NodeId,
    /// What it waits for, by place among what the robot hears.
    pub(super) hearing: usize,
    /// The transition that would end it.
    pub(super) way: TransitionId,
}

/// A message that a chart says.
#[derive(Clone, Debug)]
pub(super) struct Saying {
    pub(super) word: Word,
    /// Wherever it does, one at least.
    pub(super) places: Vec<Place>,
}

/// A robot that is ready to be put beside others.
pub(super) struct Robot {
    pub(super) name: String,
    pub(super) source: Arc<Source>,
    pub(super) subject: Subject,
    pub(super) abstraction: Abstraction,
    pub(super) hearings: Vec<Hearing>,
    pub(super) sayings: Vec<Saying>,
    pub(super) waits: Vec<Wait>,
}

impl Robot {
    /// A robot among others, by their names.
    pub(super) fn new(
        name: &str,
        source: &Arc<Source>,
        (subject, abstraction): (Subject, Abstraction),
        hosts: &[&str],
        world: Option<&World>,
    ) -> Robot {
        let ears = Ears::new(name, hosts, &subject.chart, world);
        let hearings = hearings(&subject.chart, &ears);
        let waits = waits(&subject, &hearings, &ears);
        let sayings = sayings(&subject.chart, world);
        Robot { name: name.into(), source: source.clone(), subject, abstraction, hearings, sayings, waits }
    }

    /// What of the messages is written in more than one way, which would be two events here and is one in a run.
    pub(super) fn ambiguous(&self) -> Option<Diagnostic> {
        let events = || self.hearings.iter().enumerate().filter(|(_, it)| it.event.is_some());
        let twice = events().find(|(index, it)| {
            events().any(|(other, that)| {
                other < *index
                    && that.called.host == it.called.host
                    && that.called.word.means(&it.called.word)
            })
        });
        twice.map(|(_, hearing)| {
            let message = format!("`{}` is waited for under two names", hearing.called.prefix.text());
            let found = Diagnostic::error("E0935", self.subject.places.transition(hearing.way), message);
            found.with_hint("write it the same way in each trigger").in_source(&self.source)
        })
    }

    /// Explores the chart. Of what it says only that counts which others hear.
    pub(super) fn explored(&self, settings: &Settings, heard: &[bool]) -> Behaviour {
        let scripts = self.scripts_on_messages();
        let mut deeds: Vec<Deed> = vec![Deed::default()];
        let mut numbers: BTreeMap<Deed, u64> = BTreeMap::from([(Deed::default(), 0)]);
        let letter = |seen: &Seen<'_>| {
            let deed = self.deed(seen, &scripts, (settings.world.as_ref(), heard));
            *numbers.entry(deed).or_insert_with_key(|deed| {
                deeds.push(deed.clone());
                deeds.len() as u64 - 1
            })
        };
        let mut surroundings = self.abstraction.surroundings();
        surroundings.messages = true;
        let mut asked = Watch { conditions: 0, idle: self.idle(heard), pace: None, letter: Box::new(letter) };
        let found = watch(&self.abstraction.chart, &mut surroundings, &mut asked, settings.states);
        drop((asked, surroundings));
        Behaviour::new(found, deeds, &self.waits)
    }

    /// The regions that neither speak nor listen to others, nor to those that do.
    fn idle(&self, heard: &[bool]) -> Vec<NodeId> {
        let chart = self.abstraction.chart.statechart();
        let said = self.sayings.iter().zip(heard).filter(|(_, heard)| **heard);
        let spoken = said.flat_map(|(saying, _)| &saying.places).map(|place| match *place {
            Place::Way(way) => chart.transition(way).source,
            Place::Node(node) => node,
        });
        let heard = self.hearings.iter().map(|hearing| chart.transition(hearing.way).source);
        let nodes: Vec<NodeId> = spoken.chain(heard).chain(self.waits.iter().map(|wait| wait.node)).collect();
        cone::idle_but(chart, &|region| nodes.iter().any(|&node| cone::is_within(chart, node, region)))
    }

    /// The conditions of the exploration that read a message of another.
    fn scripts_on_messages(&self) -> Vec<bool> {
        let reads = |condition: &Expression| {
            paths(condition)
                .into_iter()
                .any(|path| self.hearings.iter().any(|it| begins_with(path, &it.called.prefix)))
        };
        self.abstraction.conditions.iter().map(|condition| condition.as_ref().is_some_and(reads)).collect()
    }

    fn deed(&self, seen: &Seen<'_>, scripts: &[bool], said: (Option<&World>, &[bool])) -> Deed {
        let hears = match seen.cause {
            Move::Event(name) => self.hearings.iter().position(|it| it.event.as_ref() == Some(name)),
            _ => None,
        };
        let event = hears
            .and_then(|hearing| self.abstraction.chart.events().find(self.hearings[hearing].event.as_ref()?));
        let mut asks: Vec<(ScriptId, bool)> = seen
            .decisions
            .iter()
            .copied()
            .filter(|(script, _)| scripts.get(script.0 as usize) == Some(&true))
            .collect();
        asks.sort_unstable();
        asks.dedup();
        let leaves = (0..self.waits.len()).filter(|&wait| seen.left.contains(&self.waits[wait].node));
        Deed {
            hears,
            drops: event.is_some_and(|event| seen.dropped.contains(&event)),
            asks,
            says: self.says(seen, said),
            leaves: leaves.collect(),
        }
    }

    /// What is published at the end of a step: what its actions have written, and what an activity says that has returned.
    fn says(&self, seen: &Seen<'_>, (world, heard): (Option<&World>, &[bool])) -> Vec<(usize, Vec<Setting>)> {
        let chart = &self.subject.chart;
        let of_exits = seen.left.iter().flat_map(|&node| &chart.node(node).exit);
        let of_ways = seen.taken.iter().flat_map(|&way| &chart.transition(way).expression.actions);
        let of_entries = seen.entered.iter().flat_map(|&node| &chart.node(node).entry);
        let mut says: BTreeMap<usize, BTreeMap<String, Option<String>>> = BTreeMap::new();
        for (word, setting) in
            of_exits.chain(of_ways).chain(of_entries).filter_map(|it| words::said(it, world))
        {
            let Some(saying) = self.saying(&word) else { continue };
            let fields = says.entry(saying).or_default();
            fields.extend(setting.map(|(field, value)| (field, literal(&value, &chart.constants))));
        }
        let returned = match seen.cause {
            Move::Return(node) => chart.node(*node).activity.as_deref(),
            _ => None,
        };
        let by_activity = returned.map(|activity| words::said_by(activity, world)).unwrap_or_default();
        for saying in by_activity.iter().filter_map(|word| self.saying(word)) {
            // of what an activity writes nothing is known but that it comes
            says.entry(saying).or_default().insert(String::new(), None);
        }
        says.retain(|&saying, _| heard.get(saying) == Some(&true));
        says.into_iter().map(|(saying, fields)| (saying, fields.into_iter().collect())).collect()
    }

    fn saying(&self, word: &Word) -> Option<usize> {
        self.sayings.iter().position(|it| it.word == *word)
    }
}

/// Whether a path begins with another.
pub(super) fn begins_with(path: &yase::expression::Path, prefix: &yase::expression::Path) -> bool {
    path.segments.len() >= prefix.segments.len()
        && path.segments.iter().zip(&prefix.segments).all(|(one, other)| one.text == other.text)
}

/// A value that does not hang on anything, as text.
fn literal(value: &Expression, constants: &[Constant]) -> Option<String> {
    match &value.kind {
        ExpressionKind::Bool(_)
        | ExpressionKind::Integer(_)
        | ExpressionKind::Decimal(_)
        | ExpressionKind::Text(_) => Some(value.to_string()),
        ExpressionKind::Negative(inner) => literal(inner, constants).map(|inner| format!("-{inner}")),
        ExpressionKind::Variable(path) => {
            let name = path.bare()?;
            let constant = constants.iter().find(|constant| constant.name == name).map(|it| &it.value);
            Some(match constant {
                None => name.to_owned(),
                Some(ConstantValue::Bool(value)) => value.to_string(),
                Some(ConstantValue::Number(value)) => value.to_string(),
                Some(ConstantValue::Text(value)) => format!("{value:?}"),
            })
        }
        _ => None,
    }
}

/// What a chart's paths may be about: messages of robots, itself among them.
struct Ears<'a> {
    own: &'a str,
    hosts: &'a [&'a str],
    /// What its actions say.
    said: Vec<Word>,
    world: Option<&'a World>,
}

impl<'a> Ears<'a> {
    fn new(own: &'a str, hosts: &'a [&'a str], chart: &Statechart, world: Option<&'a World>) -> Ears<'a> {
        let said = actions(chart).filter_map(|(_, action)| words::said(action, world).map(|(word, _)| word));
        Ears { own, hosts, said: said.collect(), world }
    }

    /// The message that a condition reads. Its own are what has been read before, whatever it is.
    fn read(&self, path: &yase::expression::Path) -> Option<Called> {
        called(path, self.hosts.iter().copied(), self.world)
    }

    /// The message that a trigger waits for: also one that the chart says to itself, without a name in front.
    fn waited(&self, path: &yase::expression::Path) -> Option<Called> {
        let own = || {
            let called = words::own(path, self.own, self.world)?;
            self.said.iter().any(|said| said.means(&called.word)).then_some(called)
        };
        self.read(path).or_else(own)
    }
}

fn hearings(chart: &Statechart, ears: &Ears<'_>) -> Vec<Hearing> {
    let mut found: Vec<Hearing> = Vec::new();
    for (way, transition) in chart.transitions() {
        let waited = triggers(transition).iter().map(|path| (ears.waited(path), Some(path.text())));
        let read = transition.expression.guard.iter().flat_map(paths).map(|path| (ears.read(path), None));
        for (called, event) in waited.chain(read) {
            let Some(called) = called else { continue };
            match found.iter_mut().find(|it| it.called.prefix == called.prefix) {
                Some(known) if known.event.is_none() => (known.event, known.way) = (event, way),
                Some(_) => {}
                None => found.push(Hearing { called, event, way }),
            }
        }
    }
    found
}

fn sayings(chart: &Statechart, world: Option<&World>) -> Vec<Saying> {
    let mut found: Vec<Saying> = Vec::new();
    let by_actions = actions(chart)
        .filter_map(|(place, action)| words::said(action, world).map(|(word, _)| (place, word)));
    let by_activities = chart.nodes().flat_map(|(id, node)| {
        let said = node.activity.iter().flat_map(|activity| words::said_by(activity, world));
        said.map(move |word| (Place::Node(id), word)).collect::<Vec<_>>()
    });
    for (place, word) in by_actions.chain(by_activities) {
        match found.iter_mut().find(|it| it.word == word) {
            Some(known) => known.places.push(place),
            None => found.push(Saying { word, places: vec![place] }),
        }
    }
    found
}

/// The places where a chart rests until something of another comes: states that have nothing else to do, and the end of composites that go on then.
fn waits(subject: &Subject, hearings: &[Hearing], ears: &Ears<'_>) -> Vec<Wait> {
    let mut found: Vec<Wait> = Vec::new();
    for (way, transition) in subject.chart.transitions() {
        let waited = triggers(transition).iter().filter_map(|path| ears.waited(path));
        let read = transition.expression.guard.iter().flat_map(paths).filter_map(|path| ears.read(path));
        let named = waited.chain(read).next();
        let heard = named.and_then(|called| hearings.iter().position(|it| it.called.prefix == called.prefix));
        let Some(hearing) = heard else { continue };
        for node in resting(subject, transition.source) {
            if !found.iter().any(|wait| wait.node == node) {
                found.push(Wait { node, hearing, way });
            }
        }
    }
    found
}

/// Where a chart rests when it is about to leave a node: connectors lie between.
fn resting(subject: &Subject, node: NodeId) -> Vec<NodeId> {
    let (mut found, mut open, mut seen) = (Vec::new(), vec![node], Vec::new());
    while let Some(node) = open.pop() {
        if seen.contains(&node) {
            continue;
        }
        seen.push(node);
        match subject.kind(node) {
            NodeKind::Basic | NodeKind::Start => found.push(node),
            NodeKind::Or => {
                let inside = subject.chart.children(node).iter().copied();
                found.extend(inside.filter(|&inner| subject.kind(inner) == NodeKind::End));
            }
            NodeKind::And | NodeKind::End => {}
            _ => open.extend(subject.incoming(node).iter().map(|&way| subject.transition(way).source)),
        }
    }
    found
}

/// Whether a chart has triggers that take whatever comes.
pub(super) fn takes_whatever(chart: &Statechart) -> Option<TransitionId> {
    let takes = |trigger: &Trigger| matches!(trigger, Trigger::Any | Trigger::Not(_));
    chart.transitions().find(|(_, it)| it.expression.trigger.as_ref().is_some_and(takes)).map(|(id, _)| id)
}

/// What a robot does, in classes of states that are the same to the others. The last state of the graph is that before the start.
pub(super) struct Behaviour {
    pub(super) found: Watched,
    pub(super) deeds: Vec<Deed>,
    /// All states.
    full: Graph,
    /// The class of each state.
    classes: Vec<usize>,
    /// Classes and the ways between them.
    pub(super) graph: Graph,
    /// The waits that go on in each class.
    pub(super) waiting: Vec<Vec<usize>>,
    /// The waits of each class that could end if others said whatever it takes.
    pub(super) may_end: Vec<Vec<bool>>,
}

impl Behaviour {
    fn new(found: Watched, deeds: Vec<Deed>, waits: &[Wait]) -> Behaviour {
        let begin = found.states().len();
        let mut full = Graph { initial: vec![begin], ends: Vec::new(), ways: vec![Vec::new(); begin + 1] };
        full.ends = found.states().iter().map(|it| it.status != Status::Running).chain([false]).collect();
        for (edge, step) in found.steps().iter().enumerate() {
            let deed = &deeds[step.letter as usize];
            let shows = if deed.is_seen() { Shows::Letter(step.letter as u32) } else { Shows::Nothing };
            let from = step.from.unwrap_or(begin);
            if from != step.to || deed.hears.is_some() || !deed.says.is_empty() || !deed.leaves.is_empty() {
                full.ways[from].push(Way { shows, to: step.to, edge });
            }
        }
        let waiting_in = |state: &yase::explore::WatchedState| -> Vec<usize> {
            let rests = |wait: &usize| {
                let node = waits[*wait].node;
                state.configuration.contains(&node) && !state.pending.contains(&Pending::Return(node))
            };
            (0..waits.len()).filter(rests).collect()
        };
        let waiting: Vec<Vec<usize>> = found.states().iter().map(waiting_in).chain([Vec::new()]).collect();
        let classes = first_classes(&full, &waiting, begin);
        let (classes, count) = full.classes(classes).unwrap_or_else(|| ((0..=begin).collect(), begin + 1));
        let graph = full.of_classes(&classes, count);
        let mut by_class = vec![Vec::new(); count];
        for (state, &class) in classes.iter().enumerate() {
            by_class[class].clone_from(&waiting[state]);
        }
        let may_end = (0..waits.len()).map(|wait| ends_somewhere(&graph, &deeds, wait)).collect();
        Behaviour { found, deeds, full, classes, graph, waiting: by_class, may_end }
    }

    /// The class before the start.
    pub(super) fn begin(&self) -> usize {
        self.graph.initial.first().copied().unwrap_or(0)
    }

    /// Whether the chart has not been started.
    pub(super) fn is_begin(&self, class: usize) -> bool {
        class == self.begin()
    }

    /// The deed of a way.
    pub(super) fn deed(&self, way: &Way) -> &Deed {
        match way.shows {
            Shows::Letter(letter) => &self.deeds[letter as usize],
            Shows::Nothing | Shows::Other => &self.deeds[0],
        }
    }

    /// The steps by which a state goes a way of its class, and where they lead.
    pub(super) fn steps(&self, state: usize, shows: Shows, to: usize) -> (Vec<usize>, usize) {
        let class = self.classes[state];
        let mut came: BTreeMap<usize, Option<(usize, usize)>> = BTreeMap::from([(state, None)]);
        let mut open = std::collections::VecDeque::from([state]);
        while let Some(at) = open.pop_front() {
            let fits = |way: &&Way| way.shows == shows && self.classes[way.to] == to;
            if let Some(last) = self.full.ways[at].iter().find(fits) {
                let mut steps = vec![last.edge];
                let mut back = at;
                while let Some(Some((before, edge))) = came.get(&back) {
                    steps.push(*edge);
                    back = *before;
                }
                steps.reverse();
                return (steps, last.to);
            }
            for way in self.full.ways[at].iter().filter(|way| way.shows == Shows::Nothing) {
                if self.classes[way.to] == class && !came.contains_key(&way.to) {
                    came.insert(way.to, Some((at, way.edge)));
                    open.push_back(way.to);
                }
            }
        }
        (Vec::new(), state)
    }

    /// The state before the start.
    pub(super) fn first_state(&self) -> usize {
        self.found.states().len()
    }
}

/// States are told apart to begin with by whether the chart has ended, and by what it waits for.
fn first_classes(full: &Graph, waiting: &[Vec<usize>], begin: usize) -> Vec<usize> {
    let mut numbers = BTreeMap::new();
    let key = |state: usize| (state == begin, full.ends[state], waiting[state].clone());
    (0..=begin)
        .map(|state| {
            let number = numbers.len();
            *numbers.entry(key(state)).or_insert(number)
        })
        .collect()
}

/// From which classes a wait can come to its end, by some way or other.
fn ends_somewhere(graph: &Graph, deeds: &[Deed], wait: usize) -> Vec<bool> {
    let ends = |way: &Way| match way.shows {
        Shows::Letter(letter) => deeds[letter as usize].leaves.contains(&wait),
        Shows::Nothing | Shows::Other => false,
    };
    let mut before = vec![Vec::new(); graph.ways.len()];
    let mut open = Vec::new();
    for (from, ways) in graph.ways.iter().enumerate() {
        ways.iter().for_each(|way| before[way.to].push(from));
        open.extend(ways.iter().any(ends).then_some(from));
    }
    let mut reaches = vec![false; graph.ways.len()];
    while let Some(class) = open.pop() {
        if !std::mem::replace(&mut reaches[class], true) {
            open.extend(before[class].iter().copied());
        }
    }
    reaches
}
