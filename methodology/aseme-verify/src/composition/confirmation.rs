//! Confirms a path to a deadlock: executes the steps of each robot on the machine.

use yase::expression::Path;
use yase_explore::TraceStep;

use super::composed_robot::{Behaviour, ComposedRobot};
use super::content_table::NEVER_SENT;
use super::product::{GlobalEvent, GlobalProduct, MessageRoute};
use crate::check_settings::CheckSettings;
use crate::conformance::graph::LabelledEdge;
use crate::run_replay::{MessageSources, RunReplay};

/// Whether the robots can execute the path to a state, with values for everything that they read:
/// first as if only they published what they assign, then with messages of other publishers.
///
/// # Errors
/// The reason why that is unknown.
pub(crate) fn confirm(
    product: &GlobalProduct<'_>,
    state: usize,
    settings: &CheckSettings,
) -> Result<(), String> {
    (0..product.robots.len()).try_for_each(|robot| {
        let (robot_name, abstraction) = (&product.robots[robot].name, &product.robots[robot].abstraction);
        let is_received = |path: &Path| {
            let received = product.robots[robot].received.iter();
            received.map(|it| &it.called.prefix).any(|it| crate::abstraction::may_be_one_message(it, path))
        };
        let is_own = |path: &Path| abstraction.is_assigned(path) && !is_received(path);
        let others = |path: &Path| settings.world.as_ref().is_some_and(|world| world.may_publish(path));
        let alone = replayed(product, state, robot, &is_own);
        let with_others = || replayed(product, state, robot, &|path| is_own(path) && !others(path));
        alone.or_else(|_| with_others()).map_err(|why| format!("{robot_name}: {why}"))
    })
}

/// The steps of one robot on the path to a state.
fn replayed(
    product: &GlobalProduct<'_>,
    state: usize,
    robot: usize,
    is_own: &dyn Fn(&Path) -> bool,
) -> Result<(), String> {
    let (own, behaviour) = (&product.robots[robot], &product.behaviours[robot]);
    let mut announced = own.abstraction.awaited.clone();
    announced.extend(routes_to(product, robot).flat_map(|(_, route)| prefixes(own, route)));
    let sources = MessageSources { is_own, announced };
    let mut steps = RobotSteps {
        behaviour,
        replay: RunReplay::new(&own.abstraction, behaviour.idle.clone(), sources),
        at: behaviour.first_state(),
    };
    for (number, route) in routes_to(product, robot) {
        if is_only_route(product, robot, number) {
            for prefix in prefixes(own, route) {
                steps.replay.assume(&product.contents.facts_of(&prefix, NEVER_SENT));
            }
        }
    }
    for (event, to) in product.steps_to(state) {
        match event {
            GlobalEvent::Step { robot: it, edge } if it == robot => steps.go(edge, &[])?,
            GlobalEvent::Arrival { passage, edge } if product.passages[passage].to == robot => {
                let content = product.states[to].newest[passage];
                let is_known = is_only_route(product, robot, passage);
                let messages = prefixes(own, &product.passages[passage]).map(|prefix| {
                    let facts =
                        if is_known { product.contents.facts_of(&prefix, content) } else { Vec::new() };
                    (prefix, facts)
                });
                let messages: Vec<_> = messages.collect();
                match edge {
                    Some(edge) => steps.go(edge, &messages)?,
                    None => steps.receive(&messages),
                }
            }
            _ => {}
        }
    }
    steps.replay.verdict().map_err(|unconfirmed| unconfirmed.reason)
}

fn routes_to<'p>(
    product: &'p GlobalProduct<'_>,
    robot: usize,
) -> impl Iterator<Item = (usize, &'p MessageRoute)> {
    product.passages.iter().enumerate().filter(move |(_, route)| route.to == robot)
}

/// The order of two messages with one name is unknown.
fn is_only_route(product: &GlobalProduct<'_>, robot: usize, number: usize) -> bool {
    let received = &product.passages[number].received_messages;
    let others = routes_to(product, robot).filter(|(other, _)| *other != number);
    others.into_iter().all(|(_, route)| route.received_messages.iter().all(|it| !received.contains(it)))
}

/// The robot's names for the message of a route.
fn prefixes(robot: &ComposedRobot, route: &MessageRoute) -> impl Iterator<Item = Path> {
    let received = route.received_messages.iter();
    received.map(|&it| robot.received[it].called.prefix.clone()).collect::<Vec<_>>().into_iter()
}

/// An arriving message, with the known part of its content.
type ArrivingMessage = (Path, Vec<yase::expression::Expression>);

/// A robot on its path.
struct RobotSteps<'p> {
    behaviour: &'p Behaviour,
    replay: RunReplay<'p>,
    at: usize,
}

impl RobotSteps<'_> {
    /// Executes the steps of a path; messages arrive before the last step.
    fn go(&mut self, edge: LabelledEdge, messages: &[ArrivingMessage]) -> Result<(), String> {
        let (steps, to) = self.behaviour.steps(self.at, edge.observable, edge.to);
        self.at = to;
        let last = steps.len().saturating_sub(1);
        for (number, index) in steps.into_iter().enumerate() {
            let found = &self.behaviour.found;
            let (Some(step), Some(known)) = (found.step(index), found.steps().get(index)) else { continue };
            if number == last {
                self.receive(messages);
            }
            self.step(step, known.to)?;
        }
        Ok(())
    }

    fn receive(&mut self, messages: &[ArrivingMessage]) {
        for (message, facts) in messages {
            self.replay.receive(message, facts);
        }
    }

    fn step(&mut self, step: &TraceStep, to: usize) -> Result<(), String> {
        self.replay.step(step)?;
        match self.replay.configuration() == self.behaviour.found.states()[to].configuration {
            true => Ok(()),
            false => Err("the machine comes to other states".into()),
        }
    }
}
