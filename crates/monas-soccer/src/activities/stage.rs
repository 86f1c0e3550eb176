//! A stage on which one activity is tested: what it is told, what it says, at times the test chooses.

use std::time::Duration;

use monas::{Activity, Blackboard, Progress};
use narukom::{Keep, Moment, Narukom, Topic};

/// A hub, the blackboard of the activity under test, and one for everybody else.
pub(crate) struct Stage {
    pub(crate) now: Moment,
    actor: Blackboard,
    others: Blackboard,
}

impl Stage {
    /// A stage on which two seconds have gone by.
    pub(crate) fn new() -> Stage {
        let hub = Narukom::with_linked_topics("robot").unwrap();
        let (actor, others) = (hub.blackboard("actor"), hub.blackboard("others"));
        Stage { now: Moment::from_nanos(2_000_000_000), actor, others }
    }

    /// Lets time pass.
    pub(crate) fn wait(&mut self, duration: Duration) -> &mut Stage {
        self.now += duration;
        self
    }

    /// Publishes a message for the activity.
    pub(crate) fn tell<K: Keep>(&mut self, topic: Topic<K>, message: K::Message) -> &mut Stage {
        self.others.process_messages(self.now);
        self.others.publish(topic, message).unwrap();
        self.others.publish_all(self.now);
        self
    }

    /// Calls the activity once, as a cycle of its own, and answers whether it is done.
    pub(crate) fn run(&mut self, activity: &mut dyn Activity) -> bool {
        self.actor.process_messages(self.now);
        let progress = activity.execute(&mut self.actor).unwrap();
        self.actor.publish_all(self.now);
        progress == Progress::Done
    }

    /// Whether a call of the activity fails, and how.
    pub(crate) fn fails(&mut self, activity: &mut dyn Activity) -> Option<String> {
        self.actor.process_messages(self.now);
        activity.execute(&mut self.actor).err().map(|error| error.to_string())
    }

    /// The newest message of a topic.
    pub(crate) fn said<K: Keep>(&mut self, topic: Topic<K>) -> Option<K::Message>
    where
        K::Message: Clone,
    {
        self.others.process_messages(self.now);
        self.others.read(topic).cloned()
    }

    /// How many messages of a topic have come since it was looked at last.
    pub(crate) fn heard<K: Keep>(&mut self, topic: Topic<K>) -> usize {
        let slot = self.others.slot(topic.path()).unwrap();
        self.others.interest(slot);
        self.others.process_messages(self.now);
        self.others.arrivals().filter(|arrival| *arrival == slot).count()
    }
}

/// A tenth of a second.
pub(crate) const TICK: Duration = Duration::from_millis(100);
