//! Diagnostics of the compiler about names and types.

use super::Table;

/// Against the type environment of the tests.
pub(crate) const COMPILING: Table = &[
    ("[limt > 1]", &["E0130 <limt>: there is no `limt` here (did you mean `limit`?)"]),
    (
        "[nothing > 1]",
        &[
            "E0130 <nothing>: there is no `nothing` here (a bare name is a timer started on this blackboard, a constant or a function without arguments)",
        ],
    ),
    (
        "[PLAYING]",
        &[
            "E0130 <PLAYING>: there is no `PLAYING` here (`PLAYING` is a value of `PlayerState`: compare a field of that type with it)",
        ],
    ),
    (
        "[Ball]",
        &["E0130 <Ball>: `Ball` is a message, not a value (name one of its fields, as in `Ball.distance`)"],
    ),
    (
        "[near]",
        &["E0130 <near>: there is no `near` here (`near` is a function: write its arguments in parentheses)"],
    ),
    ("[3m > 1]", &["E0130 <3m>: there is no `3m` here (numbers carry no unit)"]),
    (
        "[GameState.player_state == PLAYNG]",
        &["E0130 <PLAYNG>: the enumeration `PlayerState` has no value `PLAYNG` (did you mean `PLAYING`?)"],
    ),
    (
        "[GameState.player_state == GONE]",
        &["E0130 <GONE>: the enumeration `PlayerState` has no value `GONE` (known are PLAYING, READY)"],
    ),
    (
        "[moton_timeout]",
        &["E0130 <moton_timeout>: there is no `moton_timeout` here (did you mean `motion_timeout`?)"],
    ),
    ("[near(nothing, 1)]", &["E0130 <nothing>: there is no `nothing` here (a message `Ball` is expected)"]),
    (
        "[both == 1]",
        &[
            "E0131 <both>: `both` has several meanings: a constant of the model, a function without arguments (rename all but one)",
        ],
    ),
    (
        "[GameState.player_state == READY]",
        &[
            "E0131 <READY>: `READY` has several meanings: a value of the enumeration `PlayerState`, a constant of the model (rename all but one)",
        ],
    ),
    (
        "[Bal.distance > 1]",
        &["E0132 <Bal>: there is neither a message nor a topic `Bal` (did you mean `Ball`?)"],
    ),
    (
        "[nowhere.State.Ball.distance > 1]",
        &[
            "E0132 <nowhere>: there is no topic `nowhere` (known are arm, ball, behavior, motion, state, whistle)",
        ],
    ),
    ("[bal.State.Ball.distance > 1]", &["E0132 <bal>: there is no topic `bal` (did you mean `ball`?)"]),
    (
        "[Zebra.distance > 1]",
        &[
            "E0132 <Zebra>: there is neither a message nor a topic `Zebra` (a variable is `Message.field` or `topic.Kind.Message.field`)",
        ],
    ),
    (
        "[Arm.angle > 1]",
        &[
            "E0133 <Arm>: several topics have messages of type `Arm` (write `` `left.arm`.State.Arm `` or `` `right.arm`.State.Arm ``)",
        ],
    ),
    (
        "[arm.angle > 1]",
        &[
            "E0133 <arm>: several topics have the name `arm` (write `` `left.arm`.State.Arm `` or `` `right.arm`.State.Arm ``)",
        ],
    ),
    (
        "[Unheard.x > 1]",
        &[
            "E0133 <Unheard>: no topic has messages of type `Unheard` (read a message that is published, or a field that holds this one)",
        ],
    ),
    (
        "[whistle.loudness > 1]",
        &[
            "E0133 <whistle>: several topics have the name `whistle` (write `` `left.whistle`.Signal.Sound `` or `` `right.whistle`.Signal.Sound ``)",
        ],
    ),
    (
        "[Point.x > 1]",
        &[
            "E0133 <Point>: no topic has messages of type `Point` (read a message that is published, or a field that holds this one)",
        ],
    ),
    (
        "[Ball.distnce > 1]",
        &["E0134 <distnce>: the message `Ball` has no field `distnce` (did you mean `distance`?)"],
    ),
    ("[Ball.distance.x > 1]", &["E0134 <x>: a number has no field `x` (remove `.x`)"]),
    ("[Ball.position.z > 1]", &["E0134 <z>: the message `Point` has no field `z` (did you mean `x`?)"]),
    (
        "[ball.Signal.Ball.distance > 1]",
        &[
            "E0135 <Signal.Ball>: the topic `ball` has no Signal messages of type `Ball` (write `` `soccer.ball`.State.Ball ``)",
        ],
    ),
    (
        "[behavior.State.Fall.fall > 1]",
        &[
            "E0135 <State.Fall>: the topic `behavior` has no State messages of type `Fall` (write `` `behavior`.State.Position `` or `` `behavior`.Signal.Fall ``)",
        ],
    ),
    (
        "[abs(1, 2) > 1]",
        &["E0136 <abs(1, 2)>: the function `abs` takes 1 argument, not 2 (it takes a number)"],
    ),
    (
        "[kick_off(1)]",
        &["E0136 <kick_off(1)>: the function `kick_off` takes 0 arguments, not 1 (it takes none)"],
    ),
    ("[abs() > 1]", &["E0136 <abs()>: the function `abs` takes 1 argument, not 0 (it takes a number)"]),
    (
        "[crowded(1,2,3,4,5,6,7,8,9)]",
        &[
            "E0136 <crowded(1,2,3,4,5,6,7,8,9)>: the function `crowded` takes 9 arguments (functions with more than 8 cannot be called by expressions)",
        ],
    ),
    (
        "[Ball.distance]",
        &[
            "E0137 <Ball.distance>: `Ball.distance` is a number, but true or false is needed here (compare it with something)",
        ],
    ),
    (
        "[Ball.found == 1]",
        &[
            "E0137 <Ball.found == 1>: `Ball.found` is true or false and `1` is a number: they cannot be compared (true and false are no numbers: write `x` or `!x`)",
        ],
    ),
    (
        "[GameState.player_state == 3]",
        &[
            "E0137 <GameState.player_state == 3>: `GameState.player_state` is a `PlayerState` and `3` is a number: they cannot be compared (write the name of a value of `PlayerState`)",
        ],
    ),
    (
        "[Ball.distance == \"3\"]",
        &[
            "E0137 <Ball.distance == \"3\">: `Ball.distance` is a number and `\"3\"` is a text: they cannot be compared (write numbers without quotes, texts with quotes)",
        ],
    ),
    (
        "[Ball.position == Ball.position]",
        &[
            "E0137 <Ball.position == Ball.position>: messages cannot be compared with each other (compare fields of them)",
        ],
    ),
    (
        "[Ball.colour < \"a\"]",
        &["E0137 <Ball.colour < \"a\">: `<` needs numbers, found a text (compare by `==` or `!=`)"],
    ),
    (
        "[Ball.found > true]",
        &["E0137 <Ball.found > true>: `>` needs numbers, found true or false (compare by `==` or `!=`)"],
    ),
    (
        "[GameState.player_state == GameState.phase]",
        &[
            "E0137 <GameState.player_state == GameState.phase>: `GameState.player_state` is a `PlayerState` and `GameState.phase` is a `Phase`: they cannot be compared (write the name of a value of `PlayerState`)",
        ],
    ),
    (
        "[Ball.distance + true > 1]",
        &[
            "E0137 <true>: `true` is true or false, but a number is needed here (write a number, or a field that holds one)",
        ],
    ),
    (
        "[-Ball.found]",
        &[
            "E0137 <Ball.found>: `Ball.found` is true or false, but a number is needed here (write a number, or a field that holds one)",
        ],
    ),
    (
        "[!Ball.distance]",
        &[
            "E0137 <Ball.distance>: `Ball.distance` is a number, but true or false is needed here (compare it with something)",
        ],
    ),
    (
        "[GameState.player_state < PLAYING]",
        &[
            "E0137 <GameState.player_state < PLAYING>: `<` needs numbers, found a `PlayerState` (compare by `==` or `!=`)",
        ],
    ),
    (
        "[abs(Ball.found) > 1]",
        &[
            "E0137 <Ball.found>: `Ball.found` is true or false, but a number is needed here (write a number, or a field that holds one)",
        ],
    ),
    (
        "[near(Arm, 1)]",
        &[
            "E0133 <Arm>: several topics have messages of type `Arm` (write `` `left.arm`.State.Arm `` or `` `right.arm`.State.Arm ``)",
        ],
    ),
    (
        "[near(GameState, 1)]",
        &[
            "E0137 <GameState>: `GameState` is a message `GameState`, but a message `Ball` is needed here (name a field of the message)",
        ],
    ),
    (
        "[near(ball.State.Ball.position, 1)]",
        &[
            "E0137 <ball.State.Ball.position>: `ball.State.Ball.position` is a message `Point`, but a message `Ball` is needed here (name a field of the message)",
        ],
    ),
    (
        "[ball.State.Ball]",
        &[
            "E0137 <ball.State.Ball>: `ball.State.Ball` is a message `Ball`, but true or false is needed here (name a field of the message)",
        ],
    ),
    (
        "[\"a\" && 1]",
        &[
            "E0137 <\"a\">: `\"a\"` is a text, but true or false is needed here (compare it with something)",
            "E0137 <1>: `1` is a number, but true or false is needed here (compare it with something)",
        ],
    ),
    (
        "[Ball.distance == NULL]",
        &[
            "E0138 <distance>: `distance` is a field; only whole messages can be absent (compare the message before it with NULL)",
        ],
    ),
    ("[Bal == NULL]", &["E0132 <Bal>: there is neither a message nor a topic `Bal` (did you mean `Ball`?)"]),
    (
        "[In(nowhere)]",
        &[
            "E0140 <nowhere>: there is no state `nowhere` (a state is named by its path, as in `outer/inner`, or the last names of it if they are unique)",
        ],
    ),
    ("[abz(1) > 1]", &["E0139 <abz>: there is no function `abz` (did you mean `abs`?)"]),
    (
        "/ StartTimeout(unknown, 1ms)",
        &[
            "E0141 <unknown>: the timer `unknown` is not one of this blackboard (a timer belongs to the blackboard of the transitions that start it)",
        ],
    ),
    (
        "/ StartTimeout(motion_timeout, 0.9ms)",
        &[
            "E0143 <StartTimeout(motion_timeout, 0.9ms)>: the delay of timer `motion_timeout` is too short (a delay is at least `1ms`)",
        ],
    ),
    (
        "/ Vision.Ball.distance = 1",
        &[
            "E0142 <Vision.Ball.distance>: `Vision.Ball.distance` is a variable of another publisher and cannot be assigned by a chart (a chart writes only its own messages: remove the prefix of the message)",
        ],
    ),
    (
        "/ striker.ball.State.Ball.distance = 1",
        &[
            "E0142 <striker.ball.State.Ball.distance>: `striker.ball.State.Ball.distance` is a variable of another publisher and cannot be assigned by a chart (a chart writes only its own messages: remove the prefix of the message)",
        ],
    ),
    (
        "/ Ball = 1",
        &[
            "E0145 <Ball>: `Ball` is a whole message; an assignment sets one field (name one of its fields, as in `Ball.distance`)",
        ],
    ),
    (
        "/ x = 1",
        &[
            "E0132 <x>: there is neither a message nor a topic `x` (a variable is `Message.field` or `topic.Kind.Message.field`)",
        ],
    ),
    (
        "/ Ball.distance = true",
        &[
            "E0137 <true>: `true` is true or false, but a number is needed here (write a number, or a field that holds one)",
        ],
    ),
    (
        "/ GameState.player_state = GONE",
        &["E0130 <GONE>: the enumeration `PlayerState` has no value `GONE` (known are PLAYING, READY)"],
    ),
    (
        "/ publish.Vision.Ball",
        &[
            "E0142 <Vision.Ball>: `Vision.Ball` is a variable of another publisher and cannot be published by a chart (a chart writes only its own messages: remove the prefix of the message)",
        ],
    ),
    (
        "/ publish.Ball.found",
        &[
            "E0145 <found>: `found` follows the message; a message is published as a whole (assign the field first)",
        ],
    ),
    ("/ publish.Bal", &["E0132 <Bal>: there is neither a message nor a topic `Bal` (did you mean `Ball`?)"]),
    (
        "/ raise(Ball)",
        &[
            "E0144 <Ball>: `Ball` is a message, and messages are not raised (give the event another name, or use `publish`)",
        ],
    ),
    (
        "/ raise(motion)",
        &[
            "E0144 <motion>: `motion` is a message, and messages are not raised (give the event another name, or use `publish`)",
        ],
    ),
    (
        "[script(\"x\")]",
        &[
            "E0147 <script(\"x\")>: the host of this chart has no scripts (write it as a condition or an action, or as a registered function)",
        ],
    ),
    (
        "ball.State.Ball.found",
        &[
            "E0146 <found>: `found` is a field; a trigger names a message (read it in a condition, in brackets)",
        ],
    ),
    (
        "striker.ball.State.Ball.found",
        &[
            "E0146 <found>: `found` is a field; a trigger names a message (read it in a condition, in brackets)",
        ],
    ),
    (
        "Message.Arm",
        &[
            "E0133 <Arm>: several topics have messages of type `Arm` (write `` `left.arm`.State.Arm `` or `` `right.arm`.State.Arm ``)",
        ],
    ),
    (
        "whistle",
        &[
            "E0133 <whistle>: several topics have the name `whistle` (write `` `left.whistle`.Signal.Sound `` or `` `right.whistle`.Signal.Sound ``)",
        ],
    ),
    (
        "Message.Nothing",
        &[
            "E0132 <Nothing>: there is neither a message nor a topic `Nothing` (a variable is `Message.field` or `topic.Kind.Message.field`)",
        ],
    ),
    (
        "e | nowhere.State.Ball",
        &[
            "E0132 <nowhere>: there is no topic `nowhere` (known are arm, ball, behavior, motion, state, whistle)",
        ],
    ),
    (
        "Message.Nothing [abz(1) > 1 && Ball.distance || zzz] / raise(Ball); Ball.found = 1",
        &[
            "E0132 <Nothing>: there is neither a message nor a topic `Nothing` (a variable is `Message.field` or `topic.Kind.Message.field`)",
            "E0139 <abz>: there is no function `abz` (did you mean `abs`?)",
            "E0137 <Ball.distance>: `Ball.distance` is a number, but true or false is needed here (compare it with something)",
            "E0130 <zzz>: there is no `zzz` here (a bare name is a timer started on this blackboard, a constant or a function without arguments)",
            "E0144 <Ball>: `Ball` is a message, and messages are not raised (give the event another name, or use `publish`)",
            "E0137 <1>: `1` is a number, but true or false is needed here (compare it with something)",
        ],
    ),
    (
        "[abs(a) > zz + yy]",
        &[
            "E0130 <a>: there is no `a` here (a bare name is a timer started on this blackboard, a constant or a function without arguments)",
            "E0130 <zz>: there is no `zz` here (a bare name is a timer started on this blackboard, a constant or a function without arguments)",
            "E0130 <yy>: there is no `yy` here (a bare name is a timer started on this blackboard, a constant or a function without arguments)",
        ],
    ),
];
