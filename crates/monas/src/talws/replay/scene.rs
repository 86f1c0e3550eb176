//! A host in a replay: agents that run, between the messages of those that do not.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};

use narukom::{Moment, Narukom, Observer, Publication, TopicSlot};

use super::super::ENDED;
use super::super::crew::Crew;
use super::super::instance::Instance;
use super::super::management::Roster;
use super::super::moved::Moved;
use super::super::setup::Station;
use super::changes::{Replayed, added, concerning};
use super::compare::{Ledger, Window};
use super::{Company, Difference};
use crate::error::{Error, ErrorKind};
use crate::logger::Simulating;
use crate::records::{Action, Change, Changed};

/// A message that was published in the replay.
pub(super) struct Produced {
    pub(super) host: String,
    pub(super) publisher: String,
    pub(super) topic: TopicSlot,
    pub(super) bytes: Vec<u8>,
}

/// Sees what agents publish.
#[derive(Clone, Default)]
pub(super) struct Spy(Arc<Mutex<Seen>>);

#[derive(Default)]
struct Seen {
    /// Nobody is to be seen: what is published comes from the recording.
    is_mute: bool,
    produced: Vec<Produced>,
}

impl Spy {
    pub(super) fn mute(&self, is_mute: bool) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).is_mute = is_mute;
    }

    pub(super) fn take(&self) -> Vec<Produced> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner).produced)
    }

    /// What is published while `act` acts.
    fn watch(&self, act: impl FnOnce()) -> Vec<Produced> {
        self.mute(false);
        act();
        self.mute(true);
        self.take()
    }
}

impl Observer for Spy {
    fn observe(&mut self, publication: Publication<'_>) {
        let mut seen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if !seen.is_mute {
            seen.produced.push(Produced {
                host: publication.host.to_owned(),
                publisher: publication.publisher.to_owned(),
                topic: publication.sample.header.topic,
                bytes: publication.bytes().to_vec(),
            });
        }
    }
}

/// A host.
pub(super) struct Scene {
    pub(super) hub: Narukom,
    moved: Moved,
    roster: Roster,
    /// Agents that were removed.
    gone: Vec<String>,
    /// The number of the change by which the last of them came back.
    returned_by: Option<u64>,
    /// Why the replay cannot go on.
    refused: Option<Error>,
    actors: Vec<Actor>,
    /// The names of all agents, replayed or not, in the order of their turns.
    places: Vec<String>,
    /// Whose turn it is: a place.
    turn: Option<usize>,
    pub(super) now: Moment,
    /// Nothing has run yet: what agents say of themselves before that is nobody's turn.
    is_setting_up: bool,
    /// The recorded run has ended.
    has_ended: bool,
}

/// An agent that runs.
pub(super) struct Actor {
    place: usize,
    pub(super) instance: Instance,
    /// What it published at this moment, then and now.
    window: Window,
}

impl Scene {
    pub(super) fn new(station: Station, crew: &Arc<Crew>, company: &[Company]) -> Result<Scene, Error> {
        let Station { hub, members, ground, profiles, configuration, .. } = station;
        let moved = Moved::default();
        hub.set_waker(Arc::new(moved.noting()));
        let others = company.iter().filter(|one| one.is_agent && one.host == hub.host());
        let names: BTreeSet<String> = others
            .map(|one| one.publisher.clone())
            .chain(members.iter().map(|member| member.name.clone()))
            .collect();
        let places: Vec<String> = names.into_iter().collect();
        let actor = |member: super::super::crew::Member| {
            let place = places.binary_search(&member.name).unwrap_or_default();
            let window = Window::new(hub.host(), &member.name);
            Actor { place, instance: Instance::new(member, Moment::ZERO), window }
        };
        let actors = members.into_iter().map(actor).collect();
        Ok(Scene {
            roster: Roster::new(ground, crew.clone(), profiles, configuration)?,
            hub,
            moved,
            gone: Vec::new(),
            returned_by: None,
            refused: None,
            actors,
            places,
            turn: None,
            now: Moment::ZERO,
            is_setting_up: true,
            has_ended: false,
        })
    }

