//! The activities of a chart's states: who they are, which are being called, and which wait to be called again.

use std::sync::Arc;
use std::time::Duration;

use narukom::{Blackboard, Moment, Narukom, TopicSlot};
use yase::{Activation, Chart, NodeId};

use crate::activity::{Activity, Progress, Topics};
use crate::call::{self, Failure};
use crate::logger::{self, Caller};
use crate::memory::Growth;
use crate::parameters::Parameters;
use crate::statistics::{ActivityStatistics, Timing};

/// One for each BASIC state with an activity, in the order of the document.
pub(crate) struct Posts {
    posts: Vec<Post>,
    /// The place of a node's post.
    of_node: Vec<Option<usize>>,
}

struct Post {
    node: NodeId,
    name: String,
    /// Its name in log lines.
    caller: Arc<Caller>,
    duration: Duration,
    /// The topics it says it reads, in order, if it says so.
    declared: Option<Box<[TopicSlot]>>,
    /// None while it is being called.
    activity: Option<Box<dyn Activity>>,
    /// Parameters that it takes when it comes back from being called.
    parameters: Option<Parameters>,
    /// Takes its place when it comes back from being called.
    successor: Option<Box<dyn Activity>>,
    /// The number of the activation for which it is being called.
    called_for: Option<u64>,
    /// Whether `start` has been called since it was made or failed.
    started: bool,
    /// The topics on which messages have arrived while it is being called, which it has not seen.
    missed: Vec<TopicSlot>,
    /// The newest activation of its state.
    newest: Option<Activation>,
    /// The activation that waits for its next call, and when that is.
    waits: Option<Waiting>,
    calls: u64,
    timing: Timing,
    growth: Growth,
    failures: u64,
    failures_in_a_row: u32,
}

struct Waiting {
    activation: Activation,
    at: Moment,
    /// A message on one of these topics calls it earlier.
    topics: Vec<TopicSlot>,
}

/// An activity to be called, with the blackboard it works on.
pub(crate) struct Assignment {
    pub(crate) activation: Activation,
    pub(crate) priority: i32,
    /// How long it takes in simulated time.
    pub(crate) duration: Duration,
    post: usize,
    activity: Box<dyn Activity>,
    caller: Arc<Caller>,
    /// The number of the cycle from which it is called.
    cycle: u64,
    started: bool,
    blackboard: Box<Blackboard>,
    called: bool,
}

/// How long a call took, and how much of the processor's time, if that was measured.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Took {
    pub(crate) wall: Duration,
    pub(crate) cpu: Option<Duration>,
}

/// What an activity returned.
pub(crate) type Returned = Result<Progress, Failure>;

impl Assignment {
    /// Asks the activity to return soon.
    pub(crate) fn ask_to_return(&self) {
        self.blackboard.cancellation().request();
    }

    /// The place of the activity among those of the chart, as its statistics have them.
    pub(crate) fn place(&self) -> usize {
        self.post
    }

    /// The number of the cycle from which it is called, for its log lines.
    pub(crate) fn in_cycle(mut self, cycle: u64) -> Assignment {
        self.cycle = cycle;
        self
    }

    /// Calls the activity, with what it takes of the memory put down to it.
    pub(crate) fn call_counted(&mut self) -> Returned {
        let caller = self.caller.clone();
        caller.account.during(|| self.call())
    }

    /// Calls the activity, where it is.
    pub(crate) fn call(&mut self) -> Returned {
        let Assignment { activity, caller, cycle, started, blackboard, called, .. } = self;
        logger::calling(caller, *cycle, || {
            if !*started {
                call::start(activity.as_mut(), blackboard)?;
                *started = true;
            }
            *called = true;
            call::execute(activity.as_mut(), blackboard)
        })
    }
}

