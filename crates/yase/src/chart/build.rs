//! From a statechart to a chart.

use std::collections::{BTreeMap, BTreeSet};

use crate::bits::BitSet;
use crate::chart::ways::{self, Way};
use crate::chart::{
    Branch, Branches, Chart, Compound, CompoundId, Condition, ErrorEvents, Layout, Masks, Place, Region,
    RegionId, ScopedGuard, State, Timer, Trigger, events, scripts,
};
use crate::diagnostic::Diagnostic;
use crate::expression::{
    CompiledTransition, CompiledTrigger, Effect, EventId, EventTable, MessageSource, Names, Origin,
    ScriptTable, compile_actions, started_timers,
};
use crate::semantics::{FailureEvents, Semantics};
use crate::statechart::{NodeId, NodeKind, Statechart, TransitionId};
use crate::vocabulary::{TopicId, Vocabulary};

/// Checks a statechart and makes it ready to run.
pub(super) fn build(
    chart: &Statechart,
    vocabulary: &Vocabulary,
    semantics: Semantics,
) -> Result<Chart, Vec<Diagnostic>> {
    let mut found = chart.check();
    found.retain(Diagnostic::is_error);
    if !found.is_empty() {
        return Err(found);
    }
    let layout = Layout::new(chart);
    let (region_of, regions) = regions(chart, &layout);
    let ways = ways::find(chart, &layout, &region_of)?;
    let timers = timer_names(chart, &ways, &region_of, regions.len());
    Builder::new(chart, vocabulary, semantics, layout, region_of, timers).finish(ways, regions)
}

/// The blackboard of each node, and the blackboards in the order of the document.
fn regions(chart: &Statechart, layout: &Layout) -> (Vec<RegionId>, Vec<Region>) {
    let mut nodes: Vec<NodeId> = chart.nodes().map(|(id, _)| id).collect();
    nodes.sort_by_key(|&node| layout.rank(layout.place_of(node)));
    let mut region_of = vec![RegionId::ROOT; nodes.len()];
    let mut regions = vec![Region { root: layout.root(), parent: None, timers: 0 }];
    for node in nodes {
        let Some(parent) = chart.node(node).parent else { continue };
        let around = region_of[parent.0 as usize];
        region_of[node.0 as usize] = around;
        if chart.node(parent).kind == NodeKind::And {
            region_of[node.0 as usize] = RegionId(regions.len() as u32);
            regions.push(Region { root: layout.place_of(node), parent: Some(around), timers: 0 });
        }
    }
    (region_of, regions)
}

/// The timers that are started on each blackboard, in alphabetical order.
fn timer_names(
    chart: &Statechart,
    ways: &[Vec<Way>],
    region_of: &[RegionId],
    count: usize,
) -> Vec<Vec<String>> {
    let mut names: Vec<BTreeSet<String>> = vec![BTreeSet::new(); count];
    for way in ways.iter().flatten() {
        for &segment in &way.segments {
            names[way.region.index()].extend(chart.transition(segment).expression.started_timers());
        }
    }
    for segment in unreached(chart, ways) {
        let transition = chart.transition(segment);
        names[region_of[transition.source.0 as usize].index()].extend(transition.expression.started_timers());
    }
    for (id, node) in chart.nodes() {
        let started = started_timers(&node.entry).chain(started_timers(&node.exit));
        names[region_of[id.0 as usize].index()].extend(started);
    }
    names.into_iter().map(|names| names.into_iter().collect()).collect()
}

/// The segments that no way leads through, since their connectors are never entered. They are checked all the same.
fn unreached(chart: &Statechart, ways: &[Vec<Way>]) -> Vec<TransitionId> {
    let reached: BTreeSet<TransitionId> =
        ways.iter().flatten().flat_map(|way| way.segments.iter().copied()).collect();
    chart.transitions().map(|(id, _)| id).filter(|id| !reached.contains(id)).collect()
}

struct Builder<'a> {
    chart: &'a Statechart,
    vocabulary: &'a Vocabulary,
    semantics: Semantics,
    layout: Layout,
    region_of: Vec<RegionId>,
    timer_names: Vec<Vec<String>>,
    events: EventTable,
    scripts: ScriptTable,
    segments: BTreeMap<(TransitionId, RegionId), Segment>,
    branches: Vec<Branch>,
    triggers: Vec<CompiledTrigger>,
    guards: Vec<ScopedGuard>,
    compounds: Vec<Compound>,
    found: Vec<Diagnostic>,
}

