//! Which way out of a node is taken: the first that is open, or one drawn among those with a weight.

use smallvec::SmallVec;

use crate::chart::{Branch, Branches, CompoundId, Condition, Place, Row, Weight};
use crate::host::Host;
use crate::machine::queues::Occurrence;
use crate::machine::select::matches;
use crate::machine::step::Step;
use crate::statechart::TransitionId;

/// For what a way is looked for: a state, and the event that is offered, if any. Behind actions that have been done there is no state
/// any more.
#[derive(Clone, Copy)]
pub(super) struct Search<'a> {
    pub(super) state: Option<Place>,
    pub(super) occurrence: Option<&'a Occurrence>,
}

/// One segment with a weight, the first of its branches (or its number among those beside it), and the weight.
#[derive(Clone, Copy)]
struct Lot {
    segment: TransitionId,
    first: usize,
    weight: f64,
}

impl<H: Host> Step<'_, H> {
    /// The way that is open behind actions that have been done.
    pub(super) fn open_way(&mut self, branches: Branches) -> Option<CompoundId> {
        self.scan(branches, Search { state: None, occurrence: None })
    }

    /// The first complete way whose segments are all allowed and which no running activity forbids. Branches with a weight are drawn, all of
    /// them where the first one stands, unless what is declared first is to be taken.
    pub(super) fn scan(&mut self, branches: Branches, search: Search<'_>) -> Option<CompoundId> {
        let chart = self.chart;
        if !chart.deep.is_empty()
            && !branches.is_empty()
            && !self.run.chooser.is_declared()
            && let Ok(found) = chart.deep.binary_search_by_key(&branches.start, |deep| deep.first_branch)
        {
            return self.scan_rows(&chart.rows[chart.deep[found].rows.clone()], 0, search);
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

    fn opens(&mut self, branch: &Branch, search: Search<'_>) -> bool {
        self.meets(branch, search) && branch.guard.is_none_or(|guard| self.holds(guard))
    }

    /// Whether a complete way is not kept back by a running activity.
    fn accepts(&mut self, id: CompoundId, search: Search<'_>) -> bool {
        let Some(place) = search.state else { return true };
        if !self.is_blocked(self.compound(id)) {
            return true;
        }
        if search.occurrence.is_some() {
            self.note_blocked(id, place);
        }
        false
    }

    pub(super) fn meets(&self, branch: &Branch, search: Search<'_>) -> bool {
        self.allows(branch.condition, search)
    }

    fn allows(&self, condition: Condition, search: Search<'_>) -> bool {
        let chart = self.chart;
        let (Some(place), occurrence) = (search.state, search.occurrence) else { return true };
        match condition {
            Condition::None => true,
            Condition::Trigger(trigger) => {
                occurrence.is_some_and(|occurrence| matches(&chart.triggers[trigger], occurrence))
            }
            _ if occurrence.is_some() => false,
            Condition::Always => true,
            Condition::Completed => self.run.is_complete(chart, place),
            Condition::Quiescent => !self.runs_inside(place) && !self.can_step_inside(place),
            Condition::NoStepInside => !self.can_step_inside(place),
            Condition::AllCompleted(join) => self.can_join(join),
            Condition::Arrives(slot) => {
                !self.run.arrived.contains(slot) && self.run.is_complete(chart, place)
            }
            Condition::AllArrived(join) => {
                chart.joins[join].slots().all(|slot| self.run.arrived.contains(slot))
            }
        }
    }

    /// Draws among the branches with a weight if the given one is the first of them that matches; it is those of whole segments that are
    /// drawn. One that is not open is taken out, and the rest is drawn again. What was drawn stays drawn within the micro-step: a node that is
    /// come by again is not drawn at again.
    fn draw(&mut self, index: usize, weight: &Weight, search: Search<'_>) -> Option<CompoundId> {
        let mut lots = self.lots(weight.beside, search);
        if lots.first().is_none_or(|first| first.first != index) {
            return None;
        }
        let mut known = 0;
        while !lots.is_empty() {
            let lot = lots.remove(self.next_lot(&lots, &mut known));
            let found = self.try_segment(lot, weight.beside.end, search);
            if found.is_some() {
                return found;
            }
        }
        None
    }

    /// The one that was drawn earlier in this micro-step or, if there is none left, one that is drawn now. Those before `known` were
    /// looked at.
    fn next_lot(&mut self, lots: &[Lot], known: &mut usize) -> usize {
        while let Some(&drawn) = self.run.drawn.get(*known) {
            *known += 1;
            if let Some(index) = lots.iter().position(|lot| lot.segment == drawn) {
                return index;
            }
        }
        let weights: SmallVec<[f64; 8]> = lots.iter().map(|lot| lot.weight).collect();
        let index = self.run.chooser.draw(&weights);
        self.run.drawn.push(lots[index].segment);
        *known += 1;
        index
    }

    /// The segments with a weight that match, in order.
    fn lots(&self, beside: Branches, search: Search<'_>) -> SmallVec<[Lot; 8]> {
        let mut lots: SmallVec<[Lot; 8]> = SmallVec::new();
        let mut index = beside.start;
        while index < beside.end {
            let branch = &self.chart.branches[index];
            if let Some(Weight { value, segment, .. }) =
                branch.weight.map(|weight| &self.chart.weights[weight])
                && lots.last().is_none_or(|last| last.segment != *segment)
                && self.meets(branch, search)
            {
                lots.push(Lot { segment: *segment, first: index, weight: *value });
            }
            index = branch.skip;
        }
        lots
    }

    /// Tries all ways that begin with a segment: its branches, which stand beside each other.
    fn try_segment(&mut self, lot: Lot, end: usize, search: Search<'_>) -> Option<CompoundId> {
        let chart = self.chart;
        let mut index = lot.first;
        while index < end {
            let branch = &chart.branches[index];
            let segment = branch.weight.map(|weight| chart.weights[weight].segment);
            if segment != Some(lot.segment) {
                return None;
            }
            if self.opens(branch, search) {
                let found = match branch.compound {
                    Some(id) => self.accepts(id, search).then_some(id),
                    None => self.scan(Branches { start: index + 1, end: branch.skip }, search),
                };
                if found.is_some() {
                    return found;
                }
            }
            index = branch.skip;
        }
        None
    }

    /// The first of some ways that is open, where they are gone through one by one: all begin with the same segments up to `depth`, and those
    /// that go on alike stand beside each other.
    fn scan_rows(&mut self, rows: &[Row], depth: usize, search: Search<'_>) -> Option<CompoundId> {
        let chart = self.chart;
        let segment = |row: &Row| chart.compounds[row.compound.0 as usize].segments.get(depth).copied();
        let alternatives: SmallVec<[&[Row]; 8]> = rows.chunk_by(|a, b| segment(a) == segment(b)).collect();
        let mut is_drawn = false;
        for alternative in alternatives.iter().copied() {
            let found = match self.weight_of(alternative, depth) {
                None => self.go_on(alternative, depth, search),
                Some(_) if is_drawn || !self.matches_somewhere(alternative, depth, search) => None,
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

    fn weight_of(&self, alternative: &[Row], depth: usize) -> Option<(TransitionId, f64)> {
        let row = alternative.first()?;
        let segment = *self.chart.compounds[row.compound.0 as usize].segments.get(depth)?;
        Some((segment, self.chart.statechart().transition(segment).weight?))
    }

    /// Whether a segment is one to draw: at a state if it may be taken by one of its ways, at a connector always.
    fn matches_somewhere(&self, alternative: &[Row], depth: usize, search: Search<'_>) -> bool {
        depth > 0 || alternative.iter().any(|row| self.allows(row.condition, search))
    }

    /// Goes on behind a segment that all of some ways have, or tries the one that ends with it.
    fn go_on(&mut self, rows: &[Row], depth: usize, search: Search<'_>) -> Option<CompoundId> {
        let [row] = rows else { return self.scan_rows(rows, depth + 1, search) };
        if row.guards.len() > depth + 1 {
            return self.scan_rows(rows, depth + 1, search);
        }
        (self.leads_so_far(row, depth + 1, search) && self.accepts(row.compound, search))
            .then_some(row.compound)
    }

    /// Whether so many segments of a way are open.
    fn leads_so_far(&mut self, row: &Row, segments: usize, search: Search<'_>) -> bool {
        self.allows(row.condition, search)
            && row.guards[..segments].iter().flatten().all(|&guard| self.holds(guard))
    }

    /// Draws among segments with a weight behind a connector, if that is come by at all.
    fn draw_rows(
        &mut self,
        alternatives: &[&[Row]],
        rows: &[Row],
        depth: usize,
        search: Search<'_>,
    ) -> Option<CompoundId> {
        if depth > 0 && !rows.iter().any(|row| self.leads_so_far(row, depth, search)) {
            return None;
        }
        let mut lots: SmallVec<[Lot; 8]> = SmallVec::new();
        for (first, alternative) in alternatives.iter().enumerate() {
            if let Some((segment, weight)) = self.weight_of(alternative, depth)
                && self.matches_somewhere(alternative, depth, search)
            {
                lots.push(Lot { segment, first, weight });
            }
        }
        let mut known = 0;
        while !lots.is_empty() {
            let lot = lots.remove(self.next_lot(&lots, &mut known));
            let found = self.go_on(alternatives[lot.first], depth, search);
            if found.is_some() {
                return found;
            }
        }
        None
    }
}