impl Posts {
    /// `activities` are in the order of [`Chart::activities`].
    pub(crate) fn new(
        chart: &Chart,
        activities: Vec<Box<dyn Activity>>,
        hub: &Narukom,
        agent: &str,
    ) -> Posts {
        let mut of_node = vec![None; chart.statechart().nodes().len()];
        let posts = chart.activities().zip(activities).enumerate().map(|(place, (entry, activity))| {
            of_node[entry.node.0 as usize] = Some(place);
            Post {
                node: entry.node,
                name: entry.name.into(),
                caller: Caller::new(hub.host(), agent, entry.name),
                duration: entry.duration.unwrap_or_default(),
                declared: declared(&activity.topics(), hub),
                activity: Some(activity),
                parameters: None,
                successor: None,
                called_for: None,
                started: false,
                missed: Vec::new(),
                newest: None,
                waits: None,
                calls: 0,
                timing: Timing::default(),
                growth: Growth::default(),
                failures: 0,
                failures_in_a_row: 0,
            }
        });
        Posts { posts: posts.collect(), of_node }
    }

    fn place(&self, activation: Activation) -> Option<usize> {
        self.of_node.get(activation.node.0 as usize).copied().flatten()
    }

    fn post(&mut self, activation: Activation) -> Option<&mut Post> {
        let place = self.place(activation)?;
        self.posts.get_mut(place)
    }

    /// An activation has begun.
    pub(crate) fn begin(&mut self, activation: Activation) {
        if let Some(post) = self.post(activation) {
            post.newest = Some(activation);
        }
    }

    /// Whether no activation of its state has begun since.
    pub(crate) fn is_newest(&self, activation: Activation) -> bool {
        self.place(activation).is_some_and(|place| self.posts[place].newest == Some(activation))
    }

    /// Whether its activity is not being called: there is one instance for each state.
    pub(crate) fn is_free(&self, activation: Activation) -> bool {
        self.place(activation).is_some_and(|place| self.posts[place].activity.is_some())
    }

    /// Hands out the activity of an activation, with its blackboard and how urgent it is.
    pub(crate) fn assign(
        &mut self,
        activation: Activation,
        priority: i32,
        blackboard: Box<Blackboard>,
    ) -> Option<Assignment> {
        let place = self.place(activation)?;
        let post = &mut self.posts[place];
        let activity = post.activity.take()?;
        post.waits = None;
        post.missed.clear();
        post.called_for = Some(activation.number);
        post.calls += 1;
        Some(Assignment {
            activation,
            priority,
            duration: post.duration,
            post: place,
            activity,
            caller: post.caller.clone(),
            cycle: 0,
            started: post.started,
            blackboard,
            called: false,
        })
    }

    /// Takes an activity back from where it was called, if it was, and how long that took, if anybody knows. Gives its blackboard, and the
    /// activation as it is known now, since the chart may be another one than when the call began.
    pub(crate) fn take_back(
        &mut self,
        assignment: Assignment,
        took: Option<Took>,
    ) -> (Activation, Box<Blackboard>) {
        let Assignment { activation, post, activity, started, mut blackboard, called, .. } = assignment;
        let Some(post) = self.caller(post, activation.number) else {
            return (activation, blackboard);
        };
        let newest = post.newest.filter(|newest| newest.number == activation.number);
        let activation = newest.unwrap_or(Activation { node: post.node, ..activation });
        post.called_for = None;
        (post.activity, post.started) = match post.successor.take() {
            Some(successor) => {
                post.end(activity, started, &mut blackboard);
                (Some(successor), false)
            }
            None => (Some(activity), started),
        };
        if let Some((activity, parameters)) = post.activity.as_mut().zip(post.parameters.take()) {
            call::configure_again(&post.name, &mut **activity, &parameters);
        }
        match (called, took) {
            (true, Some(took)) => {
                post.timing.add(took.wall, took.cpu);
                post.caller.has_called(&mut post.growth);
            }
            (true, None) => {}
            (false, _) => post.calls -= 1,
        }
        (activation, blackboard)
    }

    /// The activation of an activity that is being called, as it is known now.
    pub(crate) fn known_as(&self, assignment: &Assignment) -> Activation {
        let number = assignment.activation.number;
        let newest = self.posts.iter().filter_map(|post| post.newest).find(|newest| newest.number == number);
        newest.unwrap_or(assignment.activation)
    }