/// A segment compiled for one blackboard.
#[derive(Clone, Debug, Default)]
struct Segment {
    trigger: Option<usize>,
    guard: Option<usize>,
    effects: Box<[Effect]>,
}

impl<'a> Builder<'a> {
    fn new(
        chart: &'a Statechart,
        vocabulary: &'a Vocabulary,
        semantics: Semantics,
        layout: Layout,
        region_of: Vec<RegionId>,
        timer_names: Vec<Vec<String>>,
    ) -> Builder<'a> {
        Builder {
            chart,
            vocabulary,
            semantics,
            layout,
            region_of,
            timer_names,
            events: EventTable::new(),
            scripts: ScriptTable::new(),
            segments: BTreeMap::new(),
            branches: Vec::new(),
            triggers: Vec::new(),
            guards: Vec::new(),
            compounds: Vec::new(),
            found: Vec::new(),
        }
    }

    fn finish(mut self, ways: Vec<Vec<Way>>, mut regions: Vec<Region>) -> Result<Chart, Vec<Diagnostic>> {
        let errors = self.error_events();
        let unnamed = self.events.intern("?");
        let mut states = self.states(&ways);
        for segment in unreached(self.chart, &ways) {
            self.segment(segment, self.region_of[self.chart.transition(segment).source.0 as usize]);
        }
        if !self.found.is_empty() {
            return Err(self.found);
        }
        let triggers = self.match_events(&mut states);
        let timers = self.timers(&mut regions, &states, &triggers);
        let activities: Box<[Place]> =
            self.layout.places().filter(|place| states[place.index()].activity.is_some()).collect();
        Ok(Chart {
            masks: masks(&states),
            reads: self.reads(&triggers),
            sources: self.sources(&states, &triggers),
            script_places: scripts::places(self.chart, &self.scripts),
            scripts: self.scripts,
            semantics: self.semantics,
            max_activities: max_activities(&states),
            statechart: self.chart.clone(),
            events: self.events,
            layout: self.layout,
            states: states.into(),
            regions: regions.into(),
            branches: self.branches.into(),
            triggers,
            guards: self.guards.into(),
            compounds: self.compounds.into(),
            activities,
            timers,
            errors,
            unnamed,
        })
    }

    /// The events that failures are.
    fn error_events(&mut self) -> ErrorEvents {
        let (guard, action) = match self.semantics.failures {
            FailureEvents::ByCause => ("error.guard", "error.action"),
            FailureEvents::EveryTime => ("error.execution", "error.execution"),
        };
        ErrorEvents {
            guard: self.events.intern(guard),
            action: self.events.intern(action),
            activity: self.events.intern("error.activity"),
        }
    }

    /// Now that every event has its number: which of them triggers wait for and states defer.
    fn match_events(&self, states: &mut [State]) -> Box<[Trigger]> {
        let matching = self.semantics.matching;
        for state in states.iter_mut().filter(|state| !state.defer.is_empty()) {
            let all = || self.events.ids().collect();
            state.defer = events::named(&state.defer, &self.events, matching).unwrap_or_else(all);
        }
        self.triggers.iter().map(|trigger| Trigger::new(trigger, &self.events, matching)).collect()
    }

    fn timers(&self, regions: &mut [Region], states: &[State], triggers: &[Trigger]) -> Box<[Timer]> {
        let awaited = awaited(states, triggers);
        let mut timers = Vec::new();
        for (index, names) in self.timer_names.iter().enumerate() {
            regions[index].timers = timers.len();
            for (number, name) in names.iter().enumerate() {
                let event = self.events.find(name).filter(|event| awaited.contains(event));
                let (name, region) = (name.as_str().into(), RegionId(index as u32));
                timers.push(Timer { name, region, number, event });
            }
        }
        timers.into()
    }

    /// The states by place, with the ways out of each as branches.
    fn states(&mut self, ways: &[Vec<Way>]) -> Vec<State> {
        let mut activities = 0;
        let places: Vec<Place> = self.layout.places().collect();
        let mut states = Vec::with_capacity(places.len());
        for place in places {
            let mut state = self.state(place);
            if self.chart.node(self.layout.node(place)).activity.is_some() {
                state.activity = Some(activities);
                activities += 1;
            }
            let ways = &ways[self.layout.node(place).0 as usize];
            state.eventless = self.tree(ways, true);
            state.triggered = self.tree(ways, false);
            states.push(state);
        }
        states
    }

    fn state(&mut self, place: Place) -> State {
        let id = self.layout.node(place);
        let (chart, region) = (self.chart, self.region_of[id.0 as usize]);
        let node = chart.node(id);
        let what = |when: &str| format!("{when} of `{}`", chart.path(id));
        let entry = self.actions(region, |names| compile_actions(&node.entry, names), || what("entry"));
        let exit = self.actions(region, |names| compile_actions(&node.exit, names), || what("exit"));
        State {
            kind: node.kind,
            region,
            finishes: node.kind == NodeKind::End && node.parent == Some(Statechart::ROOT),
            is_region: node.parent.is_some_and(|parent| chart.node(parent).kind == NodeKind::And),
            activity: None,
            children: chart.children(id).iter().map(|&child| self.layout.place_of(child)).collect(),
            entry,
            exit,
            defer: node.defer.iter().map(|event| self.events.intern(event)).collect(),
            eventless: Branches::default(),
            triggered: Branches::default(),
        }
    }

    /// Compiles with the names of a blackboard; on errors says where they stand, and yields nothing.
    fn actions<T: Default>(
        &mut self,
        region: RegionId,
        compile: impl FnOnce(&mut Names<'_>) -> Result<T, Vec<Diagnostic>>,
        what: impl FnOnce() -> String,
    ) -> T {
        let chart = self.chart;
        let mut names = Names {
            vocabulary: self.vocabulary,
            constants: &chart.constants,
            timers: &self.timer_names[region.index()],
            events: &mut self.events,
            scripts: &mut self.scripts,
            states: &|path| chart.find(path),
        };
        compile(&mut names).unwrap_or_else(|found| {
            let what = what();
            self.found.extend(found.into_iter().map(|mut diagnostic| {
                diagnostic.message = format!("{} ({what})", diagnostic.message);
                diagnostic
            }));
            T::default()
        })
    }

    fn interrupts(&self, way: &Way) -> bool {
        way.segments.iter().any(|&segment| self.chart.transition(segment).interrupts)
    }

    /// Writes the ways of one state, with or without a trigger, as a tree of branches.
    fn tree(&mut self, ways: &[Way], eventless: bool) -> Branches {
        let ways: Vec<&Way> = ways.iter().filter(|way| way.condition.is_some() == eventless).collect();
        let start = self.branches.len();
        self.grow(&ways, 0);
        Branches { start, end: self.branches.len() }
    }

    /// Neighbouring ways that begin alike, on one blackboard, share branches.
    fn grow(&mut self, ways: &[&Way], depth: usize) {
        let alike = |a: &&Way, b: &&Way| {
            (a.segments[depth], a.region, a.condition) == (b.segments[depth], b.region, b.condition)
        };
        for group in ways.chunk_by(alike) {
            let Some(&first) = group.first() else { continue };
            let branch = self.branch(first, depth);
            let index = self.branches.len();
            self.branches.push(branch);
            if first.segments.len() > depth + 1 {
                self.grow(group, depth + 1);
            }
            self.branches[index].skip = self.branches.len();
        }
    }

    fn branch(&mut self, way: &Way, depth: usize) -> Branch {
        let segment = self.segment(way.segments[depth], way.region);
        let condition = match (depth, way.condition, segment.trigger) {
            (0, Some(condition), _) => condition,
            (0, None, Some(trigger)) => Condition::Trigger(trigger),
            _ => Condition::None,
        };
        let is_last = way.segments.len() == depth + 1;
        let compound = is_last.then(|| self.compound(way));
        Branch { condition, guard: segment.guard, compound, skip: 0 }
    }

    /// A segment on a blackboard, compiled when it is met first.
    fn segment(&mut self, id: TransitionId, region: RegionId) -> Segment {
        if let Some(segment) = self.segments.get(&(id, region)) {
            return segment.clone();
        }
        let chart = self.chart;
        let transition = chart.transition(id);
        let what =
            || format!("from `{}` to `{}`", chart.path(transition.source), chart.path(transition.target));
        let compiled: CompiledTransition =
            self.actions(region, |names| transition.expression.compile(names), what);
        let segment = Segment {
            trigger: compiled.trigger.map(|trigger| number(&mut self.triggers, trigger)),
            guard: compiled
                .guard
                .map(|guard| number(&mut self.guards, ScopedGuard { transition: id, region, guard })),
            effects: compiled.effects,
        };
        self.segments.insert((id, region), segment.clone());
        segment
    }

    fn compound(&mut self, way: &Way) -> CompoundId {
        let chart = self.chart;
        let (source, scope) = (self.layout.place_of(way.source), self.layout.place_of(way.scope));
        let terminates = chart.node(way.target).kind == NodeKind::Terminate;
        let still = terminates || way.is_targetless(chart);
        let internal = way.segments.iter().any(|&id| chart.transition(id).internal);
        let mut effects = Vec::new();
        for &id in &way.segments {
            let segment = self.segment(id, way.region);
            if !segment.effects.is_empty() {
                effects.push((id, segment.effects));
            }
        }
        let compound = Compound {
            segments: way.segments.clone().into(),
            source,
            region: way.region,
            exits: (!still).then(|| (self.layout.first(scope), Place(scope.0.saturating_sub(1)))),
            entries: if still {
                Box::default()
            } else {
                ways::entries(chart, &self.layout, way.scope, way.target).into()
            },
            effects: effects.into(),
            interrupts: self.interrupts(way),
            terminates,
            key: u64::from(!internal) << 32 | u64::from(self.layout.rank(source)),
        };
        CompoundId(number(&mut self.compounds, compound) as u32)
    }

    /// The topics that guards read or triggers wait for.
    fn reads(&self, triggers: &[Trigger]) -> Box<[TopicId]> {
        let mut topics: BTreeSet<TopicId> =
            self.guards.iter().flat_map(|guard| guard.guard.reads().iter().copied()).collect();
        topics.extend(self.arrivals(triggers));
        topics.into_iter().collect()
    }

    /// The topics whose messages triggers wait for.
    fn arrivals<'t>(&'t self, triggers: &'t [Trigger]) -> impl Iterator<Item = TopicId> + 't {
        let events = triggers.iter().flat_map(|trigger| trigger.events().iter());
        events.filter_map(|&event| self.events.topic(event))
    }

    fn sources(&self, states: &[State], triggers: &[Trigger]) -> Box<[MessageSource]> {
        let arrivals = self.arrivals(triggers).map(|topic| MessageSource { topic, origin: Origin::Own });
        let mut sources: BTreeSet<MessageSource> = arrivals.collect();
        sources.extend(self.guards.iter().flat_map(|guard| guard.guard.sources()).cloned());
        let segments = self.segments.values().map(|segment| &segment.effects);
        let states = states.iter().flat_map(|state| [&state.entry, &state.exit]);
        for effect in segments.chain(states).flat_map(|effects| effects.iter()) {
            if let Effect::Assign { value, .. } = effect {
                sources.extend(value.sources().iter().cloned());
            }
        }
        sources.into_iter().collect()
    }
}

