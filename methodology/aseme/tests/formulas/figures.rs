//! The thesis's Figures 5.2 to 5.4, verbatim.

use aseme::SrmFile;

const FIGURE_5_2: &str = "
Role: goalie
Protocols: N/A
Liveness:
goalie = RobotControllerω || LedHandlerω || MotionControllerω
        || ( Stand . SendCalibration . active)
active = Sensorsω || Visionω || decisionω
decision = WaitForBallMessage . ( SearchBall | takeAction )
takeAction = TrackBall | action
action = RightFall | LeftFall | RightDive | LeftDive
";

const FIGURE_5_3: &str = "
Role: attacker player
Protocols: N/A
Liveness:
player = RobotController ω || LedHandler ω || MotionController ω
                                     || ( initialize . active)

initialize = Stand . SendCalibration
active = Sensors ω || Vision ω || decision ω
decision = WaitForBallMessage . ( SearchBall | takeAction )
takeAction = TrackBall . ( WalkTowardsBall | AlignWithBall | kickBall )
kickBall = LeftKick | RightKick
";

const FIGURE_5_4: &str = "
Role: extended attacker player
Protocols: Attack: center, Attack: center_for
Liveness:
player = RobotController ω || LedHandler ω || MotionController ω
                                     || ( initialize . active )
initialize = Stand. SendCalibration
active = Sensors ω || Vision ω || decision ω
decision = WaitForBallMessage. ( SearchBall | takeAction )
takeAction = TrackBall . ( WalkTowardsBall | AlignWithBall | kickBall
                           | center | center_for )
kickBall = LeftKick | RightKick
center = WalkTowardsBall. [passBall]
center_for = WalkTowardsGoal. [WalkTowardsBall. [kickBall]]
";

fn read(text: &str) -> SrmFile {
    let (file, findings) = SrmFile::parse(text);
    assert_eq!(findings, []);
    file
}

/// The chart as JSON.
fn chart(text: &str) -> serde_json::Value {
    let (chart, findings) = aseme::role_to_statechart(read(text).srm());
    assert_eq!(findings, []);
    serde_json::to_value(aseme::to_json(&chart)).expect("JSON")
}

#[test]
fn figure_5_2_is_the_goalie() {
    let file = read(FIGURE_5_2);
    assert_eq!(file.srm().role, "goalie");
    assert_eq!(file.srm().protocols, []);
    let names: Vec<&str> =
        file.srm().liveness.formulas().iter().map(|formula| formula.name.as_str()).collect();
    assert_eq!(names, ["goalie", "active", "decision", "takeAction", "action"]);
    let first = file.srm().liveness.to_string().lines().next().map(String::from);
    let expected =
        "goalie = RobotController~ || LedHandler~ || MotionController~ || (Stand . SendCalibration . active)";
    assert_eq!(first.as_deref(), Some(expected));
}

#[test]
fn figure_5_3_is_the_attacker() {
    let file = read(FIGURE_5_3);
    assert_eq!(file.srm().role, "attacker player");
    assert_eq!(file.srm().liveness.formulas().len(), 6);
    assert_eq!(chart(FIGURE_5_3)["model"], "player");
}

#[test]
fn figure_5_4_takes_part_in_a_protocol() {
    let file = read(FIGURE_5_4);
    let parts: Vec<(&str, &str)> =
        file.srm().protocols.iter().map(|part| (part.name.as_str(), part.participant.as_str())).collect();
    assert_eq!(parts, [("Attack", "center"), ("Attack", "center_for")]);
}

#[test]
fn omega_tilde_and_caret_mean_the_same() {
    let expected = chart("r = a~ || (b.c)~");
    for text in [
        "r = aω || (b.c)ω",
        "r = a ω||( b . c ) ~",
        "r=a^ω||(b.c)^~",
        "r = aΩ\n  || (b\t.c)~ # twice",
        "\u{feff}r = a~ ||\r\n(b.c)~\r\n",
    ] {
        assert_eq!(chart(text), expected, "{text}");
    }
}