    /// The post from which an activity is away for an activation: the `place`th, unless the chart has changed since.
    fn caller(&mut self, place: usize, number: u64) -> Option<&mut Post> {
        let is_it = |post: &Post| post.called_for == Some(number);
        let place = match self.posts.get(place).is_some_and(is_it) {
            true => place,
            false => self.posts.iter().position(is_it)?,
        };
        self.posts.get_mut(place)
    }

    /// Puts another instance in the place of an activity: at once, or when it comes back if it is being called. Gives the one before if it waits for
    /// its next call, and for which activation.
    pub(super) fn renew(
        &mut self,
        node: NodeId,
        activity: Box<dyn Activity>,
        hub: &Narukom,
    ) -> Option<(Box<dyn Activity>, Activation)> {
        let place = self.of_node.get(node.0 as usize).copied().flatten()?;
        let post = self.posts.get_mut(place)?;
        post.declared = declared(&activity.topics(), hub);
        if post.activity.is_none() {
            post.successor = Some(activity);
            return None;
        }
        let old = post.activity.replace(activity)?;
        let was_started = std::mem::take(&mut post.started);
        let waiting = post.waits.as_ref().filter(|_| was_started)?;
        Some((old, waiting.activation))
    }

    /// Gives the activities of a name other parameters, those that are being called when they come back.
    pub(super) fn configure(&mut self, name: &str, parameters: &Parameters) {
        for post in self.posts.iter_mut().filter(|post| post.name == name) {
            match &mut post.activity {
                Some(activity) => call::configure_again(name, &mut **activity, &parameters.fresh()),
                None => post.parameters = Some(parameters.fresh()),
            }
        }
    }

    /// Takes over from the posts of a chart that this one replaces; `counterpart` says which node an old one is.
    pub(super) fn take_over(
        &mut self,
        old: Posts,
        counterpart: impl Fn(NodeId) -> Option<NodeId>,
        known: impl Fn(Activation) -> Option<Activation>,
    ) {
        for post in old.posts {
            let node = counterpart(post.node);
            let place = node.and_then(|node| self.of_node.get(node.0 as usize).copied().flatten());
            let Some(successor) = place.map(|place| &mut self.posts[place]) else { continue };
            if successor.name != post.name {
                continue;
            }
            let waits = post.waits.and_then(|waiting| {
                known(waiting.activation).map(|activation| Waiting { activation, ..waiting })
            });
            *successor = Post {
                node: successor.node,
                duration: successor.duration,
                newest: post.newest.and_then(&known),
                waits,
                ..post
            };
        }
    }

    /// The topics whose messages call a waiting activation early.
    pub(crate) fn waits_for(&self, activation: Activation) -> &[TopicSlot] {
        let post = self.place(activation).map(|place| &self.posts[place]);
        let waiting = post.and_then(|post| post.waits.as_ref());
        waiting.map_or(&[], |waiting| &waiting.topics)
    }

    /// The activation has come to its end.
    pub(crate) fn finished(&mut self, activation: Activation) {
        if let Some(post) = self.post(activation) {
            post.failures_in_a_row = 0;
        }
    }

    /// The activation is to be called again after a delay, or when a message arrives on a topic that was read on its blackboard: at once
    /// if one has during the call. The chart's guards read there too, so if the activity says what it reads, only that counts.
    pub(crate) fn wait(
        &mut self,
        activation: Activation,
        now: Moment,
        delay: Duration,
        blackboard: &Blackboard,
    ) {
        let Some(post) = self.post(activation) else { return };
        let mut topics = blackboard.topics_read();
        if let Some(declared) = &post.declared {
            topics.retain(|topic| declared.binary_search(topic).is_ok());
        }
        let missed = post.missed.iter().any(|topic| topics.contains(topic));
        let at = if missed { now } else { now + delay };
        post.failures_in_a_row = 0;
        post.waits = Some(Waiting { activation, at, topics });
    }

    /// The activation failed and is to be called again at `at`, whatever arrives.
    pub(crate) fn pause(&mut self, activation: Activation, at: Moment) {
        if let Some(post) = self.post(activation) {
            post.waits = Some(Waiting { activation, at, topics: Vec::new() });
        }
    }

