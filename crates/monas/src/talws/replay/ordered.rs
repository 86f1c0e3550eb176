//! Changes of an agent in real time, made again where its thread was told to follow them.

use std::collections::VecDeque;
use std::sync::Arc;

use narukom::Moment;

use super::super::crew::{Crew, Ground, Member, part};
use super::super::management::{Roster, Staff};
use super::super::orders::{Asked as ByWhom, Orders, Standing};
use super::changes::refuse_in_real_time;
use super::repeated::Repeated;
use crate::agent::Profile;
use crate::error::{Error, ErrorKind};
use crate::records::{Action, AgentEntry, Asked, Change, Changed, Cycle};

/// What an agent was asked, and what it is made of by now.
pub(super) struct Ordered {
    roster: Roster,
    thread: Thread,
    /// What it was asked and has not followed, in the order in which it was.
    asked: VecDeque<Request>,
    /// The recording tells where changes were made.
    is_told: bool,
    /// A change was made, nobody knows where: why that cannot be replayed, and how many turns may begin before that is certain.
    untold: Option<(Error, u32)>,
}

/// Which of an agent's threads repeats its turns.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Thread {
    /// The place of its chart; none for the list.
    pub(super) place: Option<usize>,
    /// How many charts the agent has,
    pub(super) charts: usize,
    /// whether it has a list,
    pub(super) has_list: bool,
    /// and whether it has one sooner or later.
    pub(super) lists: bool,
}

impl Thread {
    /// As which part of its agent it publishes.
    pub(super) fn part(self) -> u16 {
        part(self.place.unwrap_or(self.charts))
    }

    /// What it runs of an agent that has as many charts; else none.
    fn of(self, agent: Member) -> Option<Member> {
        let Member { list, mut charts, .. } = agent;
        let is_same = charts.len() == self.charts;
        let (list, charts) = match self.place.filter(|_| is_same) {
            Some(place) => (None, vec![charts.swap_remove(place)]),
            None => (list, Vec::new()),
        };
        is_same.then_some(Member { list, charts, ..agent })
    }

    /// Whether the agent has others sooner or later, with which it counts its cycles: a list that begins counts before anybody is told of it.
    pub(super) fn counts_with_others(self) -> bool {
        self.charts + usize::from(self.lists) > 1
    }

    /// Whether the agent has others.
    fn has_siblings(self) -> bool {
        self.charts + usize::from(self.has_list) > 1
    }
}

/// A change and the message that asked for it.
struct Request {
    publisher: String,
    sequence: u32,
    change: Change,
}

impl Ordered {
    pub(super) fn new(
        ground: Ground,
        crew: Arc<Crew>,
        profile: Profile,
        thread: Thread,
    ) -> Result<Ordered, Error> {
        let roster = Roster::new(ground, crew, vec![profile], None)?;
        Ok(Ordered { roster, thread, asked: VecDeque::new(), is_told: false, untold: None })
    }

    /// Somebody asked for a change.
    pub(super) fn ask(&mut self, publisher: &str, sequence: u32, change: Change) {
        self.asked.push_back(Request { publisher: publisher.to_owned(), sequence, change });
    }

    /// The agent has left. What it was asked before was refused.
    pub(super) fn left(&mut self, agent: &str) {
        self.roster.forget(agent);
        self.asked.retain(|request| request.change.action() == Action::AddAgents);
    }

    /// Whether nothing was asked of it that it has not followed.
    pub(super) fn is_idle(&self) -> bool {
        self.asked.is_empty()
    }

    /// The change that was answered, if the agent was not told of it.
    pub(super) fn change_of(&self, changed: &Changed) -> Option<Change> {
        self.request_of(changed).map(|place| self.asked[place].change.clone())
    }

    /// The thread of an agent that had left, as a change adds it anew.
    ///
    /// # Errors
    /// What is replayed now cannot be added like that, or the agent has another number of charts than it had.
    pub(super) fn anew(
        &mut self,
        change: &Change,
        agent: &str,
        repeated: &mut Repeated,
        now: Moment,
    ) -> Result<Member, Error> {
        let mut staff = Again::of(change, self.thread, repeated, now);
        let changed = self.roster.bring_back(change, &[agent.to_owned()], &mut staff, now);
        let begun =
            staff.begun.ok_or_else(|| refused(&Changed { agent: agent.to_owned(), ..changed }, now))?;
        self.thread.has_list = begun.list.is_some();
        self.thread.of(begun).ok_or_else(|| came_back_otherwise(agent, now))
    }

