//! A pedestrian crossing: a whole statechart, run in virtual time. `cargo run -p yase --example
//! traffic_light`
//!
//! Cars have green until a pedestrian pushes the button, but for at least ten seconds. Then the
//! light is amber for three seconds, and pedestrians walk: an *activity*, since its duration is not
//! fixed by the chart. When they are across, cars have green again. If the light breaks it blinks
//! until it is repaired.
//!
//! The output shows:
//!
//! - `busy` *defers* the button: a push that comes too early is not lost but taken once `busy` has
//!   been left.
//! - The timer is an event that a transition can name. It expires in virtual time: nothing here
//!   sleeps or reads a clock.
//! - `fault` triggers a transition of the composite `crossing` in any of its states. While
//!   pedestrians walk the event is *held* until the activity has returned.
//! - Each line is one micro-step: the transitions taken, and the states left and entered. `-`
//!   stands for no event.

use std::error::Error;
use std::sync::Arc;
use std::time::Duration;

use yase::expression::{parse_actions, parse_transition};
use yase::{
    Activation, CompiledChart, Host, Machine, Node, NodeId, NodeKind, Notice, Outcome, Statechart, Timestamp,
    TraceRecord, Transition, TypeEnvironment,
};

/// The chart: a tree of states with transitions between them. Every composite begins at its START.
fn crossing() -> Statechart {
    let mut chart = Statechart::new("light");
    let root = Statechart::ROOT;
    let start = chart.add(root, Node::new(NodeKind::Start, ""));
    let crossing = chart.add(root, Node::new(NodeKind::Or, "crossing"));
    let blinking = chart.add(root, Node::new(NodeKind::Basic, "blinking"));

    let green = chart.add(crossing, Node::new(NodeKind::Start, ""));
    let busy = Node { defer: vec!["button".into()], ..state("busy", "StartTimeout(flow, 10s)") };
    let busy = chart.add(crossing, busy);
    let calm = chart.add(crossing, state("calm", ""));
    let amber = chart.add(crossing, state("amber", "StartTimeout(clear, 3s)"));
    let people = Node { activity: Some("walk".into()), ..state("people", "") };
    let people = chart.add(crossing, people);

    connect(&mut chart, start, crossing, "");
    connect(&mut chart, green, busy, "");
    connect(&mut chart, busy, calm, "flow");
    connect(&mut chart, calm, amber, "button");
    connect(&mut chart, amber, people, "clear");
    connect(&mut chart, people, busy, ""); // once its activity has returned
    connect(&mut chart, crossing, blinking, "fault");
    connect(&mut chart, blinking, crossing, "repaired");
    chart
}

fn state(name: &str, entry: &str) -> Node {
    let (entry, wrong) = parse_actions(entry);
    assert!(wrong.is_empty(), "{wrong:?}");
    Node { entry, ..Node::new(NodeKind::Basic, name) }
}

/// An expression reads `event [guard] / actions`; each part may be left out.
fn connect(chart: &mut Statechart, source: NodeId, target: NodeId, text: &str) {
    let (expression, wrong) = parse_transition(text);
    assert!(wrong.is_empty(), "{wrong:?}");
    chart.connect(Transition { expression, ..Transition::new(source, target) });
}

/// The host of the machine. It starts the requested activities; crossing takes six seconds.
#[derive(Default)]
struct Street {
    now: Timestamp,
    /// The walking activity, and when the pedestrians are across.
    walking: Option<(Activation, Timestamp)>,
}

impl Host for Street {
    fn start(&mut self, activation: Activation) {
        println!("{} (people begin to walk)", self.now);
        self.walking = Some((activation, self.now + Duration::from_secs(6)));
    }

    /// Only transitions that are marked `interrupts` ask an activity to return early; this chart
    /// has none.
    fn cancel(&mut self, _: Activation) {}

    /// Only activities that wait between two calls are stopped.
    fn stop(&mut self, _: Activation) {}

    fn wants_trace(&self) -> bool {
        true
    }

    fn trace(&mut self, chart: &CompiledChart, record: &TraceRecord<'_>) {
        println!("{}", record.display(chart));
    }

    fn report(&mut self, _: &CompiledChart, report: Notice<'_>) {
        println!("{} {report:?}", self.now);
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let chart = match crossing().compile(&TypeEnvironment::default()) {
        Ok(chart) => Arc::new(chart),
        Err(wrong) => return Err(format!("the chart is not in order: {wrong:?}").into()),
    };
    let mut machine = Machine::new(chart);
    let mut street = Street::default();
    machine.start(street.now, &mut street);

    // External events and their times, in seconds.
    let mut script = [(4, "button"), (15, "fault"), (25, "repaired"), (40, "button")].into_iter().peekable();
    loop {
        machine.run_to_completion(street.now, &mut street)?;
        let outside = script.peek().map(|&(second, _)| Timestamp::from_millis(second * 1_000));
        let across = street.walking.map(|(_, moment)| moment);
        // Virtual time: advance to the earliest event.
        let Some(next) = [outside, across, machine.next_deadline()].into_iter().flatten().min() else {
            break;
        };
        street.now = next;
        if let Some((activation, _)) = street.walking.take_if(|(_, moment)| *moment <= next) {
            println!("{next} (people are across)");
            machine.activity_returned(activation, Outcome::Done);
        }
        if let Some((_, event)) =
            script.next_if(|&(second, _)| Timestamp::from_millis(second * 1_000) <= next)
        {
            machine.dispatch_name(event);
        }
    }
    let names: Vec<String> =
        machine.configuration().into_iter().map(|node| machine.chart().short_path(node)).collect();
    println!("at rest in {}", names.join(", "));
    Ok(())
}
