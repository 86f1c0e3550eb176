//! The states.

use ::monas::generated::NodeId;

/// The nodes of the chart, in its order. Each is named by the shortest unique end of its path.
#[allow(non_camel_case_types, clippy::upper_case_acronyms)] // names as in the model
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum State {
    /// OR: `player`
    player,
    /// START: `player/START`
    START__of__player,
    /// AND: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)`
    RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
    /// END: `player/END`
    END__of__player,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/1`
    region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/1/START`
    START__of__region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/1/RobotController~`
    RobotController__ever__,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/1/END`
    END__of__region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/2`
    region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/2/START`
    START__of__region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/2/LedHandler~`
    LedHandler__ever__,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/2/END`
    END__of__region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/3`
    region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/3/START`
    START__of__region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/3/MotionController~`
    MotionController__ever__,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/3/END`
    END__of__region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4`
    region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/START`
    START__of__region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)`
    __open__initialize__then__active__close__,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/END`
    END__of__region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/1/RobotController~/START`
    START__of__RobotController__ever__,
    /// BASIC: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/1/RobotController~/RobotController`
    RobotController,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/2/LedHandler~/START`
    START__of__LedHandler__ever__,
    /// BASIC: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/2/LedHandler~/LedHandler`
    LedHandler,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/3/MotionController~/START`
    START__of__MotionController__ever__,
    /// BASIC: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/3/MotionController~/MotionController`
    MotionController,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/START`
    START__of____open__initialize__then__active__close__,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/initialize`
    initialize,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active`
    active,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/END`
    END__of____open__initialize__then__active__close__,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/initialize/START`
    START__of__initialize,
    /// BASIC: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/initialize/Stand`
    Stand,
    /// BASIC: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/initialize/SendCalibration`
    SendCalibration,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/initialize/END`
    END__of__initialize,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/START`
    START__of__active,
    /// AND: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~`
    Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/END`
    END__of__active,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/1`
    region1__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/1/START`
    START__of__region1__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/1/Sensors~`
    Sensors__ever__,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/1/END`
    END__of__region1__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/2`
    region2__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/2/START`
    START__of__region2__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/2/Vision~`
    Vision__ever__,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/2/END`
    END__of__region2__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/3`
    region3__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/3/START`
    START__of__region3__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/3/WalkToKickOff~`
    WalkToKickOff__ever__,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/3/END`
    END__of__region3__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4`
    region4__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/START`
    START__of__region4__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~`
    decision__ever__,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/END`
    END__of__region4__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/1/Sensors~/START`
    START__of__Sensors__ever__,
    /// BASIC: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/1/Sensors~/Sensors`
    Sensors,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/2/Vision~/START`
    START__of__Vision__ever__,
    /// BASIC: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/2/Vision~/Vision`
    Vision,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/3/WalkToKickOff~/START`
    START__of__WalkToKickOff__ever__,
    /// BASIC: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/3/WalkToKickOff~/WalkToKickOff`
    WalkToKickOff,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/START`
    START__of__decision__ever__,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision`
    decision,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/START`
    START__of__decision,
    /// BASIC: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/WaitForBallMessage`
    WaitForBallMessage,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)`
    __open__search__or__takeAction__close__,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/END`
    END__of__decision,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/START`
    START__of____open__search__or__takeAction__close__,
    /// CONDITION: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/CONDITION`
    CONDITION__of____open__search__or__takeAction__close__,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/search`
    search,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction`
    takeAction,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/END`
    END__of____open__search__or__takeAction__close__,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/search/START`
    START__of__search,
    /// BASIC: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/search/SearchBall`
    SearchBall,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/search/[roam]`
    __opt__roam__end__,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/search/END`
    END__of__search,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/search/[roam]/START`
    START__of____opt__roam__end__,
    /// CONDITION: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/search/[roam]/CONDITION`
    CONDITION__of____opt__roam__end__,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/search/[roam]/roam`
    roam,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/search/[roam]/roam/START`
    START__of__roam,
    /// CONDITION: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/search/[roam]/roam/CONDITION`
    CONDITION__of__roam,
    /// BASIC: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/search/[roam]/roam/TurnAround`
    TurnAround,
    /// BASIC: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/search/[roam]/roam/WalkTowardsCentre`
    WalkTowardsCentre,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/search/[roam]/roam/END`
    END__of__roam,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/search/[roam]/END`
    END__of____opt__roam__end__,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/START`
    START__of__takeAction,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/(TrackBall|LookAtGoal)`
    __open__TrackBall__or__LookAtGoal__close__,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/(WalkTowardsBall|AlignWithBall|kickBall|SupportMate)`
    __open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/END`
    END__of__takeAction,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/(TrackBall|LookAtGoal)/START`
    START__of____open__TrackBall__or__LookAtGoal__close__,
    /// CONDITION: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/(TrackBall|LookAtGoal)/CONDITION`
    CONDITION__of____open__TrackBall__or__LookAtGoal__close__,
    /// BASIC: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/(TrackBall|LookAtGoal)/TrackBall`
    TrackBall,
    /// BASIC: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/(TrackBall|LookAtGoal)/LookAtGoal`
    LookAtGoal,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/(TrackBall|LookAtGoal)/END`
    END__of____open__TrackBall__or__LookAtGoal__close__,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/(WalkTowardsBall|AlignWithBall|kickBall|SupportMate)/START`
    START__of____open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
    /// CONDITION: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/(WalkTowardsBall|AlignWithBall|kickBall|SupportMate)/CONDITION`
    CONDITION__of____open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
    /// BASIC: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/(WalkTowardsBall|AlignWithBall|kickBall|SupportMate)/WalkTowardsBall`
    WalkTowardsBall,
    /// BASIC: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/(WalkTowardsBall|AlignWithBall|kickBall|SupportMate)/AlignWithBall`
    AlignWithBall,
    /// OR: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/(WalkTowardsBall|AlignWithBall|kickBall|SupportMate)/kickBall`
    kickBall,
    /// BASIC: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/(WalkTowardsBall|AlignWithBall|kickBall|SupportMate)/SupportMate`
    SupportMate,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/(WalkTowardsBall|AlignWithBall|kickBall|SupportMate)/END`
    END__of____open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
    /// START: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/(WalkTowardsBall|AlignWithBall|kickBall|SupportMate)/kickBall/START`
    START__of__kickBall,
    /// CONDITION: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/(WalkTowardsBall|AlignWithBall|kickBall|SupportMate)/kickBall/CONDITION`
    CONDITION__of__kickBall,
    /// BASIC: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/(WalkTowardsBall|AlignWithBall|kickBall|SupportMate)/kickBall/LeftKick`
    LeftKick,
    /// BASIC: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/(WalkTowardsBall|AlignWithBall|kickBall|SupportMate)/kickBall/RightKick`
    RightKick,
    /// END: `player/RobotController~||LedHandler~||MotionController~||(initialize.active)/4/(initialize.active)/active/Sensors~||Vision~||WalkToKickOff~||decision~/4/decision~/decision/(search|takeAction)/takeAction/(WalkTowardsBall|AlignWithBall|kickBall|SupportMate)/kickBall/END`
    END__of__kickBall,
}

impl From<State> for NodeId {
    fn from(state: State) -> NodeId {
        NodeId(state as u32)
    }
}
