//! The states.

use ::monas::generated::NodeId;

/// The nodes of the chart, in its order. Each is named by the shortest unique end of its path.
#[allow(non_camel_case_types, clippy::upper_case_acronyms)] // names as in the model
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum State {
    /// OR: `goalie`
    goalie,
    /// START: `goalie/START`
    START__of__goalie,
    /// AND: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)`
    RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
    /// END: `goalie/END`
    END__of__goalie,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/1`
    region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/1/START`
    START__of__region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/1/RobotController~`
    RobotController__ever__,
    /// END: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/1/END`
    END__of__region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/2`
    region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/2/START`
    START__of__region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/2/LedHandler~`
    LedHandler__ever__,
    /// END: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/2/END`
    END__of__region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/3`
    region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/3/START`
    START__of__region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/3/MotionController~`
    MotionController__ever__,
    /// END: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/3/END`
    END__of__region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4`
    region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/START`
    START__of__region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)`
    __open__Stand__then__SendCalibration__then__active__close__,
    /// END: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/END`
    END__of__region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/1/RobotController~/START`
    START__of__RobotController__ever__,
    /// BASIC: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/1/RobotController~/RobotController`
    RobotController,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/2/LedHandler~/START`
    START__of__LedHandler__ever__,
    /// BASIC: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/2/LedHandler~/LedHandler`
    LedHandler,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/3/MotionController~/START`
    START__of__MotionController__ever__,
    /// BASIC: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/3/MotionController~/MotionController`
    MotionController,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/START`
    START__of____open__Stand__then__SendCalibration__then__active__close__,
    /// BASIC: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/Stand`
    Stand,
    /// BASIC: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/SendCalibration`
    SendCalibration,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active`
    active,
    /// END: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/END`
    END__of____open__Stand__then__SendCalibration__then__active__close__,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/START`
    START__of__active,
    /// AND: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~`
    Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// END: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/END`
    END__of__active,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/1`
    region1__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/1/START`
    START__of__region1__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/1/Sensors~`
    Sensors__ever__,
    /// END: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/1/END`
    END__of__region1__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/2`
    region2__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/2/START`
    START__of__region2__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/2/Vision~`
    Vision__ever__,
    /// END: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/2/END`
    END__of__region2__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/3`
    region3__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/3/START`
    START__of__region3__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/3/WalkToKickOff~`
    WalkToKickOff__ever__,
    /// END: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/3/END`
    END__of__region3__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4`
    region4__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/START`
    START__of__region4__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~`
    decision__ever__,
    /// END: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/END`
    END__of__region4__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/1/Sensors~/START`
    START__of__Sensors__ever__,
    /// BASIC: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/1/Sensors~/Sensors`
    Sensors,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/2/Vision~/START`
    START__of__Vision__ever__,
    /// BASIC: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/2/Vision~/Vision`
    Vision,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/3/WalkToKickOff~/START`
    START__of__WalkToKickOff__ever__,
    /// BASIC: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/3/WalkToKickOff~/WalkToKickOff`
    WalkToKickOff,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/START`
    START__of__decision__ever__,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision`
    decision,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/START`
    START__of__decision,
    /// BASIC: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/WaitForBallMessage`
    WaitForBallMessage,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)`
    __open__search__or__takeAction__close__,
    /// END: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/END`
    END__of__decision,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/START`
    START__of____open__search__or__takeAction__close__,
    /// CONDITION: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/CONDITION`
    CONDITION__of____open__search__or__takeAction__close__,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/search`
    search,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction`
    takeAction,
    /// END: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/END`
    END__of____open__search__or__takeAction__close__,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/search/START`
    START__of__search,
    /// BASIC: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/search/SearchBall`
    SearchBall,
    /// BASIC: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/search/ReturnToGoal`
    ReturnToGoal,
    /// END: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/search/END`
    END__of__search,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/START`
    START__of__takeAction,
    /// CONDITION: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/CONDITION`
    CONDITION__of__takeAction,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/guardGoal`
    guardGoal,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/action`
    action,
    /// END: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/END`
    END__of__takeAction,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/guardGoal/START`
    START__of__guardGoal,
    /// BASIC: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/guardGoal/TrackBall`
    TrackBall,
    /// OR: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/guardGoal/(KeepGoal|StepAside)`
    __open__KeepGoal__or__StepAside__close__,
    /// END: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/guardGoal/END`
    END__of__guardGoal,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/guardGoal/(KeepGoal|StepAside)/START`
    START__of____open__KeepGoal__or__StepAside__close__,
    /// CONDITION: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/guardGoal/(KeepGoal|StepAside)/CONDITION`
    CONDITION__of____open__KeepGoal__or__StepAside__close__,
    /// BASIC: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/guardGoal/(KeepGoal|StepAside)/KeepGoal`
    KeepGoal,
    /// BASIC: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/guardGoal/(KeepGoal|StepAside)/StepAside`
    StepAside,
    /// END: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/guardGoal/(KeepGoal|StepAside)/END`
    END__of____open__KeepGoal__or__StepAside__close__,
    /// START: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/action/START`
    START__of__action,
    /// CONDITION: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/action/CONDITION`
    CONDITION__of__action,
    /// BASIC: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/action/RightFall`
    RightFall,
    /// BASIC: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/action/LeftFall`
    LeftFall,
    /// BASIC: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/action/RightDive`
    RightDive,
    /// BASIC: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/action/LeftDive`
    LeftDive,
    /// END: `goalie/RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)/4/(Stand.SendCalibration.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/action/END`
    END__of__action,
}

impl From<State> for NodeId {
    fn from(state: State) -> NodeId {
        NodeId(state as u32)
    }
}