    /// The number of a replayed agent.
    pub(super) fn actor(&self, name: &str) -> Option<usize> {
        self.actors.iter().position(|actor| actor.instance.name() == name)
    }

    /// The place of an agent, replayed or not.
    pub(super) fn place(&self, name: &str) -> Option<usize> {
        self.places.binary_search_by(|other| other.as_str().cmp(name)).ok()
    }

    /// An agent said something of itself before anything ran.
    pub(super) fn was_set_up(&mut self, produced: &Produced) {
        if let Some(actor) = self.actor(&produced.publisher) {
            self.actors[actor].window.produced(produced.topic, produced.bytes.clone());
        }
    }

    /// Lets everything happen that is due before a moment, and begins that moment.
    pub(super) fn reach(
        &mut self,
        moment: Moment,
        spy: &Spy,
        ledger: &mut Ledger,
        told: &mut dyn FnMut(Difference),
    ) {
        while self.now < moment {
            Simulating::pass(self.now);
            self.settle(spy, ledger, told);
            // What was asked for now and was not then; it may give agents something to do at this moment.
            self.attend(spy);
            self.now = if self.has_ended { moment } else { self.due().clamp(self.now, moment) };
            self.turn = None;
        }
        Simulating::pass(self.now);
    }

    /// Makes the changes again that were published since the last time, if they are about agents that are replayed.
    pub(super) fn attend(&mut self, spy: &Spy) {
        while let Some(change) = self.roster.next_asked().filter(|_| !self.has_ended) {
            if !self.gone.is_empty() {
                self.bring_back(&change, spy);
            }
            if let Some(change) = concerning(&change, |agent| self.roster.knows(agent)) {
                self.repeat(&change, spy);
            }
        }
    }

    fn repeat(&mut self, change: &Change, spy: &Spy) {
        let is_done = self.make(spy, |roster, staff, now| roster.repeat(change, staff, now));
        if is_done && change.action() == Action::RemoveAgent {
            self.gone.push(change.agent.clone());
        }
    }

    /// Agents that left begin again if the change adds them.
    fn bring_back(&mut self, change: &Change, spy: &Spy) {
        let names = added(change, self.roster.registry());
        let back: Vec<String> = self.gone.iter().filter(|gone| names.contains(gone)).cloned().collect();
        if back.is_empty() {
            return;
        }
        if self.make(spy, |roster, staff, now| roster.bring_back(change, &back, staff, now)) {
            self.gone.retain(|gone| !back.contains(gone));
            self.returned_by = Some(change.number);
        }
    }

