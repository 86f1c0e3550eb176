//! A fixture for testing one activity: its inputs and outputs at times chosen by the test.

use std::time::Duration;

use monas::{Activity, Blackboard, Progress, call};
use monas_robot::Skill;
use narukom::{Hub, Retention, Timestamp, Topic};

use crate::{MotionRequest, topics};

/// A hub, the blackboard of the activity under test, and one for all other participants.
pub(crate) struct ActivityFixture {
    pub(crate) now: Timestamp,
    blackboard: Blackboard,
    others: Blackboard,
    /// Reads the requests of motions.
    watcher: Blackboard,
}

impl ActivityFixture {
    /// A fixture at a time of two seconds.
    pub(crate) fn new() -> ActivityFixture {
        let hub = Hub::with_linked_topics("robot").unwrap();
        let [blackboard, others, watcher] = ["actor", "others", "watcher"].map(|name| hub.blackboard(name));
        ActivityFixture { now: Timestamp::from_nanos(2_000_000_000), blackboard, others, watcher }
    }

    /// Advances time.
    pub(crate) fn wait(&mut self, duration: Duration) -> &mut ActivityFixture {
        self.now += duration;
        self
    }

    /// Publishes a message for the activity.
    pub(crate) fn publish<K: Retention>(
        &mut self,
        topic: Topic<K>,
        message: K::Message,
    ) -> &mut ActivityFixture {
        self.others.process_messages(self.now);
        self.others.publish(topic, message).unwrap();
        self.others.publish_all(self.now);
        self
    }

    /// Calls the activity once, in its own cycle, and returns whether it is done. It has to declare
    /// the topics that it reads and a skill that it requests.
    pub(crate) fn run(&mut self, activity: &mut dyn Activity) -> bool {
        let before = self.motion();
        self.blackboard.process_messages(self.now);
        let progress = call::execute(activity, &mut self.blackboard).unwrap();
        self.blackboard.publish_all(self.now);
        if let Some(wanted) = self.motion().filter(|wanted| before.as_ref() != Some(wanted))
            && let name = wanted.kind().as_str_name()
            && Skill::from_str_name(name).is_some()
        {
            assert!(activity.topics().skills().contains(&name), "it does not declare {name}");
        }
        progress == Progress::Done
    }

    /// The newest request of a motion.
    fn motion(&mut self) -> Option<MotionRequest> {
        self.watcher.process_messages(self.now);
        self.watcher.read(topics::MOTION).copied()
    }

    /// The error of a call of the activity, if it fails.
    pub(crate) fn fails(&mut self, activity: &mut dyn Activity) -> Option<String> {
        self.blackboard.process_messages(self.now);
        call::execute(activity, &mut self.blackboard).err().map(|error| error.to_string())
    }

    /// The newest message of a topic.
    pub(crate) fn latest<K: Retention>(&mut self, topic: Topic<K>) -> Option<K::Message>
    where
        K::Message: Clone,
    {
        self.others.process_messages(self.now);
        self.others.read(topic).cloned()
    }

    /// The number of messages of a topic since the last call.
    pub(crate) fn count_arrivals<K: Retention>(&mut self, topic: Topic<K>) -> usize {
        let slot = self.others.slot(topic.path()).unwrap();
        self.others.interest(slot);
        self.others.process_messages(self.now);
        self.others.arrivals().filter(|arrival| *arrival == slot).count()
    }
}

/// A tenth of a second.
pub(crate) const TICK: Duration = Duration::from_millis(100);