    /// The activation failed: how long it pauses before it is started again.
    pub(crate) fn failed(
        &mut self,
        activation: Activation,
        first_pause: Duration,
        doublings: u32,
    ) -> Duration {
        let Some(post) = self.post(activation) else { return first_pause };
        post.started = false;
        post.failures += 1;
        let pause = first_pause * (1 << post.failures_in_a_row.min(doublings));
        post.failures_in_a_row = post.failures_in_a_row.saturating_add(1);
        pause
    }

    /// An activation that waited is not called again; its activity, to be told so.
    pub(crate) fn leave(&mut self, activation: Activation) -> Option<&mut (dyn Activity + 'static)> {
        let post = self.post(activation)?;
        let waited = post.waits.take_if(|waiting| waiting.activation == activation).is_some();
        post.activity.as_deref_mut().filter(|_| waited)
    }

    /// Calls those early that wait for a message on a topic, but for the one that has published it itself.
    pub(crate) fn message_arrived(&mut self, topic: TopicSlot, own: Option<Activation>, now: Moment) {
        for post in self.posts.iter_mut().filter(|post| own.is_none() || post.newest != own) {
            match &mut post.waits {
                Some(waiting) if waiting.topics.contains(&topic) => waiting.at = waiting.at.min(now),
                None if post.activity.is_none() && !post.missed.contains(&topic) => post.missed.push(topic),
                _ => {}
            }
        }
    }

    /// When the next waiting activation is to be called.
    pub(crate) fn next_call(&self) -> Moment {
        let waiting = self.posts.iter().filter_map(|post| post.waits.as_ref());
        waiting.map(|waiting| waiting.at).min().unwrap_or(Moment::MAX)
    }

    /// The first waiting activation in the order of the document that is to be called by now. It waits no more.
    pub(crate) fn due(&mut self, now: Moment) -> Option<Activation> {
        let waiting = self.posts.iter_mut().map(|post| &mut post.waits);
        let due = waiting.filter_map(|waits| waits.take_if(|waiting| waiting.at <= now)).next();
        due.map(|waiting| waiting.activation)
    }

    /// The activation of a state that waits to be called again. It waits no more.
    pub(crate) fn hurry(&mut self, node: NodeId) -> Option<Activation> {
        let waiting = self.posts.iter_mut().map(|post| &mut post.waits);
        let its = waiting.filter_map(|waits| waits.take_if(|waiting| waiting.activation.node == node)).next();
        its.map(|waiting| waiting.activation)
    }

    pub(crate) fn name(&self, activation: Activation) -> &str {
        self.place(activation).map_or("", |place| &self.posts[place].name)
    }

    pub(crate) fn statistics<'a>(
        &'a self,
        chart: &'a Chart,
    ) -> impl Iterator<Item = ActivityStatistics> + 'a {
        self.posts.iter().map(|post| ActivityStatistics {
            name: post.name.clone(),
            state: Some(chart.short_path(post.node)),
            calls: post.calls,
            failures: post.failures,
            call_time: post.timing.wall(),
            call_cpu: post.timing.cpu(),
            call_percentiles: post.timing.percentiles(),
            held: post.growth.held(),
            grows: post.growth.grows(),
        })
    }
}

impl Post {
    /// Ends an instance that comes back and is wanted no more.
    fn end(&self, mut activity: Box<dyn Activity>, started: bool, blackboard: &mut Blackboard) {
        let stopped = logger::calling(&self.caller, 0, || match started {
            true => call::stop(activity.as_mut(), blackboard),
            false => Ok(()),
        });
        if let Err(failure) = stopped {
            tracing::error!(activity = %self.name, "activity failed to stop: {failure}");
        }
    }
}

/// The topics that an activity says it reads, as the hub numbers them, if it says so.
fn declared(topics: &Topics, hub: &Narukom) -> Option<Box<[TopicSlot]>> {
    let mut slots: Vec<TopicSlot> = topics.read_paths().iter().filter_map(|path| hub.topic(path)).collect();
    slots.sort_unstable();
    topics.is_declared().then(|| slots.into())
}
