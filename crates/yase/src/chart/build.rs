//! From a statechart to a chart.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use crate::bits::BitSet;
use crate::chart::paths::PathIndex;
use crate::chart::roles::{Roles, is_state};
use crate::chart::segments::Segment;
use crate::chart::ways::{self, Late, Way, Ways};
use crate::chart::{
    Branch, Branches, Chart, Choice, Compound, Deep, Direct, ErrorEvents, History, Join, Layout, Masks,
    Place, Region, RegionId, Row, ScopedGuard, State, Timer, Trigger, Weight, direct, entries, events, scope,
    scripts, visits,
};
use crate::diagnostic::Diagnostic;
use crate::expression::{
    CompiledTrigger, Effect, EventId, EventTable, MessageSource, Origin, ScriptTable, compile_actions,
    started_timers,
};
use crate::host::ActionPlace;
use crate::semantics::{Eventless, FailureEvents, Semantics};
use crate::statechart::{NodeId, NodeKind, Statechart, TransitionId};
use crate::typed::{Program, Wiring};
use crate::vocabulary::{TopicId, Vocabulary};

/// Checks a statechart and makes it ready to run.
pub(super) fn build(
    chart: &Statechart,
    vocabulary: &Vocabulary,
    semantics: Semantics,
    program: Option<&Program>,
) -> Result<Chart, Vec<Diagnostic>> {
    let mut found = chart.check();
    found.retain(Diagnostic::is_error);
    if !found.is_empty() {
        return Err(found);
    }
    let layout = Layout::new(chart);
    let roles = Roles::new(chart, &layout);
    let (region_of, regions) = regions(chart, &layout);
    let ways = ways::find(chart, &layout, &roles, &region_of, &semantics)?;
    let timer_names = timer_names(chart, &ways, &region_of, regions.len());
    let (count, segments) =
        (ways.all().count(), || chart.transitions().map(|(_, segment)| &segment.expression));
    let builder = Builder {
        chart,
        vocabulary,
        semantics,
        wiring: program.map(|program| Wiring::new(program, vocabulary)),
        layout,
        region_of,
        timer_names,
        starts: entries::starts(chart),
        index: PathIndex::default(),
        events: EventTable::new(),
        scripts: ScriptTable::new(),
        segments: BTreeMap::new(),
        branches: Vec::with_capacity(count),
        triggers: Vec::with_capacity(segments().filter(|segment| segment.trigger.is_some()).count()),
        guards: Vec::with_capacity(segments().filter(|segment| segment.guard.is_some()).count()),
        weights: Vec::new(),
        deep: Vec::new(),
        rows: Vec::new(),
        compounds: Vec::with_capacity(count),
        found: Vec::new(),
    };
    builder.finish(&ways, regions)
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
        if chart.node(parent).kind == NodeKind::And && is_state(chart.node(node).kind) {
            region_of[node.0 as usize] = RegionId(regions.len() as u32);
            regions.push(Region { root: layout.place_of(node), parent: Some(around), timers: 0 });
        }
    }
    (region_of, regions)
}

