//! A naive interpreter of statecharts, written from the rules, slow and obvious: no numbering, no tables, no bits. Everything is
//! searched for again whenever it is needed.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use yase::expression::{
    Action, ActionKind, Comparison, Expression, ExpressionKind, TransitionExpression, Trigger,
};
use yase::statechart::{NodeId, NodeKind, Statechart, TransitionId};
use yase::{Activation, FieldId, Host, Moment, Outcome, RegionId, TopicId, Value};

use crate::kit::script::Interpreter;
use crate::kit::world::{TOPICS, World};

/// How many micro-steps, and steps at one moment, are allowed.
pub(crate) const LIMIT: u32 = 40;

/// One way out of a state: its segments.
type Way = Vec<TransitionId>;

#[derive(Clone, Debug, PartialEq)]
struct Occurrence {
    event: String,
    number: u32,
    raised: bool,
    expiry: Option<(RegionId, String)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Queued,
    Running,
    Ongoing,
    Failed,
    Done,
}

#[derive(Clone, Debug)]
struct Job {
    phase: Phase,
    number: u64,
    cancelled: bool,
}

#[derive(Clone, Debug)]
struct Deadline {
    moment: Moment,
    announced: bool,
}

/// What happens in a micro-step, for its line.
#[derive(Default)]
struct Line {
    exits: Vec<NodeId>,
    effects: Vec<String>,
    entries: Vec<NodeId>,
}

pub(crate) struct Stepper<'c> {
    chart: &'c Statechart,
    running_chart: bool,
    now: Moment,
    due: bool,
    active: BTreeSet<NodeId>,
    jobs: BTreeMap<NodeId, Job>,
    job_count: u64,
    timers: BTreeMap<(RegionId, String), Deadline>,
    count: u32,
    raised: Vec<Occurrence>,
    arrived: Vec<Occurrence>,
    deferred: Vec<Occurrence>,
    held: Vec<(Occurrence, Vec<Way>, bool)>,
    pending: Vec<(Way, Option<String>)>,
    erred: BTreeSet<(TransitionId, RegionId)>,
    stale: BTreeSet<(TransitionId, RegionId)>,
    written: BTreeSet<RegionId>,
    waiting: BTreeSet<NodeId>,
    line: Line,
    micro_steps: u32,
    did_something: bool,
    instant: Moment,
    steps_at_instant: u32,
}

