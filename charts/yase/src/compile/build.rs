//! Builds a compiled chart from a statechart.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::OnceLock;

use crate::bits::BitSet;
use crate::compile::compound_transitions::{self, CompoundPath, CompoundPaths, DynamicBranches};
use crate::compile::function_bindings::FunctionBindings;
use crate::compile::node_roles::{NodeRoles, is_state};
use crate::compile::paths::PathIndex;
use crate::compile::segments::CompiledSegment;
use crate::compile::{
    ArrivalCondition, BranchRange, BranchWeight, CandidatePath, ChoiceNode, CompiledChart, CompiledNode,
    CompletionGate, CompoundTransition, ErrorEvents, EventFilter, HistoryNode, JoinNode, LateDrawTree,
    NodeIndex, NodeOrder, NodeSets, Scope, ScopedGuard, ScopedTimer, SegmentNode, entries, events, scripts,
    selection_order, selection_table,
};
use crate::diagnostic::{Diagnostic, Suggestions};
use crate::expression::{
    CompiledTrigger, Effect, EventId, EventInterner, MessageSource, Origin, ScriptInterner, compile_actions,
    started_timers,
};
use crate::ids::{ActionLocation, ScopeId};
use crate::native::NativeProgram;
use crate::semantics::{FailureEvents, Semantics};
use crate::statechart::{BriefNames, NodeId, NodeKind, Statechart, TransitionId};
use crate::vocabulary::{TopicId, TypeEnvironment};

/// Checks and compiles a statechart.
pub(crate) fn build(
    chart: &Statechart,
    vocabulary: &TypeEnvironment,
    semantics: Semantics,
    program: Option<&NativeProgram>,
) -> Result<CompiledChart, Vec<Diagnostic>> {
    let mut found = chart.check_for(&semantics);
    found.retain(Diagnostic::is_error);
    if !found.is_empty() {
        return Err(found);
    }
    let layout = NodeOrder::new(chart);
    let roles = NodeRoles::new(chart, &layout, &semantics);
    let (region_of, regions) = regions(chart, &layout);
    let paths = compound_transitions::find(chart, &layout, &roles, &region_of, &semantics)?;
    let timer_names = timer_names(chart, &paths, &region_of, regions.len());
    let (count, segments) =
        (paths.all().count(), || chart.transitions().map(|(_, segment)| &segment.expression));
    let builder = ChartCompiler {
        chart,
        vocabulary,
        semantics,
        wiring: program.map(|program| FunctionBindings::new(program, vocabulary)),
        layout,
        region_of,
        timer_names,
        starts: entries::starts(chart),
        index: PathIndex::default(),
        events: EventInterner::new(),
        scripts: ScriptInterner::new(),
        segments: BTreeMap::new(),
        branches: Vec::with_capacity(count),
        triggers: Vec::with_capacity(segments().filter(|segment| segment.trigger.is_some()).count()),
        arrivals: Vec::new(),
        guards: Vec::with_capacity(segments().filter(|segment| segment.guard.is_some()).count()),
        weights: Vec::new(),
        deep: Vec::new(),
        rows: Vec::new(),
        compounds: Vec::with_capacity(count),
        found: Vec::new(),
        suggestions: Suggestions::default(),
        names: BriefNames::new(chart),
    };
    builder.finish(&paths, regions)
}

impl Statechart {
    /// The scope of each node, with the numbers of the compiled chart; a chart need not be valid.
    pub fn scopes(&self) -> Vec<ScopeId> {
        regions(self, &NodeOrder::new(self)).0
    }
}

/// The scope of each node, and the scopes in document order.
fn regions(chart: &Statechart, layout: &NodeOrder) -> (Vec<ScopeId>, Vec<Scope>) {
    let mut nodes: Vec<NodeId> = chart.nodes().map(|(id, _)| id).collect();
    nodes.sort_by_key(|&node| layout.rank(layout.index_of(node)));
    let mut region_of = vec![ScopeId::ROOT; nodes.len()];
    let mut regions = vec![Scope { root: layout.root(), parent: None, timers: 0 }];
    for node in nodes {
        let Some(parent) = chart.node(node).parent else { continue };
        let around = region_of[parent.0 as usize];
        region_of[node.0 as usize] = around;
        let is_region = chart.node(parent).kind == NodeKind::And && is_state(chart.node(node).kind);
        if is_region {
            region_of[node.0 as usize] = ScopeId(regions.len() as u32);
        }
        if is_region || has_own_blackboard(chart, node) {
            regions.push(Scope { root: layout.index_of(node), parent: Some(around), timers: 0 });
        }
    }
    (region_of, regions)
}

/// Whether a node is a composite with an activity, which runs beside those of its children.
fn has_own_blackboard(chart: &Statechart, node: NodeId) -> bool {
    let node = chart.node(node);
    node.activity.is_some() && node.kind != NodeKind::Basic
}