/// The timers that are started on each blackboard, in alphabetical order.
fn timer_names(chart: &Statechart, ways: &Ways, region_of: &[RegionId], count: usize) -> Vec<Vec<String>> {
    let mut names: Vec<BTreeSet<String>> = vec![BTreeSet::new(); count];
    for way in ways.all() {
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
fn unreached(chart: &Statechart, ways: &Ways) -> Vec<TransitionId> {
    let mut reached = vec![false; chart.transitions().len()];
    for &segment in ways.all().flat_map(|way| &way.segments) {
        reached[segment.0 as usize] = true;
    }
    chart.transitions().map(|(id, _)| id).filter(|id| !reached[id.0 as usize]).collect()
}

/// A chart that is being made ready.
pub(super) struct Builder<'a> {
    pub(super) chart: &'a Statechart,
    pub(super) vocabulary: &'a Vocabulary,
    pub(super) semantics: Semantics,
    /// The functions that stand for expressions, if the chart has them.
    pub(super) wiring: Option<Wiring<'a>>,
    pub(super) layout: Layout,
    region_of: Vec<RegionId>,
    pub(super) timer_names: Vec<Vec<String>>,
    pub(super) starts: Vec<Option<NodeId>>,
    pub(super) index: PathIndex,
    pub(super) events: EventTable,
    pub(super) scripts: ScriptTable,
    pub(super) segments: BTreeMap<(TransitionId, RegionId), Segment>,
    pub(super) branches: Vec<Branch>,
    pub(super) triggers: Vec<CompiledTrigger>,
    pub(super) guards: Vec<ScopedGuard>,
    pub(super) weights: Vec<Weight>,
    pub(super) deep: Vec<Deep>,
    pub(super) rows: Vec<Row>,
    pub(super) compounds: Vec<Compound>,
    pub(super) found: Vec<Diagnostic>,
}

impl Builder<'_> {
    fn finish(mut self, ways: &Ways, mut regions: Vec<Region>) -> Result<Chart, Vec<Diagnostic>> {
        let errors = self.error_events();
        let unnamed = self.events.intern("?");
        let mut states = self.states(&ways.of);
        let choices = ways.choices.iter().map(|late| self.choice(late)).collect();
        let histories = self.histories(&ways.histories, &mut states);
        let unreached = unreached(self.chart, ways).into_iter().map(|id| {
            let region = self.region_of[self.chart.transition(id).source.0 as usize];
            (id, region, self.segment(id, region).effects)
        });
        let unreached = unreached.collect();
        self.found.extend(self.wiring.iter_mut().flat_map(|wiring| wiring.found.drain(..)));
        if !self.found.is_empty() {
            return Err(self.found);
        }
        let triggers = self.match_events(&mut states);
        let timers = self.timers(&mut regions, &states, &triggers);
        let joins = self.joins(&ways.joins);
        let activities: Box<[Place]> =
            self.layout.places().filter(|place| states[place.index()].activity.is_some()).collect();
        let direct_ways =
            direct::Ways { branches: &self.branches, triggers: &triggers, compounds: &self.compounds };
        Ok(Chart {
            direct: Direct::new(self.chart, &self.semantics, &self.layout, &states, &direct_ways),
            masks: masks(&states, self.semantics.eventless),
            reads: self.reads(&triggers),
            sources: self.sources(&states, &triggers),
            script_places: scripts::places(self.chart, &self.scripts),
            max_activities: max_activities(&states),
            visits: visits::order(&self.layout, &joins, &self.semantics),
            joins,
            unreached,
            statechart: self.chart.clone(),
            semantics: self.semantics,
            scripts: self.scripts,
            events: self.events,
            layout: self.layout,
            states: states.into(),
            regions: regions.into(),
            branches: self.branches.into(),
            triggers,
            guards: self.guards.into(),
            weights: self.weights.into(),
            deep: self.deep.into(),
            rows: self.rows.into(),
            compounds: self.compounds.into(),
            choices,
            histories,
            activities,
            timers,
            errors,
            unnamed,
        })
    }

    fn choice(&mut self, late: &Late) -> Choice {
        Choice { node: late.node, branches: self.tree(&late.ways, false) }
    }

    /// The HISTORYs in the order of their owners, which learn their numbers.
    fn histories(&mut self, ways: &[Late], states: &mut [State]) -> Box<[History]> {
        let mut histories: Vec<History> = ways.iter().map(|late| self.history(late)).collect();
        histories.sort_by_key(|history| (history.owner, history.place));
        for (number, history) in histories.iter().enumerate() {
            let numbers = &mut states[history.owner.index()].histories;
            *numbers = if Range::is_empty(numbers) { number..number + 1 } else { numbers.start..number + 1 };
        }
        histories.into()
    }

    fn history(&mut self, late: &Late) -> History {
        let node = self.chart.node(late.node);
        History {
            place: self.layout.place_of(late.node),
            owner: self.layout.place_of(node.parent.unwrap_or(Statechart::ROOT)),
            is_deep: node.kind == NodeKind::DeepHistory,
            branches: self.tree(&late.ways, false),
        }
    }

    fn joins(&self, ways: &[ways::Join]) -> Box<[Join]> {
        let mut first = 0;
        let join = |join: &ways::Join| {
            let region =
                |&source: &NodeId| scope::child_towards(self.chart, join.around, source).unwrap_or(source);
            let regions = join.sources.iter().map(region).map(|node| self.layout.place_of(node)).collect();
            let sources: Box<[Place]> = join.sources.iter().map(|&node| self.layout.place_of(node)).collect();
            let start = first;
            first += sources.len();
            Join { around: self.layout.place_of(join.around), first: start, sources, regions }
        };
        ways.iter().map(join).collect()
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
        let mut entry = self.actions(region, |names| compile_actions(&node.entry, names), || what("entry"));
        let mut exit = self.actions(region, |names| compile_actions(&node.exit, names), || what("exit"));
        self.wire(&mut entry, ActionPlace::Entry(id), region);
        self.wire(&mut exit, ActionPlace::Exit(id), region);
        State {
            kind: node.kind,
            region,
            finishes: node.kind == NodeKind::End && node.parent == Some(Statechart::ROOT),
            is_region: node.parent.is_some_and(|parent| chart.node(parent).kind == NodeKind::And),
            activity: None,
            parent: node.parent.map(|parent| self.layout.place_of(parent)),
            start: self.starts[id.0 as usize].map(|start| self.layout.place_of(start)),
            parts: self.parts(id),
            histories: 0..0,
            done: self.done(id),
            entry,
            exit,
            defer: node.defer.iter().map(|event| self.events.intern(event)).collect(),
            eventless: Branches::default(),
            triggered: Branches::default(),
        }
    }

    /// Puts functions in the places of what actions assign, if the chart has them.
    pub(super) fn wire(&mut self, effects: &mut [Effect], place: ActionPlace, region: RegionId) {
        if let Some(wiring) = &mut self.wiring {
            wiring.effects(effects, place, region, &self.timer_names[region.index()]);
        }
    }

    /// An AND's regions, an OR's ENDs.
    fn parts(&self, id: NodeId) -> Box<[Place]> {
        let kind = self.chart.node(id).kind;
        let is_part = |child: &&NodeId| match kind {
            NodeKind::And => is_state(self.chart.node(**child).kind),
            _ => self.chart.node(**child).kind == NodeKind::End,
        };
        self.chart.children(id).iter().filter(is_part).map(|&child| self.layout.place_of(child)).collect()
    }

    /// The event that the completion of a composite is.
    fn done(&mut self, id: NodeId) -> Option<EventId> {
        let is_wanted = self.semantics.completion_events && id != Statechart::ROOT;
        let is_composite = matches!(self.chart.node(id).kind, NodeKind::Or | NodeKind::And);
        (is_wanted && is_composite).then(|| {
            let name = self.chart.segment(id);
            self.events.intern(&format!("done.state.{name}"))
        })
    }

    /// The topics that guards read or triggers wait for.
    fn reads(&self, triggers: &[Trigger]) -> Box<[TopicId]> {
        let mut topics: BTreeSet<TopicId> =
            self.guards.iter().flat_map(|guard| guard.guard.reads().iter().copied()).collect();
        topics.extend(self.arrivals(triggers).map(|(topic, _)| topic));
        topics.into_iter().collect()
    }

    /// The topics whose messages triggers wait for, and the host if it is another.
    fn arrivals<'t>(&'t self, triggers: &'t [Trigger]) -> impl Iterator<Item = (TopicId, Option<&'t str>)> {
        let events = triggers.iter().flat_map(|trigger| trigger.events().iter());
        events.filter_map(|&event| Some((self.events.topic(event)?, self.events.host(event))))
    }

    fn sources(&self, states: &[State], triggers: &[Trigger]) -> Box<[MessageSource]> {
        let arrivals = self.arrivals(triggers).map(|(topic, host)| MessageSource {
            topic,
            origin: host.map_or(Origin::Own, |host| Origin::Host(host.into())),
        });
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

fn masks(states: &[State], eventless: Eventless) -> Masks {
    let set = |member: &dyn Fn(&State) -> bool| {
        let mut set = BitSet::new(states.len());
        for (place, _) in states.iter().enumerate().filter(|(_, state)| member(state)) {
            set.insert(place);
        }
        set
    };
    let is_start = |state: &State| state.kind == NodeKind::Start;
    Masks {
        starts: set(&is_start),
        // What is looked at only when it completes has no part in other steps without an event.
        eventless: set(&|state| {
            !state.eventless.is_empty() && (eventless != Eventless::Once || is_start(state))
        }),
        triggered: set(&|state| !state.triggered.is_empty()),
        deferring: set(&|state| !state.defer.is_empty()),
    }
}

/// A BASIC state has one activity or none; an OR as many as its richest child, an AND those of all regions.
fn max_activities(states: &[State]) -> usize {
    let mut most: Vec<usize> = states.iter().map(|state| usize::from(state.activity.is_some())).collect();
    for (place, state) in states.iter().enumerate() {
        let Some(parent) = state.parent.map(Place::index) else { continue };
        most[parent] = match states[parent].kind {
            NodeKind::And => most[parent] + most[place],
            _ => most[parent].max(most[place]),
        };
    }
    most.last().copied().unwrap_or(0)
}