/// The events that triggers name or states defer.
fn awaited(states: &[State], triggers: &[Trigger]) -> BTreeSet<EventId> {
    let deferred = states.iter().flat_map(|state| state.defer.iter().copied());
    let named = triggers.iter().flat_map(|trigger| match trigger {
        Trigger::OneOf(events) => events.iter().copied(),
        _ => [].iter().copied(),
    });
    deferred.chain(named).collect()
}

/// Appends, and says at which place.
fn number<T>(list: &mut Vec<T>, item: T) -> usize {
    list.push(item);
    list.len() - 1
}

fn masks(states: &[State]) -> Masks {
    let set = |member: &dyn Fn(&State) -> bool| {
        let mut set = BitSet::new(states.len());
        for (place, _) in states.iter().enumerate().filter(|(_, state)| member(state)) {
            set.insert(place);
        }
        set
    };
    Masks {
        leaves: set(&|state| !matches!(state.kind, NodeKind::Or | NodeKind::And)),
        starts: set(&|state| state.kind == NodeKind::Start),
        eventless: set(&|state| !state.eventless.is_empty()),
        triggered: set(&|state| !state.triggered.is_empty()),
        deferring: set(&|state| !state.defer.is_empty()),
    }
}

/// A BASIC state has one activity or none; an OR as many as its richest child, an AND those of all regions.
fn max_activities(states: &[State]) -> usize {
    let mut most: Vec<usize> = Vec::with_capacity(states.len());
    for state in states {
        let inside = state.children.iter().map(|child| most[child.index()]);
        most.push(match state.kind {
            NodeKind::And => inside.sum(),
            _ => inside.max().unwrap_or(0).max(usize::from(state.activity.is_some())),
        });
    }
    most.last().copied().unwrap_or(0)
}