/// The timers started in each scope, in alphabetical order.
fn timer_names(
    chart: &Statechart,
    paths: &CompoundPaths,
    region_of: &[ScopeId],
    count: usize,
) -> Vec<Vec<String>> {
    let mut names: Vec<BTreeSet<String>> = vec![BTreeSet::new(); count];
    for path in paths.all() {
        for &segment in &path.segments {
            names[path.region.index()].extend(chart.transition(segment).expression.started_timers());
        }
    }
    for segment in unreached(chart, paths) {
        let transition = chart.transition(segment);
        names[region_of[transition.source.0 as usize].index()].extend(transition.expression.started_timers());
    }
    for (id, node) in chart.nodes() {
        let started = started_timers(&node.entry).chain(started_timers(&node.exit));
        names[region_of[id.0 as usize].index()].extend(started);
    }
    names.into_iter().map(|names| names.into_iter().collect()).collect()
}

/// The segments that no path contains, since their connectors are never entered. They are checked
/// nevertheless.
fn unreached(chart: &Statechart, paths: &CompoundPaths) -> Vec<TransitionId> {
    let mut reached = vec![false; chart.transitions().len()];
    for &segment in paths.all().flat_map(|path| &path.segments) {
        reached[segment.0 as usize] = true;
    }
    chart.transitions().map(|(id, _)| id).filter(|id| !reached[id.0 as usize]).collect()
}

/// The state of a compilation.
pub(crate) struct ChartCompiler<'a> {
    pub(crate) chart: &'a Statechart,
    pub(crate) vocabulary: &'a TypeEnvironment,
    pub(crate) semantics: Semantics,
    /// The functions that replace expressions, if the chart has them.
    pub(crate) wiring: Option<FunctionBindings<'a>>,
    pub(crate) layout: NodeOrder,
    region_of: Vec<ScopeId>,
    pub(crate) timer_names: Vec<Vec<String>>,
    pub(crate) starts: Vec<Option<NodeId>>,
    pub(crate) index: PathIndex,
    pub(crate) events: EventInterner,
    pub(crate) scripts: ScriptInterner,
    pub(crate) segments: BTreeMap<(TransitionId, ScopeId), CompiledSegment>,
    pub(crate) branches: Vec<SegmentNode>,
    pub(crate) triggers: Vec<CompiledTrigger>,
    pub(crate) arrivals: Vec<ArrivalCondition>,
    pub(crate) guards: Vec<ScopedGuard>,
    pub(crate) weights: Vec<BranchWeight>,
    pub(crate) deep: Vec<LateDrawTree>,
    pub(crate) rows: Vec<CandidatePath>,
    pub(crate) compounds: Vec<CompoundTransition>,
    pub(crate) found: Vec<Diagnostic>,
    pub(crate) suggestions: Suggestions,
    pub(crate) names: BriefNames<'a>,
}