    /// Makes a change; false if it cannot be made.
    fn make(
        &mut self,
        spy: &Spy,
        make: impl FnOnce(&mut Roster, &mut Replayed<'_>, Moment) -> Changed,
    ) -> bool {
        self.is_setting_up = false;
        let now = self.now;
        let mut staff = Replayed { host: self.hub.host(), actors: &mut self.actors, now };
        let mut is_done = false;
        let produced = spy.watch(|| is_done = make(&mut self.roster, &mut staff, now).done);
        for one in produced {
            if let Some(actor) = self.actor(&one.publisher) {
                self.actors[actor].window.produced(one.topic, one.bytes);
            }
        }
        self.wake();
        is_done
    }

    /// This is what was answered when agents came back: it may have been refused for the sake of one that is not replayed.
    pub(super) fn answered(&mut self, changed: &Changed) {
        let is_it = changed.action() == Action::AddAgents && self.returned_by == Some(changed.number);
        if is_it && !changed.done {
            let message = "agents that left were refused when somebody added them anew, because of others that are not replayed";
            let error = Error::new(ErrorKind::Invalid, message).with_hint("replay all agents of the host");
            self.refused.get_or_insert(error);
        }
        if is_it {
            self.returned_by = None;
        }
    }

    /// # Errors
    /// Something was recorded that cannot be replayed.
    pub(super) fn check(&mut self) -> Result<(), Error> {
        self.refused.take().map_or(Ok(()), Err)
    }

    fn due(&self) -> Moment {
        self.actors.iter().map(|actor| actor.instance.due(self.now)).min().unwrap_or(Moment::MAX)
    }

    /// Lets happen what is still due at this moment, and compares.
    fn settle(&mut self, spy: &Spy, ledger: &mut Ledger, told: &mut dyn FnMut(Difference)) {
        if !self.has_ended {
            self.run_due(self.turn, None, spy);
            while self.due() <= self.now {
                self.run_due(None, None, spy);
            }
        }
        for actor in &mut self.actors {
            actor.window.compare(&self.hub, self.now, ledger, told);
        }
    }

    /// It is the turn of an agent that is not replayed, or of no agent at all.
    pub(super) fn turn_of_another(&mut self, place: Option<usize>, sets_up: bool, spy: &Spy) {
        self.is_setting_up &= sets_up;
        if let Some(place) = place.filter(|_| !self.is_setting_up) {
            self.take_turn(place, spy);
        }
    }

    /// An agent published something. If it has not done so by now it has its turn.
    pub(super) fn expect(
        &mut self,
        actor: usize,
        topic: Option<TopicSlot>,
        line: usize,
        bytes: &[u8],
        spy: &Spy,
    ) {
        let window = &mut self.actors[actor].window;
        window.recorded(topic, line, bytes.to_vec());
        if !window.is_behind() || self.has_ended {
            return;
        }
        self.is_setting_up = false;
        let place = self.actors[actor].place;
        if self.turn == Some(place) {
            // It has had its turn, and has another one when all others have had theirs.
            self.run_due(Some(place), None, spy);
            self.turn = None;
        }
        self.take_turn(place, spy);
        self.wake();
        if self.actors[actor].instance.due(self.now) <= self.now {
            self.run(actor, spy);
        }
    }

    /// Those have their turns whose turn comes before that of a place.
    fn take_turn(&mut self, place: usize, spy: &Spy) {
        if self.turn == Some(place) {
            return;
        }
        if self.turn.is_some_and(|turn| turn > place) {
            self.run_due(self.turn, None, spy);
            self.turn = None;
        }
        self.run_due(self.turn, Some(place), spy);
        self.turn = Some(place);
    }

    /// Runs those agents after a place and before another that have something to do.
    fn run_due(&mut self, after: Option<usize>, before: Option<usize>, spy: &Spy) {
        self.wake();
        for actor in 0..self.actors.len() {
            let Actor { place, instance, .. } = &self.actors[actor];
            let is_between =
                after.is_none_or(|after| *place > after) && before.is_none_or(|before| *place < before);
            if is_between && instance.due(self.now) <= self.now {
                self.run(actor, spy);
            }
        }
    }

    fn run(&mut self, actor: usize, spy: &Spy) {
        let Actor { instance, window, .. } = &mut self.actors[actor];
        let now = self.now;
        // A body that is to rest from now on is not here.
        let produced = spy.watch(|| _ = instance.run(now));
        produced.into_iter().for_each(|one| window.produced(one.topic, one.bytes));
        self.wake();
    }

    fn wake(&mut self) {
        self.moved.tell(self.actors.iter_mut().map(|actor| &mut actor.instance), self.now);
    }

    /// The recorded run was stopped now.
    pub(super) fn stop(&mut self, spy: &Spy) {
        self.has_ended = true;
        let now = self.now;
        for Actor { instance, window, .. } in &mut self.actors {
            let produced = spy.watch(|| instance.stop(ENDED, now));
            produced.into_iter().for_each(|one| window.produced(one.topic, one.bytes));
        }
    }

    /// There are no more recorded messages.
    pub(super) fn close(
        &mut self,
        is_whole: bool,
        spy: &Spy,
        ledger: &mut Ledger,
        told: &mut dyn FnMut(Difference),
    ) {
        if is_whole {
            return self.settle(spy, ledger, told);
        }
        for actor in &mut self.actors {
            actor.window.forget_what_is_ahead();
            actor.window.compare(&self.hub, self.now, ledger, told);
        }
    }
}