    /// A change was made, or refused, at a moment.
    ///
    /// # Errors
    /// It gave the agent one thread more, and the recording does not tell what that began with.
    pub(super) fn answered(
        &mut self,
        changed: &Changed,
        repeated: &mut Repeated,
        at: Moment,
    ) -> Result<(), Error> {
        let adds = matches!(changed.action(), Action::AddActivity | Action::LoadModule);
        let begins_list = changed.done && adds && !self.thread.has_list;
        if begins_list && self.thread.place.is_none() {
            return Err(begun_late(&changed.agent, at));
        }
        let waits = matches!(repeated, Repeated::Waiting(_));
        if begins_list || waits || self.thread.has_siblings() {
            self.note(changed, repeated, at);
            self.thread.has_list |= begins_list;
            let refused = self.request_of(changed).filter(|_| waits && !changed.done);
            refused.and_then(|place| self.asked.remove(place));
            return Ok(());
        }
        let is_list = matches!(repeated, Repeated::List(_));
        // Whoever answers waits a second for a thread that is busy: a chart may end the turn that it is in.
        let patience = if is_list { 0 } else { 1 };
        if !self.is_told && self.untold.is_none() {
            self.untold = refuse_in_real_time(changed, is_list, at).err().map(|error| (error, patience));
        }
        Ok(())
    }

    /// If a change concerned other threads of the agent, this one has not been told, and the agent is made of something else all the same.
    fn note(&mut self, changed: &Changed, repeated: &mut Repeated, at: Moment) {
        let place = self.request_of(changed).filter(|_| changed.done);
        // How agents leave and come is told elsewhere.
        let comes_or_goes = matches!(changed.action(), Action::AddAgents | Action::RemoveAgent);
        let Some(place) = place.filter(|_| !comes_or_goes) else { return };
        let Request { change, .. } = &self.asked[place];
        let mut staff = Again { is_bystander: true, ..Again::of(change, self.thread, repeated, at) };
        if self.roster.repeat(change, &mut staff, at).done {
            self.asked.remove(place);
        }
    }

    /// Where the change that was answered stands among those that were not followed.
    fn request_of(&self, changed: &Changed) -> Option<usize> {
        let is_it = |request: &Request| {
            (request.change.number, request.change.action) == (changed.number, changed.action)
        };
        self.asked.iter().position(is_it)
    }

    /// A turn begins.
    ///
    /// # Errors
    /// A change was made before it, and the recording does not tell where.
    pub(super) fn begin_turn(&mut self) -> Result<(), Error> {
        match self.untold.take() {
            Some((error, 0)) => Err(error),
            untold => {
                self.untold = untold.map(|(error, patience)| (error, patience - 1));
                Ok(())
            }
        }
    }

    /// The change that the agent was told to follow here, or that added it.
    ///
    /// # Errors
    /// The recording lacks it.
    pub(super) fn ordered_by(&mut self, record: &Cycle) -> Result<Change, Error> {
        (self.is_told, self.untold) = (true, None);
        let asked = record.asked.clone().unwrap_or_default();
        self.taken(&asked).ok_or_else(|| lacking(&asked))
    }

    /// The agent follows a change again.
    ///
    /// # Errors
    /// What is replayed now cannot be changed like that.
    pub(super) fn follow(
        &mut self,
        change: &Change,
        repeated: &mut Repeated,
        now: Moment,
    ) -> Result<(), Error> {
        let mut staff = Again::of(change, self.thread, repeated, now);
        let changed = self.roster.repeat(change, &mut staff, now);
        let was_told = staff.was_told;
        self.thread.has_list |= matches!(repeated, Repeated::List(_));
        if was_told { Ok(()) } else { Err(refused(&changed, now)) }
    }

    /// What was asked of a module was answered. An agent that was told has followed by now; for any other the module changes what names mean.
    ///
    /// # Errors
    /// The module is not what it was.
    pub(super) fn equip(
        &mut self,
        changed: &Changed,
        repeated: &mut Repeated,
        now: Moment,
    ) -> Result<(), Error> {
        let request = self.request_of(changed).and_then(|place| self.asked.remove(place));
        let Some(Request { change, .. }) = request.filter(|_| changed.done) else { return Ok(()) };
        let mut staff = Again::of(&change, self.thread, repeated, now);
        let again = self.roster.repeat(&change, &mut staff, now);
        if again.done { Ok(()) } else { Err(refused(&again, now)) }
    }

    /// The change that this message asked for. Those before it were refused: they are made in their order.
    fn taken(&mut self, asked: &Asked) -> Option<Change> {
        // Of the numbers of messages a recording has the lower 32 bits.
        let sequence = asked.sequence as u32;
        let is_it = |request: &Request| request.publisher == asked.publisher && request.sequence == sequence;
        let place = self.asked.iter().position(is_it)?;
        self.asked.drain(..=place).next_back().map(|request| request.change)
    }
}

