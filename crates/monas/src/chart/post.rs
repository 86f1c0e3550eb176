//! The activities of a chart's states: who they are, which are being called, and which wait to be called again.

use std::time::Duration;

use narukom::{Blackboard, Moment, TopicSlot};
use yase::{Activation, Chart, NodeId};

use crate::activity::{Activity, Progress, Topics};
use crate::call::{self, Failure};
use crate::statistics::ActivityStatistics;

/// One for each BASIC state with an activity, in the order of the document.
pub(crate) struct Posts {
    posts: Vec<Post>,
    /// The place of a node's post.
    of_node: Vec<Option<usize>>,
}

struct Post {
    node: NodeId,
    name: String,
    priority: i32,
    duration: Duration,
    /// None while it is being called.
    activity: Option<Box<dyn Activity>>,
    /// Whether `start` has been called since it was made or failed.
    started: bool,
    /// The activation that waits for its next call, and when that is.
    waits: Option<Waiting>,
    calls: u64,
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
    started: bool,
    blackboard: Blackboard,
    called: bool,
}

/// What an activity returned.
pub(crate) struct Returned {
    pub(crate) activation: Activation,
    pub(crate) result: Result<Progress, Failure>,
}

impl Assignment {
    /// Calls the activity, where it is.
    pub(crate) fn call(&mut self) -> Returned {
        Returned { activation: self.activation, result: self.try_call() }
    }

    fn try_call(&mut self) -> Result<Progress, Failure> {
        if !self.started {
            call::start(self.activity.as_mut(), &mut self.blackboard)?;
            self.started = true;
        }
        self.called = true;
        call::execute(self.activity.as_mut(), &mut self.blackboard)
    }
}

impl Posts {
    /// `activities` are in the order of [`Chart::activities`].
    pub(crate) fn new(chart: &Chart, activities: Vec<Box<dyn Activity>>) -> Posts {
        let mut of_node = vec![None; chart.statechart().nodes().len()];
        let posts = chart.activities().zip(activities).enumerate().map(|(place, (entry, activity))| {
            of_node[entry.node.0 as usize] = Some(place);
            Post {
                node: entry.node,
                name: entry.name.into(),
                priority: entry.priority,
                duration: entry.duration.unwrap_or_default(),
                activity: Some(activity),
                started: false,
                waits: None,
                calls: 0,
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

    /// Hands out the activity of an activation; none if it is being called already, which the machine rules out.
    pub(crate) fn assign(&mut self, activation: Activation, blackboard: Blackboard) -> Option<Assignment> {
        let place = self.place(activation)?;
        let post = &mut self.posts[place];
        post.waits = None;
        Some(Assignment {
            activation,
            priority: post.priority,
            duration: post.duration,
            post: place,
            activity: post.activity.take()?,
            started: post.started,
            blackboard,
            called: false,
        })
    }

    pub(crate) fn take_back(&mut self, assignment: Assignment) -> (Activation, Blackboard) {
        let Assignment { activation, post, activity, started, blackboard, called, .. } = assignment;
        let post = &mut self.posts[post];
        post.activity = Some(activity);
        post.started = started;
        post.calls += u64::from(called);
        (activation, blackboard)
    }

    /// The topics whose messages call a waiting activation early.
    pub(crate) fn waits_for(&self, activation: Activation) -> &[TopicSlot] {
        let post = self.place(activation).map(|place| &self.posts[place]);
        let waiting = post.and_then(|post| post.waits.as_ref());
        waiting.map_or(&[], |waiting| &waiting.topics)
    }

    /// What the activity says it reads and publishes, if it says so.
    pub(crate) fn declared(&self, activation: Activation) -> Option<Topics> {
        let activity = self.posts[self.place(activation)?].activity.as_ref()?;
        Some(activity.topics()).filter(Topics::is_declared)
    }

    /// The activation has come to its end.
    pub(crate) fn finished(&mut self, activation: Activation) {
        if let Some(post) = self.post(activation) {
            post.failures_in_a_row = 0;
        }
    }

    /// The activation is to be called again at `at`, or when a message arrives on one of these topics.
    pub(crate) fn wait(&mut self, activation: Activation, at: Moment, topics: Vec<TopicSlot>) {
        if let Some(post) = self.post(activation) {
            if !topics.is_empty() {
                post.failures_in_a_row = 0;
            }
            post.waits = Some(Waiting { activation, at, topics });
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
        for waiting in self.posts.iter_mut().filter_map(|post| post.waits.as_mut()) {
            if waiting.topics.contains(&topic) && own != Some(waiting.activation) {
                waiting.at = waiting.at.min(now);
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
            call_time: None,
        })
    }
}