impl ChartCompiler<'_> {
    fn finish(
        mut self,
        paths: &CompoundPaths,
        mut regions: Vec<Scope>,
    ) -> Result<CompiledChart, Vec<Diagnostic>> {
        let errors = self.error_events();
        let unnamed = self.events.intern("?");
        let mut states = self.states(&paths.of, &regions);
        let choices = paths.choices.iter().map(|late| self.choice(late)).collect();
        let histories = self.histories(&paths.histories, &mut states);
        let unreached = unreached(self.chart, paths).into_iter().map(|id| {
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
        let joins = self.joins(&paths.joins);
        let activities: Box<[NodeIndex]> =
            self.layout.indices().filter(|node| states[node.index()].activity.is_some()).collect();
        Ok(CompiledChart {
            selection_table: selection_table::entries(
                &self.layout,
                &states,
                &self.branches,
                &self.guards,
                &regions,
            ),
            node_sets: self.node_sets(&states),
            reads: self.reads(&triggers),
            sources: self.sources(&states, &triggers),
            script_locations: scripts::script_locations(self.chart, &self.scripts),
            max_activities: max_activities(&states),
            selection_order: selection_order::order(&self.layout, &joins, &self.semantics),
            joins,
            unreached,
            names: OnceLock::new(),
            statechart: self.chart.clone(),
            semantics: self.semantics,
            scripts: self.scripts,
            events: self.events,
            layout: self.layout,
            states: states.into(),
            regions: regions.into(),
            branches: self.branches.into(),
            triggers,
            arrivals: self.arrivals.into(),
            guards: self.guards.into(),
            weights: self.weights.into(),
            late_draw_trees: self.deep.into(),
            candidate_paths: self.rows.into(),
            compounds: self.compounds.into(),
            choices,
            histories,
            activities,
            timers,
            errors,
            unnamed,
        })
    }

    fn choice(&mut self, late: &DynamicBranches) -> ChoiceNode {
        ChoiceNode { node: late.node, branches: self.tree(&late.paths, false) }
    }

    /// The HISTORYs in the order of their owners, which store their indices.
    fn histories(&mut self, branches: &[DynamicBranches], states: &mut [CompiledNode]) -> Box<[HistoryNode]> {
        let mut histories: Vec<HistoryNode> = branches.iter().map(|late| self.history(late)).collect();
        histories.sort_by_key(|history| (history.owner, history.node));
        for (number, history) in histories.iter().enumerate() {
            let numbers = &mut states[history.owner.index()].histories;
            *numbers = if Range::is_empty(numbers) { number..number + 1 } else { numbers.start..number + 1 };
        }
        histories.into()
    }

    fn history(&mut self, late: &DynamicBranches) -> HistoryNode {
        let node = self.chart.node(late.node);
        HistoryNode {
            node: self.layout.index_of(late.node),
            owner: self.layout.index_of(node.parent.unwrap_or(Statechart::ROOT)),
            is_deep: node.kind == NodeKind::DeepHistory,
            branches: self.tree(&late.paths, false),
        }
    }

    fn joins(&self, groups: &[compound_transitions::JoinSources]) -> Box<[JoinNode]> {
        let mut first = 0;
        let indices = |nodes: &[NodeId]| nodes.iter().map(|&node| self.layout.index_of(node)).collect();
        let join = |join: &compound_transitions::JoinSources| {
            let regions: Box<[NodeIndex]> = indices(&join.regions);
            let start = first;
            first += regions.len();
            JoinNode {
                around: self.layout.index_of(join.around),
                first: start,
                sources: indices(&join.sources),
                regions,
            }
        };
        groups.iter().map(join).collect()
    }

    /// The events raised by failures.
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

    /// Resolves the events that triggers await and states defer; requires that all events are
    /// numbered.
    fn match_events(&self, states: &mut [CompiledNode]) -> Box<[EventFilter]> {
        let matching = self.semantics.matching;
        for state in states.iter_mut().filter(|state| !state.defer.is_empty()) {
            let all = || self.events.ids().collect();
            state.defer = events::named(&state.defer, &self.events, matching).unwrap_or_else(all);
        }
        self.triggers.iter().map(|trigger| EventFilter::new(trigger, &self.events, matching)).collect()
    }

    fn timers(
        &self,
        regions: &mut [Scope],
        states: &[CompiledNode],
        triggers: &[EventFilter],
    ) -> Box<[ScopedTimer]> {
        let awaited = awaited_events(states, triggers);
        let mut timers = Vec::new();
        for (index, names) in self.timer_names.iter().enumerate() {
            regions[index].timers = timers.len();
            for (number, name) in names.iter().enumerate() {
                let event = self.events.find(name).filter(|event| awaited.contains(event));
                let (name, region) = (name.as_str().into(), ScopeId(index as u32));
                timers.push(ScopedTimer { name, region, number, event });
            }
        }
        timers.into()
    }

    /// The nodes by index, with the paths out of each as branches.
    fn states(&mut self, paths: &[Vec<CompoundPath>], regions: &[Scope]) -> Vec<CompiledNode> {
        let mut activities = 0;
        let nodes: Vec<NodeIndex> = self.layout.indices().collect();
        let mut states = Vec::with_capacity(nodes.len());
        for node in nodes {
            let mut state = self.state(node);
            if self.chart.node(self.layout.node(node)).activity.is_some() {
                state.activity = Some(activities);
                activities += 1;
            }
            if has_own_blackboard(self.chart, self.layout.node(node)) {
                let own = regions.iter().position(|scope| scope.root == node);
                state.activity_region = own.map_or(state.region, |index| ScopeId(index as u32));
            }
            let branches = &paths[self.layout.node(node).0 as usize];
            state.eventless = self.tree(branches, true);
            state.triggered = self.tree(branches, false);
            states.push(state);
        }
        states
    }

    fn state(&mut self, index: NodeIndex) -> CompiledNode {
        let id = self.layout.node(index);
        let (chart, region) = (self.chart, self.region_of[id.0 as usize]);
        let node = chart.node(id);
        let entry = |names: &BriefNames<'_>| format!("entry of `{}`", names.name(id));
        let exit = |names: &BriefNames<'_>| format!("exit of `{}`", names.name(id));
        let mut entry = self.actions(region, |names| compile_actions(&node.entry, names), entry);
        let mut exit = self.actions(region, |names| compile_actions(&node.exit, names), exit);
        self.bind_functions(&mut entry, ActionLocation::Entry(id), region);
        self.bind_functions(&mut exit, ActionLocation::Exit(id), region);
        CompiledNode {
            kind: node.kind,
            region,
            finishes: node.kind == NodeKind::End && node.parent == Some(Statechart::ROOT),
            is_region: node.parent.is_some_and(|parent| chart.node(parent).kind == NodeKind::And),
            activity: None,
            activity_region: region,
            parent: node.parent.map(|parent| self.layout.index_of(parent)),
            start: self.starts[id.0 as usize].map(|start| self.layout.index_of(start)),
            parts: self.parts(id),
            histories: 0..0,
            done: self.done(id),
            entry,
            exit,
            defer: node.defer.iter().map(|event| self.events.intern(event)).collect(),
            eventless: BranchRange::default(),
            triggered: BranchRange::default(),
        }
    }

    /// Replaces the values that actions assign by functions, if the chart has them.
    pub(crate) fn bind_functions(
        &mut self,
        effects: &mut [Effect],
        location: ActionLocation,
        region: ScopeId,
    ) {
        if let Some(wiring) = &mut self.wiring {
            wiring.effects(effects, location, region, &self.timer_names[region.index()]);
        }
    }

    /// The regions of an AND, the ENDs of an OR.
    fn parts(&self, id: NodeId) -> Box<[NodeIndex]> {
        let kind = self.chart.node(id).kind;
        let is_part = |child: &&NodeId| match kind {
            NodeKind::And => is_state(self.chart.node(**child).kind),
            _ => self.chart.node(**child).kind == NodeKind::End,
        };
        self.chart.children(id).iter().filter(is_part).map(|&child| self.layout.index_of(child)).collect()
    }

    /// The event raised by the completion of a composite.
    fn done(&mut self, id: NodeId) -> Option<EventId> {
        let is_wanted = self.semantics.completion_events && id != Statechart::ROOT;
        let is_composite = matches!(self.chart.node(id).kind, NodeKind::Or | NodeKind::And);
        (is_wanted && is_composite).then(|| {
            let name = self.chart.segment(id);
            self.events.intern(&format!("done.state.{name}"))
        })
    }

    fn node_sets(&self, states: &[CompiledNode]) -> NodeSets {
        let set = |member: &dyn Fn(&CompiledNode) -> bool| {
            let mut set = BitSet::new(states.len());
            for (index, _) in states.iter().enumerate().filter(|(_, state)| member(state)) {
                set.insert(index);
            }
            set
        };
        let eventless = self.semantics.eventless;
        NodeSets {
            starts: set(&|state| state.kind == NodeKind::Start),
            eventless: selection_table::eventless_nodes(states, &self.branches, &self.guards, eventless),
            awaiting_return: set(&|state| {
                matches!(selection_table::gate(state, &self.branches), CompletionGate::Returned(_))
            }),
            triggered: set(&|state| !state.triggered.is_empty()),
            deferring: set(&|state| !state.defer.is_empty()),
        }
    }

    /// The topics that guards read or triggers await.
    fn reads(&self, triggers: &[EventFilter]) -> Box<[TopicId]> {
        let mut topics: BTreeSet<TopicId> =
            self.guards.iter().flat_map(|guard| guard.guard.reads().iter().copied()).collect();
        topics.extend(self.arrivals(triggers).map(|(topic, _)| topic));
        topics.into_iter().collect()
    }

    /// The topics of messages that triggers await, and the host if it is another.
    fn arrivals<'t>(
        &'t self,
        triggers: &'t [EventFilter],
    ) -> impl Iterator<Item = (TopicId, Option<&'t str>)> {
        let events = triggers.iter().flat_map(|trigger| trigger.events().iter());
        events.filter_map(|&event| Some((self.events.topic(event)?, self.events.host(event))))
    }

    fn sources(&self, states: &[CompiledNode], triggers: &[EventFilter]) -> Box<[MessageSource]> {
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
fn awaited_events(states: &[CompiledNode], triggers: &[EventFilter]) -> BTreeSet<EventId> {
    let deferred = states.iter().flat_map(|state| state.defer.iter().copied());
    let named = triggers.iter().flat_map(|trigger| match trigger {
        EventFilter::OneOf(events) => events.iter().copied(),
        _ => [].iter().copied(),
    });
    deferred.chain(named).collect()
}

/// A state has at most one activity of its own; an OR runs as many inside as the child with the
/// most, an AND the sum of its regions.
fn max_activities(states: &[CompiledNode]) -> usize {
    let mut inside = vec![0; states.len()];
    let mut max = 0;
    for (position, state) in states.iter().enumerate() {
        max = inside[position] + usize::from(state.activity.is_some());
        let Some(parent) = state.parent.map(NodeIndex::index) else { continue };
        inside[parent] = match states[parent].kind {
            NodeKind::And => inside[parent] + max,
            _ => inside[parent].max(max),
        };
    }
    max
}