/// The agent, while it is changed.
struct Again<'a> {
    action: Action,
    repeated: &'a mut Repeated,
    now: Moment,
    /// It is about one chart.
    is_of_chart: bool,
    thread: Thread,
    /// It follows nothing that is for itself.
    is_bystander: bool,
    was_told: bool,
    /// It had left, and begins anew as this.
    begun: Option<Member>,
}

impl<'a> Again<'a> {
    fn of(change: &Change, thread: Thread, repeated: &'a mut Repeated, now: Moment) -> Again<'a> {
        let (action, is_of_chart) = (change.action(), !change.chart.is_empty());
        Again {
            action,
            repeated,
            now,
            is_of_chart,
            thread,
            is_bystander: false,
            was_told: false,
            begun: None,
        }
    }
}

impl Staff for Again<'_> {
    /// It was told, so it stood as it must.
    fn standing(&self, _: &str) -> Standing {
        match self.action {
            Action::StartAgent if !self.is_of_chart => Standing::Stopped,
            Action::ResumeAgent | Action::StepAgent => Standing::Pauses,
            _ => Standing::Runs,
        }
    }

    fn standing_of_chart(&self, _: &str, _: usize) -> Standing {
        if self.action == Action::StartAgent { Standing::Stopped } else { Standing::Runs }
    }

    fn told(&self, agent: &str, _: usize) -> Result<Vec<String>, String> {
        Err(format!("`{agent}` is replayed"))
    }

    fn has_list(&self, _: &str) -> bool {
        self.thread.has_list
    }

    fn cycles(&self, _: &str) -> u64 {
        0
    }

    fn obey(&mut self, _: &str, mut orders: Orders) -> Result<Vec<String>, Vec<String>> {
        let Thread { place, charts, has_list, .. } = self.thread;
        if let (Repeated::Waiting(_), Some(list)) = (&self.repeated, orders.list.take()) {
            if self.is_bystander {
                return Err(vec!["the thread follows later".into()]);
            }
            self.was_told = true;
            return self.repeated.begin(*list).map(|()| Vec::new()).map_err(|error| vec![error.to_string()]);
        }
        let own = orders.shares(has_list, charts).into_iter().find(|share| share.place == place);
        match own {
            Some(_) if self.is_bystander => Err(vec!["the thread follows later".into()]),
            Some(share) => {
                self.was_told = true;
                self.repeated.obey(share.orders, self.now)
            }
            None => Ok(Vec::new()),
        }
    }

    fn launch(&mut self, member: Member, _: Option<&ByWhom>) -> Result<(), String> {
        self.begun = Some(member);
        Ok(())
    }

    fn dismiss(&mut self, agent: &str) -> Result<(), String> {
        Err(format!("`{agent}` has no turn in which it leaves"))
    }

    fn entry(&self, _: &Profile) -> AgentEntry {
        AgentEntry::default()
    }
}

fn lacking(asked: &Asked) -> Error {
    let Asked { publisher, sequence } = asked;
    let message = format!("the recording lacks change {sequence} of `{publisher}`, which an agent followed");
    let hint = "agents are changed as they were then: only a recording of all topics can be replayed";
    Error::new(ErrorKind::Invalid, message).with_hint(hint)
}

fn came_back_otherwise(agent: &str, at: Moment) -> Error {
    let message = format!(
        "agent `{agent}` came back {:.3} s after the run began, with another number of charts: what a thread that begins then is given is \
         not repeated",
        at.as_secs_f64()
    );
    Error::new(ErrorKind::Invalid, message).with_hint("replay other agents, or the time before")
}

fn begun_late(agent: &str, at: Moment) -> Error {
    let message = format!(
        "agent `{agent}` was given its first activity {:.3} s after the run began: the recording, of an earlier version, does not tell what \
         the list began with",
        at.as_secs_f64()
    );
    Error::new(ErrorKind::Invalid, message).with_hint("replay other agents, or the time before")
}

fn refused(changed: &Changed, at: Moment) -> Error {
    let finding = changed.findings.first();
    let reason = finding.map_or("it is none that an agent follows", |finding| finding.message.as_str());
    let message = format!(
        "what was asked of agent `{}` {:.3} s after the run began cannot be made again: {reason}",
        changed.agent,
        at.as_secs_f64()
    );
    let error = Error::new(ErrorKind::Invalid, message);
    match finding.filter(|finding| !finding.hint.is_empty()) {
        Some(finding) => error.with_hint(&finding.hint),
        None => error,
    }
}