impl<'c> Stepper<'c> {
    pub(crate) fn new(chart: &'c Statechart) -> Stepper<'c> {
        Stepper {
            chart,
            running_chart: false,
            now: Moment::ZERO,
            due: false,
            active: BTreeSet::new(),
            jobs: BTreeMap::new(),
            job_count: 0,
            timers: BTreeMap::new(),
            count: 0,
            raised: vec![],
            arrived: vec![],
            deferred: vec![],
            held: vec![],
            pending: vec![],
            erred: BTreeSet::new(),
            stale: BTreeSet::new(),
            written: BTreeSet::new(),
            waiting: BTreeSet::new(),
            line: Line::default(),
            micro_steps: 0,
            did_something: false,
            instant: Moment::ZERO,
            steps_at_instant: 0,
        }
    }

    // --- the tree -----------------------------------------------------------------------------------------------

    fn kind(&self, node: NodeId) -> NodeKind {
        self.chart.node(node).kind
    }

    /// Every node, a parent before its children, siblings in order.
    fn document(&self) -> Vec<NodeId> {
        fn visit(chart: &Statechart, node: NodeId, out: &mut Vec<NodeId>) {
            out.push(node);
            for &child in chart.children(node) {
                visit(chart, child, out);
            }
        }
        let mut out = vec![];
        visit(self.chart, Statechart::ROOT, &mut out);
        out
    }

    fn position(&self, node: NodeId) -> usize {
        self.document().iter().position(|&other| other == node).unwrap()
    }

    fn is_inside(&self, node: NodeId, outer: NodeId) -> bool {
        self.chart.ancestors(node).any(|ancestor| ancestor == outer)
    }

    fn is_region(&self, node: NodeId) -> bool {
        self.chart.node(node).parent.is_some_and(|parent| self.kind(parent) == NodeKind::And)
    }

    fn region_nodes(&self) -> Vec<NodeId> {
        let regions = self.document().into_iter().filter(|&node| self.is_region(node));
        std::iter::once(Statechart::ROOT).chain(regions).collect()
    }

    /// R19: the blackboard of a node: that of the nearest region around it, itself included.
    fn region(&self, node: NodeId) -> RegionId {
        let regions = self.region_nodes();
        let owner =
            std::iter::once(node).chain(self.chart.ancestors(node)).find(|node| regions.contains(node));
        RegionId(regions.iter().position(|&region| Some(region) == owner).unwrap() as u32)
    }

    fn active_in_document_order(&self) -> Vec<NodeId> {
        self.document().into_iter().filter(|node| self.active.contains(node)).collect()
    }

    fn is_leaf(&self, node: NodeId) -> bool {
        !matches!(self.kind(node), NodeKind::Or | NodeKind::And)
    }

    // --- R2, R3, R6: ways -----------------------------------------------------------------------------------------

    fn outgoing(&self, node: NodeId) -> Vec<TransitionId> {
        let mut out: Vec<TransitionId> = self
            .chart
            .transitions()
            .filter(|(_, transition)| transition.source == node)
            .map(|(id, _)| id)
            .collect();
        out.sort_by_key(|&id| {
            let transition = self.chart.transition(id);
            (-transition.priority, u8::from(transition.expression.guard.is_none()), id)
        });
        out
    }

    fn ways(&self, node: NodeId) -> Vec<Way> {
        let mut all = vec![];
        for id in self.outgoing(node) {
            let target = self.chart.transition(id).target;
            if matches!(self.kind(target), NodeKind::Condition | NodeKind::Junction) {
                for rest in self.ways(target) {
                    all.push([vec![id], rest].concat());
                }
            } else {
                all.push(vec![id]);
            }
        }
        all
    }

    fn source(&self, way: &Way) -> NodeId {
        self.chart.transition(way[0]).source
    }

    fn target(&self, way: &Way) -> NodeId {
        self.chart.transition(*way.last().unwrap()).target
    }

    fn is_internal(&self, way: &Way) -> bool {
        way.iter().any(|&id| self.chart.transition(id).internal)
    }

    fn interrupts(&self, way: &Way) -> bool {
        way.iter().any(|&id| self.chart.transition(id).interrupts)
    }

    fn scope(&self, way: &Way) -> NodeId {
        let (source, target) = (self.source(way), self.target(way));
        if self.is_internal(way) {
            return source;
        }
        self.chart
            .ancestors(source)
            .find(|&node| self.kind(node) == NodeKind::Or && self.is_inside(target, node))
            .unwrap()
    }

    /// The active states a way would leave, innermost first, the first region first.
    fn exits(&self, way: &Way) -> Vec<NodeId> {
        fn visit(stepper: &Stepper<'_>, node: NodeId, out: &mut Vec<NodeId>) {
            for &child in stepper.chart.children(node) {
                if stepper.active.contains(&child) {
                    visit(stepper, child, out);
                    out.push(child);
                }
            }
        }
        let targetless = self.is_internal(way) && self.source(way) == self.target(way);
        let mut out = vec![];
        if !targetless && self.kind(self.target(way)) != NodeKind::Terminate {
            visit(self, self.scope(way), &mut out);
        }
        out
    }

    // --- expressions ----------------------------------------------------------------------------------------------

    fn expression(&self, id: TransitionId) -> &TransitionExpression {
        &self.chart.transition(id).expression
    }

    /// R4
    fn is_triggered(&self, way: &Way, occurrence: Option<&Occurrence>) -> bool {
        match (&self.expression(way[0]).trigger, occurrence) {
            (None, None) => true,
            (Some(Trigger::OneOf(names)), Some(occurrence)) => {
                names.iter().any(|name| name.text() == occurrence.event)
            }
            (Some(_), Some(occurrence)) if occurrence.expiry.is_some() => false,
            (Some(Trigger::Any), Some(_)) => true,
            (Some(Trigger::Not(name)), Some(occurrence)) => name.text() != occurrence.event,
            _ => false,
        }
    }

    /// R5
    fn guards_hold(&mut self, way: &Way, world: &mut World) -> bool {
        let region = self.region(self.scope(way));
        for &id in way {
            let Some(guard) = self.expression(id).guard.clone() else { continue };
            match self.truth(&guard, region, world) {
                Ok(value) => {
                    self.erred.remove(&(id, region));
                    if value != Some(true) {
                        return false;
                    }
                }
                Err(error) => {
                    if self.erred.insert((id, region)) {
                        self.stale.remove(&(id, region));
                        self.raise("error.guard");
                        world.say(format!("  guard failed: {error}"));
                    }
                    return false;
                }
            }
        }
        true
    }

    /// True, false, or unknown.
    fn truth(
        &self,
        expression: &Expression,
        region: RegionId,
        world: &World,
    ) -> Result<Option<bool>, String> {
        Ok(match &expression.kind {
            ExpressionKind::Bool(value) => Some(*value),
            ExpressionKind::And(parts) => {
                let mut unknown = false;
                for part in parts {
                    match self.truth(part, region, world)? {
                        Some(false) => return Ok(Some(false)),
                        Some(true) => {}
                        None => unknown = true,
                    }
                }
                if unknown { None } else { Some(true) }
            }
            ExpressionKind::Or(parts) => {
                let mut unknown = false;
                for part in parts {
                    match self.truth(part, region, world)? {
                        Some(true) => return Ok(Some(true)),
                        Some(false) => {}
                        None => unknown = true,
                    }
                }
                if unknown { None } else { Some(false) }
            }
            ExpressionKind::Not(part) => self.truth(part, region, world)?.map(|value| !value),
            ExpressionKind::Compare(left, comparison, right) => {
                let (left, right) = (self.number(left, region, world)?, self.number(right, region, world)?);
                match (left, right) {
                    (Some(left), Some(right)) => Some(match comparison {
                        Comparison::Equal => left == right,
                        Comparison::NotEqual => left != right,
                        Comparison::Less => left < right,
                        Comparison::LessOrEqual => left <= right,
                        Comparison::Greater => left > right,
                        Comparison::GreaterOrEqual => left >= right,
                    }),
                    _ => None,
                }
            }
            ExpressionKind::Absent(path) => Some(self.message(&path.text(), region, world).is_none()),
            ExpressionKind::Present(path) => Some(self.message(&path.text(), region, world).is_some()),
            ExpressionKind::Variable(path) => Some(self.is_over(&path.text(), region).unwrap_or(true)),
            ExpressionKind::TimeoutCheck(path) => Some(self.is_over(&path.text(), region).unwrap_or(false)),
            ExpressionKind::In(name) => Some(self.active.contains(&self.chart.find(&name.text).unwrap())),
            other => panic!("the generator makes no {other:?}"),
        })
    }

    fn number(
        &self,
        expression: &Expression,
        region: RegionId,
        world: &World,
    ) -> Result<Option<i64>, String> {
        Ok(match &expression.kind {
            ExpressionKind::Integer(value) => Some(*value as i64),
            ExpressionKind::Variable(path) => self.message(&path.segments[0].text, region, world),
            ExpressionKind::Sum(first, rest) => {
                let mut sum = self.number(first, region, world)?;
                for (_, part) in rest {
                    sum = sum.zip(self.number(part, region, world)?).map(|(a, b)| a + b);
                }
                sum
            }
            ExpressionKind::Call(name, arguments) if name.text == "fail" && arguments.is_empty() => {
                return Err("the function failed: it always fails".to_owned());
            }
            other => panic!("the generator makes no {other:?}"),
        })
    }

    fn message(&self, name: &str, region: RegionId, world: &World) -> Option<i64> {
        world.number(region, topic(name).unwrap())
    }

    fn is_over(&self, timer: &str, region: RegionId) -> Option<bool> {
        self.timers.get(&(region, timer.to_owned())).map(|deadline| deadline.moment <= self.now)
    }

    // --- R9, R14, R15 ---------------------------------------------------------------------------------------------

    fn runs(&self, node: NodeId) -> bool {
        self.jobs.get(&node).is_some_and(|job| matches!(job.phase, Phase::Queued | Phase::Running))
    }

    fn region_runs(&self, region: RegionId) -> bool {
        self.jobs.keys().any(|&node| self.runs(node) && self.region(node) == region)
    }

    fn leaves_running(&self, way: &Way) -> bool {
        self.exits(way).into_iter().any(|node| self.runs(node))
    }

    fn is_complete(&self, node: NodeId) -> bool {
        match self.kind(node) {
            NodeKind::And => self.chart.children(node).iter().all(|&region| self.is_complete(region)),
            NodeKind::Or => self
                .chart
                .children(node)
                .iter()
                .any(|&child| self.active.contains(&child) && self.kind(child) == NodeKind::End),
            _ => self.jobs.get(&node).is_none_or(|job| job.phase == Phase::Done),
        }
    }

    fn is_ready(&mut self, way: &Way, world: &mut World) -> bool {
        let (source, target) = (self.source(way), self.target(way));
        let guarded = self.expression(way[0]).guard.is_some();
        if self.is_leaf(source) || !guarded || source == target {
            return self.is_complete(source);
        }
        let inside: Vec<NodeId> = self
            .active_in_document_order()
            .into_iter()
            .filter(|&node| self.is_inside(node, source))
            .collect();
        (self.interrupts(way) || !inside.iter().any(|&node| self.runs(node)))
            && !self.can_step_inside(source, &inside, world)
    }

    fn can_step_inside(&mut self, composite: NodeId, inside: &[NodeId], world: &mut World) -> bool {
        let leaves: Vec<NodeId> = inside.iter().copied().filter(|&node| self.is_leaf(node)).collect();
        leaves.into_iter().any(|leaf| {
            let outward: Vec<NodeId> = std::iter::once(leaf)
                .chain(self.chart.ancestors(leaf))
                .take_while(|&node| node != composite)
                .collect();
            outward.into_iter().any(|node| self.judge(node, None, world).0.is_some())
        })
    }

    /// Whether a pending interruption or, without an event, a held event is about to leave a state.
    fn is_frozen(&self, node: NodeId, with_event: bool) -> bool {
        let pending = self.pending.iter().any(|(way, _)| self.would_leave(way, node));
        let held = self.held.iter().any(|(_, ways, _)| ways.iter().any(|way| self.would_leave(way, node)));
        pending || !with_event && held
    }

    fn would_leave(&self, way: &Way, node: NodeId) -> bool {
        self.exits(way).contains(&node)
    }

    /// The best enabled way out of a state; and, if there is an event, the first that would be but for running activities.
    fn judge(
        &mut self,
        node: NodeId,
        occurrence: Option<&Occurrence>,
        world: &mut World,
    ) -> (Option<Way>, Option<Way>) {
        let mut blocked = None;
        if occurrence.is_none() && self.is_frozen(node, false) {
            return (None, None);
        }
        let locked = self.region_runs(self.region(node));
        for way in self.ways(node) {
            if !self.is_triggered(&way, occurrence)
                || occurrence.is_none() && !self.is_ready(&way, world)
                || !self.guards_hold(&way, world)
            {
                continue;
            }
            let frozen = self.is_frozen(node, true);
            if !frozen && (self.interrupts(&way) || !locked && !self.leaves_running(&way)) {
                return (Some(way), blocked);
            }
            if blocked.is_none() {
                blocked = Some(way);
            }
        }
        (None, blocked)
    }

    // --- R7, R8 ---------------------------------------------------------------------------------------------------

    /// The candidates, and the ways that wait for running activities.
    fn candidates(&mut self, occurrence: Option<&Occurrence>, world: &mut World) -> (Vec<Way>, Vec<Way>) {
        let (mut found, mut waiting): (Vec<Way>, Vec<Way>) = (vec![], vec![]);
        let leaves: Vec<NodeId> =
            self.active_in_document_order().into_iter().filter(|&node| self.is_leaf(node)).collect();
        for leaf in leaves {
            let mut noted = false;
            for node in std::iter::once(leaf).chain(self.chart.ancestors(leaf)) {
                let (enabled, blocked) = self.judge(node, occurrence, world);
                if let Some(way) = blocked
                    && occurrence.is_some()
                    && !noted
                {
                    noted = true;
                    if !waiting.contains(&way) {
                        waiting.push(way);
                    }
                }
                if let Some(way) = enabled {
                    if !found.contains(&way) {
                        found.push(way);
                    }
                    break;
                }
            }
        }
        self.sort_inner_first(&mut waiting);
        (found, waiting)
    }

    /// What is nested before what is around it, else in the order of the document.
    fn sort_inner_first(&self, ways: &mut [Way]) {
        ways.sort_by(|a, b| {
            let (a, b) = (self.source(a), self.source(b));
            if self.is_inside(a, b) {
                std::cmp::Ordering::Less
            } else if self.is_inside(b, a) {
                std::cmp::Ordering::Greater
            } else {
                self.position(a).cmp(&self.position(b))
            }
        });
    }

    /// Winners and losers of conflicts.
    fn resolve(&self, mut candidates: Vec<Way>) -> (Vec<Way>, Vec<Way>) {
        candidates.sort_by_key(|way| self.position(self.source(way)));
        let mut losers: Vec<Way> = vec![];
        let mut order = candidates.clone();
        self.sort_inner_first(&mut order);
        let mut winners: Vec<Way> = vec![];
        for way in order {
            let exits: BTreeSet<NodeId> = self.exits(&way).into_iter().collect();
            if winners.iter().any(|winner| self.exits(winner).iter().any(|node| exits.contains(node))) {
                losers.push(way);
            } else {
                winners.push(way);
            }
        }
        winners.sort_by_key(|way| (!self.is_internal(way), self.position(self.source(way))));
        (winners, losers)
    }

    // --- R10 to R13 -----------------------------------------------------------------------------------------------

    fn fire(&mut self, way: &Way, world: &mut World) {
        let terminates = self.kind(self.target(way)) == NodeKind::Terminate;
        let targetless = self.is_internal(way) && self.source(way) == self.target(way);
        let (scope, target) = (self.scope(way), self.target(way));
        for node in self.exits(way) {
            self.leave(node, world);
        }
        let region = self.region(scope);
        for &id in way {
            let transition = self.chart.transition(id);
            let place = format!("{} -> {}", self.name(transition.source), self.name(transition.target));
            self.act(&transition.expression.actions.clone(), region, &place, world);
        }
        if terminates {
            self.halt(world);
        } else if !targetless {
            self.enter_inside(scope, target, world);
        }
    }

    fn leave(&mut self, node: NodeId, world: &mut World) {
        if let Some(job) = self.jobs.remove(&node)
            && job.phase == Phase::Ongoing
        {
            world.stop(self.activation(node, job.number));
        }
        let actions = self.chart.node(node).exit.clone();
        self.act(&actions, self.region(node), &format!("exit {}", self.name(node)), world);
        self.active.remove(&node);
        self.waiting.remove(&node);
        self.line.exits.push(node);
    }

    /// Enters what of a composite leads to a target, and what must be entered with it.
    fn enter_inside(&mut self, composite: NodeId, target: NodeId, world: &mut World) {
        for &child in self.chart.children(composite) {
            let on_the_way = child == target || self.is_inside(target, child);
            let whole = !self.is_inside(target, composite);
            let start = whole && self.kind(child) == NodeKind::Start;
            if on_the_way || start || self.kind(composite) == NodeKind::And {
                self.enter(child, world);
                if !self.is_leaf(child) {
                    self.enter_inside(child, target, world);
                }
            }
        }
    }

    fn enter(&mut self, node: NodeId, world: &mut World) {
        self.active.insert(node);
        self.line.entries.push(node);
        if self.is_region(node) {
            let around = self.chart.node(node).parent.unwrap();
            world.inherit(self.region(node), self.region(around));
        }
        let actions = self.chart.node(node).entry.clone();
        self.act(&actions, self.region(node), &format!("entry {}", self.name(node)), world);
        if self.chart.node(node).activity.is_some() {
            self.job_count += 1;
            let job = Job { phase: Phase::Queued, number: self.job_count, cancelled: false };
            self.jobs.insert(node, job);
        }
        if self.kind(node) == NodeKind::End && self.chart.node(node).parent == Some(Statechart::ROOT) {
            self.halt(world);
        }
    }

    fn act(&mut self, actions: &[Action], region: RegionId, place: &str, world: &mut World) {
        if actions.is_empty() {
            return;
        }
        let texts: Vec<String> = actions.iter().map(ToString::to_string).collect();
        self.line.effects.push(format!("{} ({place})", texts.join(", ")));
        for action in actions {
            if let Err(error) = self.perform(action, region, world) {
                self.raise("error.action");
                world.say(format!("  action failed: {error}"));
            }
        }
    }

    fn perform(&mut self, action: &Action, region: RegionId, world: &mut World) -> Result<(), String> {
        match &action.kind {
            ActionKind::Raise(event) => self.raise(&event.text()),
            ActionKind::ProcessMessages => self.deliver(region, world),
            ActionKind::PublishAll => {
                world.publish_all(region);
                self.written.remove(&region);
            }
            ActionKind::Publish(path) => {
                world.publish(region, topic(&path.text()).unwrap());
                self.written.insert(region);
            }
            ActionKind::StartTimeout { timer, delay, .. } => self.start_timer(&timer.text(), *delay, region),
            ActionKind::Assign { target, value } => {
                let name = &target.segments[0].text;
                let value = self
                    .number(value, region, world)?
                    .ok_or("the value depends on a message that has not arrived")?;
                world
                    .assign(region, topic(name).unwrap(), &[FieldId(0)], Value::Int(value))
                    .map_err(|error| format!("the value cannot be assigned: {error}"))?;
                self.written.insert(region);
                let reads = self.guards_that_read(name);
                self.erred.retain(|(id, other)| *other != region || !reads.contains(id));
            }
        }
        Ok(())
    }

    fn start_timer(&mut self, name: &str, delay: Duration, region: RegionId) {
        let key = (region, name.to_owned());
        for queue in [&mut self.raised, &mut self.arrived, &mut self.deferred] {
            queue.retain(|occurrence| occurrence.expiry.as_ref() != Some(&key));
        }
        self.held.retain(|(occurrence, _, _)| occurrence.expiry.as_ref() != Some(&key));
        self.timers.insert(key, Deadline { moment: self.now + delay, announced: false });
        let reads = self.guards_that_read(name);
        self.erred.retain(|(id, other)| *other != region || !reads.contains(id));
    }

    /// The segments whose guard has a word in it.
    fn guards_that_read(&self, word: &str) -> BTreeSet<TransitionId> {
        let has_word = |text: String| text.split(|c: char| !c.is_alphanumeric()).any(|other| other == word);
        self.chart
            .transitions()
            .filter(|(_, transition)| {
                transition.expression.guard.as_ref().is_some_and(|guard| has_word(guard.to_string()))
            })
            .map(|(id, _)| id)
            .collect()
    }

    /// R13, and what is left to do when a chart ends.
    fn halt(&mut self, world: &mut World) {
        for node in self.document() {
            let Some(job) = self.jobs.get(&node).cloned() else { continue };
            match job.phase {
                Phase::Running if !job.cancelled => world.cancel(self.activation(node, job.number)),
                Phase::Ongoing => world.stop(self.activation(node, job.number)),
                _ => {}
            }
        }
        self.jobs.clear();
        self.raised.clear();
        self.arrived.clear();
        self.deferred.clear();
        self.held.clear();
        self.pending.clear();
        self.running_chart = false;
    }

    fn activation(&self, node: NodeId, number: u64) -> Activation {
        Activation { node, region: self.region(node), number }
    }

    // --- R16 to R21: queues, steps --------------------------------------------------------------------------------

    fn raise(&mut self, event: &str) {
        self.count += 1;
        let occurrence =
            Occurrence { event: event.to_owned(), number: self.count, raised: true, expiry: None };
        self.raised.push(occurrence);
    }

    fn arrive(&mut self, event: &str, expiry: Option<(RegionId, String)>) {
        self.count += 1;
        let occurrence = Occurrence { event: event.to_owned(), number: self.count, raised: false, expiry };
        self.arrived.push(occurrence);
    }

    fn deliver(&mut self, region: RegionId, world: &mut World) {
        world.deliver(region);
        let stale = self.stale.clone();
        self.erred.retain(|key| key.1 != region || !stale.contains(key));
        self.stale.retain(|key| key.1 != region);
    }

    fn begin(&mut self, world: &mut World) {
        self.due = false;
        self.micro_steps = 0;
        self.did_something = false;
        if self.instant != self.now {
            (self.instant, self.steps_at_instant) = (self.now, 0);
        }
        // expiries, the earliest first
        loop {
            let next = self
                .timers
                .iter()
                .filter(|(_, deadline)| !deadline.announced && deadline.moment <= self.now)
                .min_by_key(|(key, deadline)| (deadline.moment, (*key).clone()))
                .map(|(key, _)| key.clone());
            let Some(key) = next else { break };
            self.timers.get_mut(&key).unwrap().announced = true;
            let reads = self.guards_that_read(&key.1);
            self.erred.retain(|(id, other)| *other != key.0 || !reads.contains(id));
            if self.is_named(&key.1, false) {
                self.arrive(&key.1.clone(), Some(key));
            }
        }
        for (index, node) in self.region_nodes().into_iter().enumerate() {
            let region = RegionId(index as u32);
            if self.active.contains(&node) && !self.region_runs(region) {
                self.deliver(region, world);
            }
        }
    }

    /// Whether a trigger names an event or a state defers it; `anywhere`: also `raise` and `not`.
    fn is_named(&self, event: &str, anywhere: bool) -> bool {
        let raised = |actions: &[Action]| {
            actions
                .iter()
                .any(|action| matches!(&action.kind, ActionKind::Raise(name) if name.text() == event))
        };
        let triggered =
            self.chart.transitions().any(|(_, transition)| match &transition.expression.trigger {
                Some(Trigger::OneOf(names)) => names.iter().any(|name| name.text() == event),
                Some(Trigger::Not(name)) => anywhere && name.text() == event,
                _ => false,
            });
        let raises = self.chart.transitions().any(|(_, transition)| raised(&transition.expression.actions))
            || self.chart.nodes().any(|(_, node)| raised(&node.entry) || raised(&node.exit));
        let defers = self.chart.nodes().any(|(_, node)| node.defer.iter().any(|name| name == event));
        triggered || defers || anywhere && raises
    }

    fn micro_step(&mut self, world: &mut World) -> Result<bool, String> {
        if !self.running_chart {
            return Ok(false);
        }
        // interruptions whose activities have returned
        if let Some(index) = self.pending.iter().position(|(way, _)| !self.leaves_running(way)) {
            self.admit()?;
            let (way, event) = self.pending.remove(index);
            self.line = Line::default();
            self.fire(&way, world);
            let active = self.active.clone();
            let chart = self.chart;
            self.pending.retain(|(way, _)| active.contains(&chart.transition(way[0]).source));
            for held in &mut self.held {
                held.2 = true;
            }
            self.print(event.as_deref(), &[way], &[], &[], None, world);
            return Ok(true);
        }
        // held events
        if let Some(index) = self.held.iter().position(|held| held.2) {
            let occurrence = self.held.remove(index).0;
            return self.offer(occurrence, world);
        }
        // no event
        let (candidates, _) = self.candidates(None, world);
        if !candidates.is_empty() {
            self.admit()?;
            self.take(candidates, None, world);
            return Ok(true);
        }
        // deferred events come back before newer ones
        let recalled: Vec<Occurrence> = self
            .deferred
            .iter()
            .filter(|occurrence| self.deferring(&occurrence.event).is_none())
            .cloned()
            .collect();
        self.deferred.retain(|occurrence| !recalled.contains(occurrence));
        for occurrence in recalled {
            if occurrence.raised { &mut self.raised } else { &mut self.arrived }.push(occurrence);
        }
        self.raised.sort_by_key(|occurrence| occurrence.number);
        self.arrived.sort_by_key(|occurrence| occurrence.number);
        if !self.raised.is_empty() {
            let occurrence = self.raised.remove(0);
            return self.offer(occurrence, world);
        }
        self.micro_steps = 0;
        if !self.arrived.is_empty() {
            let occurrence = self.arrived.remove(0);
            return self.offer(occurrence, world);
        }
        Ok(false)
    }

    /// R17
    fn admit(&mut self) -> Result<(), String> {
        if self.micro_steps == LIMIT {
            return Err("never rests".to_owned());
        }
        if !self.did_something {
            self.did_something = true;
            self.steps_at_instant += 1;
            if self.steps_at_instant > LIMIT {
                return Err("never advances".to_owned());
            }
        }
        self.micro_steps += 1;
        Ok(())
    }

    fn offer(&mut self, occurrence: Occurrence, world: &mut World) -> Result<bool, String> {
        self.admit()?;
        let (candidates, waiting) = self.candidates(Some(&occurrence), world);
        let event = occurrence.event.clone();
        if !candidates.is_empty() {
            self.take(candidates, Some(&event), world);
        } else if !waiting.is_empty() {
            self.line = Line::default();
            self.held.push((occurrence, waiting.clone(), false));
            self.held.sort_by_key(|held| held.0.number);
            self.print(Some(&event), &[], &[], &waiting, None, world);
        } else {
            self.line = Line::default();
            let deferring = self.deferring(&event);
            if deferring.is_some() {
                self.deferred.push(occurrence);
                self.deferred.sort_by_key(|occurrence| occurrence.number);
            }
            self.print(Some(&event), &[], &[], &[], deferring, world);
        }
        Ok(true)
    }

    /// The innermost active state that defers an event; of several, the first of the document.
    fn deferring(&self, event: &str) -> Option<NodeId> {
        fn visit(stepper: &Stepper<'_>, node: NodeId, event: &str) -> Option<NodeId> {
            let inside = stepper.chart.children(node).iter().find_map(|&child| visit(stepper, child, event));
            let itself = || {
                let defers = stepper.chart.node(node).defer.iter().any(|name| name == event);
                (stepper.active.contains(&node) && defers).then_some(node)
            };
            inside.or_else(itself)
        }
        visit(self, Statechart::ROOT, event)
    }

    fn take(&mut self, candidates: Vec<Way>, event: Option<&str>, world: &mut World) {
        let (winners, losers) = self.resolve(candidates);
        self.line = Line::default();
        let (mut now, mut later) = (vec![], vec![]);
        for way in winners {
            if self.leaves_running(&way) {
                for node in self.exits(&way) {
                    self.cancel(node, world);
                }
                self.pending.push((way.clone(), event.map(str::to_owned)));
                later.push(way);
            } else {
                now.push(way);
            }
        }
        let mut fired = vec![];
        for way in now {
            if self.running_chart && self.active.contains(&self.source(&way)) {
                self.fire(&way, world);
                fired.push(way);
            }
        }
        self.print(event, &fired, &losers, &later, None, world);
    }

    fn cancel(&mut self, node: NodeId, world: &mut World) {
        if !self.runs(node) {
            return;
        }
        let job = self.jobs.get_mut(&node).unwrap();
        let (is_new, phase, number) = (!job.cancelled, job.phase, job.number);
        job.cancelled = true;
        if is_new && phase == Phase::Running {
            world.cancel(self.activation(node, number));
        }
    }

    fn finish(&mut self, world: &mut World) {
        for region in std::mem::take(&mut self.written) {
            world.publish_all(region);
        }
        for node in self.document() {
            let Some(job) = self.jobs.get_mut(&node) else { continue };
            if job.phase == Phase::Queued {
                job.phase = Phase::Running;
                let (number, cancelled) = (job.number, job.cancelled);
                world.start(self.activation(node, number));
                if cancelled {
                    world.cancel(self.activation(node, number));
                }
            }
        }
        if !self.running_chart {
            return;
        }
        for node in self.active_in_document_order() {
            let is_new = !self.waiting.contains(&node) && !self.is_frozen(node, false);
            if self.kind(node) == NodeKind::Start && is_new {
                self.waiting.insert(node);
                world.say(format!("  waits at {}", self.name(node)));
            }
        }
    }

    // --- lines ----------------------------------------------------------------------------------------------------

    fn name(&self, node: NodeId) -> String {
        let path = self.chart.path(node);
        path.split_once('/').map_or(path.clone(), |(_, rest)| rest.to_owned())
    }

    fn names(&self, nodes: &[NodeId]) -> String {
        nodes.iter().map(|&node| self.name(node)).collect::<Vec<_>>().join(", ")
    }

    fn way_names(&self, ways: &[Way]) -> String {
        let one = |way: &Way| {
            let targets = way.iter().map(|&id| self.name(self.chart.transition(id).target));
            std::iter::once(self.name(self.source(way))).chain(targets).collect::<Vec<_>>().join(" -> ")
        };
        ways.iter().map(one).collect::<Vec<_>>().join(", ")
    }

    fn print(
        &mut self,
        event: Option<&str>,
        fired: &[Way],
        losers: &[Way],
        held: &[Way],
        deferring: Option<NodeId>,
        world: &mut World,
    ) {
        let event = event.map(|event| match topic(event) {
            Some(_) => event.to_lowercase(), // messages are known by their topic
            None if self.is_known(event) => event.to_owned(),
            None => "?".to_owned(),
        });
        let selected = match (fired.is_empty(), event.is_some() && held.is_empty() && deferring.is_none()) {
            (false, _) => self.way_names(fired),
            (true, true) => "dropped".to_owned(),
            (true, false) => "nothing".to_owned(),
        };
        let mut text = format!("{} {}: {selected}", self.now, event.as_deref().unwrap_or("-"));
        let parts = [
            ("preempt", self.way_names(losers)),
            ("hold", self.way_names(held)),
            ("defer in", deferring.map(|node| self.name(node)).unwrap_or_default()),
            ("exit", self.names(&self.line.exits)),
            ("do", self.line.effects.join(", ")),
            ("enter", self.names(&self.line.entries)),
        ];
        for (title, part) in parts {
            if !part.is_empty() {
                text += &format!("; {title} {part}");
            }
        }
        world.say(text);
    }

    fn is_known(&self, event: &str) -> bool {
        event.starts_with("error.") || self.is_named(event, true)
    }
}

fn topic(name: &str) -> Option<TopicId> {
    TOPICS.iter().position(|other| *other == name).map(|index| TopicId(index as u32))
}

impl Interpreter for Stepper<'_> {
    fn start(&mut self, now: Moment, world: &mut World) {
        self.now = now;
        self.instant = now;
        self.running_chart = true;
        self.due = true;
        self.enter(Statechart::ROOT, world);
        self.enter_inside(Statechart::ROOT, Statechart::ROOT, world);
        let mut text = format!("{now} start");
        if !self.line.effects.is_empty() {
            text += &format!("; do {}", self.line.effects.join(", "));
        }
        world.say(format!("{text}; enter {}", self.names(&self.line.entries)));
    }

