//! A typed chart in an agent behaves like the interpreted one, bit by bit.

use monas_robot::{Actuators, Sensors};
use narukom::{FieldValue, Reflect};

use monas::generated::*;
use monas::{Agent, ErrorKind, Registry, RunHash, Talws, Timestamp};

const ACTUATORS: Source<Actuators> = Source::new(0);
const PACE: Timer = Timer(0);

fn walks(input: &GuardInput<'_>) -> GuardResult {
    all!(
        input.is_over(PACE),
        any!(input.is_absent(ACTUATORS), less(input.latest(ACTUATORS)?.head_yaw, 0.5)?)?,
    )
}

/// `Actuators.head_yaw = Actuators.head_yaw + 0.125`, which has no value before there is a message.
fn further<'a>(input: &GuardInput<'a>) -> Computed<'a> {
    plus(input.latest(ACTUATORS)?.head_yaw, 0.125)
}

fn down<'a>(_: &GuardInput<'a>) -> Computed<'a> {
    given(0.25)
}

fn set_yaw(message: &mut Actuators, value: Value<'_>) -> Result<(), CallError> {
    set(&mut message.head_yaw, value, "head_yaw")
}

fn set_pitch(message: &mut Actuators, value: Value<'_>) -> Result<(), CallError> {
    set(&mut message.head_pitch, value, "head_pitch")
}

const WALK: &str = "[pace && (Actuators == NULL || Actuators.head_yaw < 0.5)] / StartTimeout(pace, 20ms); \
                    Actuators.head_pitch = 0.25; Actuators.head_yaw = Actuators.head_yaw + 0.125";

fn walker() -> TypedChartBuilder {
    let mut chart = TypedChartBuilder::new("walker");
    chart.reads(ACTUATORS, SourceDeclaration::own("body/actuators", "Actuators"));
    chart.starts(PACE, "pace");
    chart.add(NodeId(1), NodeId(0), NodeKind::Start, "");
    chart.add(NodeId(2), NodeId(0), NodeKind::Basic, "walk");
    chart.activity(NodeId(2), "walk");
    chart.connect(NodeId(1), NodeId(2), "");
    chart.connect(NodeId(2), NodeId(2), WALK);
    chart.guard(walks);
    chart.value(1, ACTUATORS, down, set_pitch);
    chart.value(2, ACTUATORS, further, set_yaw);
    chart
}

fn walk(_: &mut monas::Blackboard) {}

fn generated(chart: TypedChartBuilder) -> GeneratedChart {
    GeneratedChart::new(chart.finish().unwrap(), vec![Instance::new(NodeId(2), walk)])
}

fn hash_of(agent: Agent) -> (String, u64) {
    let hash = RunHash::new();
    let mut talws = Talws::new().registry(Registry::empty().with("walk", || walk)).agent(agent);
    talws.observe(Box::new(hash.clone()));
    talws.simulate(7).unwrap().run_until(Timestamp::from_secs_f64(1.0)).unwrap();
    hash.finish()
}

#[test]
fn native_and_interpreted_assignments_publish_equal_messages() {
    let chart = generated(walker());
    let interpreted = hash_of(Agent::statechart("a", chart.statechart().clone()));
    let typed = hash_of(Agent::idle("a".into()).generated(chart));
    assert_eq!(typed, interpreted);
    assert!(typed.1 > 8, "it walks several times: {typed:?}");
}

#[test]
fn a_chart_made_for_other_messages_is_refused() {
    let mut chart = walker();
    chart.reads(Source::<Actuators>::new(1), SourceDeclaration::own("body/wings", "Wings"));
    let agent = Agent::idle("a".into()).generated(generated(chart));
    let error = Talws::new().agent(agent).simulate(7).err().unwrap();
    assert_eq!(error.kind(), ErrorKind::Invalid);
    assert_eq!(error.diagnostics()[0].message, "there is no topic `body/wings` of messages `Wings`");
}

#[test]
fn a_guard_without_its_function_is_refused() {
    let mut chart = walker();
    chart.connect(NodeId(2), NodeId(2), "[Actuators == NULL]");
    let agent = Agent::idle("a".into()).generated(generated(chart));
    let error = Talws::new().agent(agent).simulate(7).err().unwrap();
    assert_eq!(error.diagnostics()[0].message, "no function is the guard of transition 2");
}

#[test]
fn a_state_without_its_activity_is_refused() {
    let chart = GeneratedChart::new(walker().finish().unwrap(), Vec::new());
    let error = Talws::new().agent(Agent::idle("a".into()).generated(chart)).simulate(7).err().unwrap();
    let message = "no activity `walk` was generated for the state `walk`";
    assert_eq!(error.diagnostics()[0].message, message);
}

type Put = fn(&mut Sensors, Value<'_>) -> Result<(), CallError>;

/// Functions set fields to the same numbers as expressions.
#[test]
fn fields_take_what_they_take_of_expressions() {
    let values = [
        (FieldValue::Bool(true), Value::Bool(true)),
        (FieldValue::Int(-3), Value::Int(-3)),
        (FieldValue::Uint(u64::MAX), Value::Uint(u64::MAX)),
        (FieldValue::Float(2.0), Value::Float(2.0)),
        (FieldValue::Float(2.5), Value::Float(2.5)),
        (FieldValue::Float(f64::NAN), Value::Float(f64::NAN)),
        (FieldValue::Float(1e30), Value::Float(1e30)),
        (FieldValue::Text("a"), Value::Text("a")),
        (FieldValue::Enum(4), Value::Enum(4)),
        (FieldValue::Missing, Value::Missing),
    ];
    let fields: [(&str, Put); 4] = [
        ("measured_at", |message, value| set(&mut message.measured_at, value, "measured_at")),
        ("head_yaw", |message, value| set(&mut message.head_yaw, value, "head_yaw")),
        ("chest_button", |message, value| set(&mut message.chest_button, value, "chest_button")),
        ("posture", |message, value| set(&mut message.posture, value, "posture")),
    ];
    for (name, put) in fields {
        for (given, value) in values {
            // values of an enumeration are for enumerations only, which is checked before the run
            if matches!(value, Value::Enum(_)) && name != "posture" {
                continue;
            }
            let (mut by_index, mut by_function) = (Sensors::default(), Sensors::default());
            let expected = by_index.set_field_by_name(name, given).map_err(|error| error.to_string());
            let found = put(&mut by_function, value).map_err(|error| error.to_string());
            assert_eq!(found, expected, "{name} = {value:?}");
            assert_eq!(format!("{by_function:?}"), format!("{by_index:?}"), "{name} = {value:?}");
        }
    }
}
