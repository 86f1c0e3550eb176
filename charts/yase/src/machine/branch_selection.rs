//! Selects the path out of a node: the first that is enabled, or a random one among weighted ones.

use smallvec::SmallVec;

use crate::compile::{
    ArrivalCondition, BranchRange, BranchWeight, CandidatePath, EnablingCondition, NodeIndex, SegmentNode,
};
use crate::host::Host;
use crate::ids::CompoundTransitionId;
use crate::machine::queues::PoppedEvent;
use crate::machine::select::matches;
use crate::machine::step::Macrostep;
use crate::statechart::TransitionId;

/// The context of a selection: a state, and the event offered, if any. Behind executed actions
/// there is no source state any more.
#[derive(Clone, Copy)]
pub(crate) struct BranchQuery<'a> {
    pub(crate) state: Option<NodeIndex>,
    pub(crate) occurrence: Option<&'a PoppedEvent>,
    /// Whether the state is known to have completed.
    pub(crate) is_complete: bool,
}

/// A weighted segment: the first of its branches (or its index among its siblings), and its weight.
#[derive(Clone, Copy)]
struct WeightedSegment {
    segment: TransitionId,
    first: usize,
    weight: f64,
}

impl<H: Host> Macrostep<'_, H> {
    /// The enabled path behind executed actions.
    pub(crate) fn first_open_path(&mut self, branches: BranchRange) -> Option<CompoundTransitionId> {
        self.scan(branches, BranchQuery { state: None, occurrence: None, is_complete: false })
    }

    /// The first complete path whose segments are all enabled and which no running activity blocks.
    /// Weighted branches are chosen at random, all at the position of the first one, unless the
    /// chooser takes the option declared first.
    pub(crate) fn scan(
        &mut self,
        branches: BranchRange,
        search: BranchQuery<'_>,
    ) -> Option<CompoundTransitionId> {
        let chart = self.chart;
        if !chart.late_draw_trees.is_empty()
            && !branches.is_empty()
            && !self.run.chooser.is_declared()
            && let Ok(found) =
                chart.late_draw_trees.binary_search_by_key(&branches.start, |deep| deep.first_branch)
        {
            return self.scan_rows(
                &chart.candidate_paths[chart.late_draw_trees[found].rows.clone()],
                0,
                search,
            );
        }
        let mut index = branches.start;
        while index < branches.end {
            let branch = &chart.branches[index];
            if let Some(weight) = branch.weight
                && !self.run.chooser.is_declared()
            {
                if let Some(found) = self.draw(index, &chart.weights[weight], search) {
                    return Some(found);
                }
                index = branch.skip;
                continue;
            }
            if !self.opens(branch, search) {
                index = branch.skip;
                continue;
            }
            if let Some(id) = branch.compound
                && self.accepts(id, search)
            {
                return Some(id);
            }
            index += 1;
        }
        None
    }

    #[inline]
    fn opens(&mut self, branch: &SegmentNode, search: BranchQuery<'_>) -> bool {
        let holds = match branch.condition {
            EnablingCondition::None => true,
            EnablingCondition::Completed if search.is_complete => true,
            _ => self.condition_holds(branch, search),
        };
        holds && branch.guard.is_none_or(|guard| self.evaluate_guard(guard))
    }

    /// Whether a complete path is not blocked by a running activity.
    #[inline]
    fn accepts(&mut self, id: CompoundTransitionId, search: BranchQuery<'_>) -> bool {
        let Some(node) = search.state else { return true };
        if !self.is_blocked(self.compound(id)) {
            return true;
        }
        if search.occurrence.is_some() {
            self.note_blocked(id, node);
        }
        false
    }

    pub(crate) fn condition_holds(&self, branch: &SegmentNode, search: BranchQuery<'_>) -> bool {
        self.allows(branch.condition, search)
    }

    fn allows(&self, condition: EnablingCondition, search: BranchQuery<'_>) -> bool {
        let chart = self.chart;
        let (Some(node), occurrence) = (search.state, search.occurrence) else { return true };
        match condition {
            EnablingCondition::None => true,
            EnablingCondition::Trigger(trigger) => {
                occurrence.is_some_and(|occurrence| matches(&chart.triggers[trigger], occurrence))
            }
            EnablingCondition::Arrival(index) => self.may_arrive(&chart.arrivals[index], node, occurrence),
            _ if occurrence.is_some() => false,
            EnablingCondition::Always => true,
            EnablingCondition::Completed => search.is_complete || self.run.is_complete(chart, node),
            EnablingCondition::Quiescent => !self.has_running_inside(node) && !self.can_step_inside(node),
            EnablingCondition::NoStepInside => !self.can_step_inside(node),
            EnablingCondition::AllCompleted(join) => self.can_join(join),
        }
    }

    fn may_arrive(
        &self,
        condition: &ArrivalCondition,
        node: NodeIndex,
        occurrence: Option<&PoppedEvent>,
    ) -> bool {
        let is_due = match (condition.trigger, occurrence) {
            (Some(trigger), Some(occurrence)) => matches(&self.chart.triggers[trigger], occurrence),
            (None, None) => self.run.is_complete(self.chart, node),
            _ => false,
        };
        is_due
            && !self.run.arrived.contains(condition.slot)
            && self.others_arrive(condition.slot) == condition.passes
    }

    /// Chooses among the weighted branches if the given one is the first of them that matches; the
    /// choice is among whole segments. One that is not enabled is removed, and the choice is
    /// repeated. A choice is kept within the micro-step: a node that is reached again keeps its
    /// choice.
    fn draw(
        &mut self,
        index: usize,
        weight: &BranchWeight,
        search: BranchQuery<'_>,
    ) -> Option<CompoundTransitionId> {
        let mut lots = self.weighted_segments(weight.siblings, search);
        if lots.first().is_none_or(|first| first.first != index) {
            return None;
        }
        let mut known = 0;
        while !lots.is_empty() {
            let branch = lots.remove(self.next_weighted_segment(&lots, &mut known));
            let found = self.try_segment(branch, weight.siblings.end, search);
            if found.is_some() {
                return found;
            }
        }
        None
    }

    /// The segment chosen earlier in this micro-step or, if that is no longer available, a new
    /// choice. Those before `known` were examined.
    fn next_weighted_segment(&mut self, lots: &[WeightedSegment], known: &mut usize) -> usize {
        while let Some(&drawn) = self.run.drawn_segments.get(*known) {
            *known += 1;
            if let Some(index) = lots.iter().position(|branch| branch.segment == drawn) {
                return index;
            }
        }
        let weights: SmallVec<[f64; 8]> = lots.iter().map(|branch| branch.weight).collect();
        let index = self.run.chooser.draw(&weights);
        self.run.drawn_segments.push(lots[index].segment);
        *known += 1;
        index
    }

    /// The matching weighted segments, in order.
    fn weighted_segments(
        &self,
        beside: BranchRange,
        search: BranchQuery<'_>,
    ) -> SmallVec<[WeightedSegment; 8]> {
        let mut lots: SmallVec<[WeightedSegment; 8]> = SmallVec::new();
        let mut index = beside.start;
        while index < beside.end {
            let branch = &self.chart.branches[index];
            if let Some(BranchWeight { value, segment, .. }) =
                branch.weight.map(|weight| &self.chart.weights[weight])
                && lots.last().is_none_or(|last| last.segment != *segment)
                && self.condition_holds(branch, search)
            {
                lots.push(WeightedSegment { segment: *segment, first: index, weight: *value });
            }
            index = branch.skip;
        }
        lots
    }

    /// Tries all paths that begin with a segment: its branches, which are contiguous.
    fn try_segment(
        &mut self,
        weighted: WeightedSegment,
        end: usize,
        search: BranchQuery<'_>,
    ) -> Option<CompoundTransitionId> {
        let chart = self.chart;
        let mut index = weighted.first;
        while index < end {
            let branch = &chart.branches[index];
            let segment = branch.weight.map(|weight| chart.weights[weight].segment);
            if segment != Some(weighted.segment) {
                return None;
            }
            if self.opens(branch, search) {
                let found = match branch.compound {
                    Some(id) => self.accepts(id, search).then_some(id),
                    None => self.scan(BranchRange { start: index + 1, end: branch.skip }, search),
                };
                if found.is_some() {
                    return found;
                }
            }
            index = branch.skip;
        }
        None
    }

    /// The first enabled path, where paths are examined one by one: all have equal segments up to
    /// `depth`, and those with equal next segments are contiguous.
    fn scan_rows(
        &mut self,
        rows: &[CandidatePath],
        depth: usize,
        search: BranchQuery<'_>,
    ) -> Option<CompoundTransitionId> {
        let chart = self.chart;
        let segment =
            |row: &CandidatePath| chart.compounds[row.compound.0 as usize].segments.get(depth).copied();
        let alternatives: SmallVec<[&[CandidatePath]; 8]> =
            rows.chunk_by(|a, b| segment(a) == segment(b)).collect();
        let mut is_drawn = false;
        for alternative in alternatives.iter().copied() {
            let found = match self.weight_of(alternative, depth) {
                None => self.scan_behind(alternative, depth, search),
                Some(_) if is_drawn || !self.any_path_matches(alternative, depth, search) => None,
                Some(_) => {
                    is_drawn = true;
                    self.draw_rows(&alternatives, rows, depth, search)
                }
            };
            if found.is_some() {
                return found;
            }
        }
        None
    }

    fn weight_of(&self, alternative: &[CandidatePath], depth: usize) -> Option<(TransitionId, f64)> {
        let row = alternative.first()?;
        let segment = *self.chart.compounds[row.compound.0 as usize].segments.get(depth)?;
        Some((segment, self.chart.statechart().transition(segment).weight?))
    }

    /// Whether a weighted segment takes part in the choice: at a state if one of its paths may be
    /// taken, at a connector always.
    fn any_path_matches(&self, alternative: &[CandidatePath], depth: usize, search: BranchQuery<'_>) -> bool {
        depth > 0 || alternative.iter().any(|row| self.allows(row.condition, search))
    }

    /// Continues behind a segment shared by some paths, or tries the path that ends with it.
    fn scan_behind(
        &mut self,
        rows: &[CandidatePath],
        depth: usize,
        search: BranchQuery<'_>,
    ) -> Option<CompoundTransitionId> {
        let [row] = rows else { return self.scan_rows(rows, depth + 1, search) };
        if row.guards.len() > depth + 1 {
            return self.scan_rows(rows, depth + 1, search);
        }
        (self.prefix_is_open(row, row.guards.len().min(depth + 1), search)
            && self.accepts(row.compound, search))
        .then_some(row.compound)
    }

    /// Whether the first `segments` segments of a path are enabled.
    fn prefix_is_open(&mut self, row: &CandidatePath, segments: usize, search: BranchQuery<'_>) -> bool {
        self.allows(row.condition, search)
            && row.guards[..segments].iter().flatten().all(|&guard| self.evaluate_guard(guard))
    }

    /// Chooses among weighted segments behind a connector, if that is reached at all.
    fn draw_rows(
        &mut self,
        alternatives: &[&[CandidatePath]],
        rows: &[CandidatePath],
        depth: usize,
        search: BranchQuery<'_>,
    ) -> Option<CompoundTransitionId> {
        if depth > 0 && !rows.iter().any(|row| self.prefix_is_open(row, depth, search)) {
            return None;
        }
        let mut lots: SmallVec<[WeightedSegment; 8]> = SmallVec::new();
        for (first, alternative) in alternatives.iter().enumerate() {
            if let Some((segment, weight)) = self.weight_of(alternative, depth)
                && self.any_path_matches(alternative, depth, search)
            {
                lots.push(WeightedSegment { segment, first, weight });
            }
        }
        let mut known = 0;
        while !lots.is_empty() {
            let branch = lots.remove(self.next_weighted_segment(&lots, &mut known));
            let found = self.scan_behind(alternatives[branch.first], depth, search);
            if found.is_some() {
                return found;
            }
        }
        None
    }
}