    fn event(&mut self, name: &str) {
        if self.running_chart {
            self.arrive(name, None);
        }
    }

    fn message(&mut self, topic: TopicId) {
        let name = TOPICS[topic.0 as usize];
        let readers = self.guards_that_read(name);
        let awaited = self.is_named(name, true);
        if !self.running_chart || readers.is_empty() && !awaited {
            return;
        }
        self.due = true;
        for key in &self.erred {
            if readers.contains(&key.0) {
                self.stale.insert(*key);
            }
        }
        if awaited {
            self.arrive(name, None);
        }
    }

    fn returned(&mut self, activation: Activation, outcome: Outcome) -> bool {
        if !self.running_chart {
            return false;
        }
        let job = self.jobs.get_mut(&activation.node).unwrap();
        assert_eq!((job.number, job.phase), (activation.number, Phase::Running));
        job.phase = match outcome {
            Outcome::Done => Phase::Done,
            Outcome::Ongoing => Phase::Ongoing,
            Outcome::Failed => Phase::Failed,
        };
        let mut held = std::mem::take(&mut self.held);
        for (_, ways, offer) in &mut held {
            let in_the_way = |way: &Way| {
                self.exits(way).contains(&activation.node)
                    || self.region(self.source(way)) == activation.region
            };
            *offer |= ways.iter().any(in_the_way);
        }
        self.held = held;
        if outcome == Outcome::Failed {
            self.arrive("error.activity", None);
        }
        self.due = true;
        true
    }

    fn resumed(&mut self, activation: Activation) -> bool {
        let job = self.jobs.get_mut(&activation.node).unwrap();
        assert_eq!((job.number, job.phase), (activation.number, Phase::Ongoing));
        job.phase = Phase::Running;
        job.cancelled = false;
        true
    }

    fn step(&mut self, now: Moment, world: &mut World) -> Result<(), String> {
        self.now = now;
        self.begin(world);
        loop {
            match self.micro_step(world) {
                Ok(true) => {}
                Ok(false) => break,
                Err(error) => {
                    self.halt(world);
                    return Err(error);
                }
            }
        }
        self.finish(world);
        Ok(())
    }

    fn needs_step(&self, now: Moment) -> bool {
        let waiting =
            !self.raised.is_empty() || !self.arrived.is_empty() || self.held.iter().any(|held| held.2);
        self.running_chart
            && (self.due || waiting || self.next_deadline().is_some_and(|deadline| deadline <= now))
    }

    fn next_deadline(&self) -> Option<Moment> {
        if !self.running_chart {
            return None;
        }
        self.timers.values().filter(|deadline| !deadline.announced).map(|deadline| deadline.moment).min()
    }

    fn regions(&self) -> usize {
        self.region_nodes().len()
    }
}
