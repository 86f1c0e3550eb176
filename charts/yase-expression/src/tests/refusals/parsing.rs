//! Diagnostics of the parser.

use super::Table;

pub(crate) const PARSING: Table = &[
    ("[a # b]", &["E0101 <#>: `#` has no meaning here (names are letters, digits and `_`)"]),
    ("[a == \"b]", &["E0102 <\">: \" is not closed (close it with \")"]),
    ("/ publish.`a", &["E0102 <`>: ` is not closed (close it with `)"]),
    ("[a == \"\\q\"]", &["E0103 <\\q>: `\\q` is not an escape (escapes are \\\" \\\\ \\n \\r \\t)"]),
    (
        "[`` == 1]",
        &["E0104 <``>: there is no name in the backquotes (a topic's path is written `` `soccer.ball` ``)"],
    ),
    (
        "[a > 18446744073709551616]",
        &[
            "E0105 <18446744073709551616>: the number `18446744073709551616` is too large (whole numbers have 64 bits, others are floating point numbers of 64 bits)",
        ],
    ),
    (
        "[a > 1e999]",
        &[
            "E0105 <1e999>: the number `1e999` is too large (whole numbers have 64 bits, others are floating point numbers of 64 bits)",
        ],
    ),
    (
        "[a &&]",
        &[
            "E0106 <]>: an operand is expected, not `]` (an operand is a name, a number, a \"text\", `true`, `false` or a call)",
        ],
    ),
    (
        "[and]",
        &[
            "E0106 <and>: an operand is expected, not `and` (an operand is a name, a number, a \"text\", `true`, `false` or a call)",
        ],
    ),
    (
        "[a b]",
        &[
            "E0107 <b>: an operator or `]` is expected, not `b` (names have no blanks, numbers no unit; operators are `&&`, `||`, `==`, `<` and the like)",
        ],
    ),
    (
        "[0.25m > a]",
        &[
            "E0107 <m>: an operator or `]` is expected, not `m` (names have no blanks, numbers no unit; operators are `&&`, `||`, `==`, `<` and the like)",
        ],
    ),
    (
        "[blue-2.Vision.Ball.distance > 1]",
        &[
            "E0107 <.>: an operator or `]` is expected, not `.` (a name with a hyphen is written in backquotes: `` `blue-2` ``)",
        ],
    ),
    (
        "[blue - 2.a]",
        &[
            "E0107 <.>: an operator or `]` is expected, not `.` (names have no blanks, numbers no unit; operators are `&&`, `||`, `==`, `<` and the like)",
        ],
    ),
    ("[a = 1]", &["E0108 <=>: `=` assigns; a condition compares (write `==`)"]),
    ("[(a]", &["E0109 <(>: `(` is not closed (add `)`)"]),
    ("[f(a, b]", &["E0109 <(>: `(` is not closed (add `)`)"]),
    ("[(a", &["E0109 <(>: `(` is not closed (add `)`)"]),
    ("[a", &["E0110 <[>: `[` is not closed (add `]`)"]),
    ("[a)]", &["E0109 <)>: `)` closes nothing (remove it, or add `(`)"]),
    (
        "[1 < 2 < 3]",
        &["E0111 <<>: comparisons cannot be chained (write `a < b && b < c`, or use parentheses)"],
    ),
    ("[A.b(3) == 1]", &["E0113 <A.b>: the member `b` takes no arguments (write `A.b` or `A.b()`)"]),
    (
        "[A < NULL]",
        &[
            "E0114 <NULL>: NULL can only be compared with a message (write `Message == NULL` or `Message != NULL`; its negation is `!(Message == NULL)`)",
        ],
    ),
    (
        "[NULL]",
        &[
            "E0114 <NULL>: NULL can only be compared with a message (write `Message == NULL` or `Message != NULL`; its negation is `!(Message == NULL)`)",
        ],
    ),
    (
        "[f(x) == NULL]",
        &[
            "E0114 <NULL>: NULL can only be compared with a message (write `Message == NULL` or `Message != NULL`; its negation is `!(Message == NULL)`)",
        ],
    ),
    (
        "[NULL + 1 == 2]",
        &[
            "E0114 <NULL>: NULL can only be compared with a message (write `Message == NULL` or `Message != NULL`; its negation is `!(Message == NULL)`)",
        ],
    ),
    (
        "[A.]",
        &[
            "E0115 <]>: a name is expected, not `]` (a name is letters, digits and `_`; put blanks around `lt`, `gt` and the like)",
        ],
    ),
    (
        "[A.5 > 2]",
        &[
            "E0115 <5>: a name is expected, not `5` (a name is letters, digits and `_`; put blanks around `lt`, `gt` and the like)",
        ],
    ),
    (
        "[In()]",
        &["E0115 <In()>: there is no state in the parentheses (write `In(state)` or `In(outer/inner)`)"],
    ),
    ("a, b", &["E0116 <,>: `,` does not belong to a trigger (alternative events are written `a | b`)"]),
    (
        "a.b()()",
        &[
            "E0116 <(>: `(` does not belong to a trigger (an event is a name; conditions are in brackets, actions after `/`)",
        ],
    ),
    (
        "f(x)",
        &[
            "E0116 <(>: `(` does not belong to a trigger (an event is a name; conditions are in brackets, actions after `/`)",
        ],
    ),
    (
        "StartTimeout(v, 100ms)",
        &[
            "E0116 <(>: `(` does not belong to a trigger (an event is a name; conditions are in brackets, actions after `/`)",
        ],
    ),
    (
        "e1 |",
        &[
            "E0116 <>: an event is expected, not the end (an event is a name; conditions are in brackets, actions after `/`)",
        ],
    ),
    (
        "(e)",
        &[
            "E0116 <(>: `(` does not belong to a trigger (an event is a name; conditions are in brackets, actions after `/`)",
        ],
    ),
    (
        "not",
        &[
            "E0116 <>: an event is expected, not the end (an event is a name; conditions are in brackets, actions after `/`)",
        ],
    ),
    ("[]", &["E0117 <[]>: the brackets are empty (remove the brackets, or write `[true]`)"]),
    (
        "[a]/",
        &[
            "E0118 <>: an action is expected, not the end (an action is `Message.field = value`, `publish.Message`, `StartTimeout(v, 100ms)`, `raise(event)`, `process_messages` or `publish_all`)",
        ],
    ),
    (
        "[a]/;x",
        &[
            "E0118 <;>: an action is expected, not `;` (an action is `Message.field = value`, `publish.Message`, `StartTimeout(v, 100ms)`, `raise(event)`, `process_messages` or `publish_all`)",
            "E0118 <x>: `x` is not an action (an action is `Message.field = value`, `publish.Message`, `StartTimeout(v, 100ms)`, `raise(event)`, `process_messages` or `publish_all`)",
        ],
    ),
    ("[a]/x == 1", &["E0118 <==>: `==` compares; an action assigns (write `=`)"]),
    (
        "[a]/foo",
        &[
            "E0118 <foo>: `foo` is not an action (an action is `Message.field = value`, `publish.Message`, `StartTimeout(v, 100ms)`, `raise(event)`, `process_messages` or `publish_all`)",
        ],
    ),
    (
        "[a]/foo(3)",
        &[
            "E0118 <foo>: `foo` is called for its effect, but functions have none (an action is `Message.field = value`, `publish.Message`, `StartTimeout(v, 100ms)`, `raise(event)`, `process_messages` or `publish_all`)",
        ],
    ),
    (
        "[a]/1",
        &[
            "E0118 <1>: an action is expected, not `1` (an action is `Message.field = value`, `publish.Message`, `StartTimeout(v, 100ms)`, `raise(event)`, `process_messages` or `publish_all`)",
        ],
    ),
    ("/StartTimeout(v)", &["E0119 <)>: a delay is expected, not `)` (write `StartTimeout(v, 100ms)`)"]),
    (
        "/StartTimeout(v, 100)",
        &["E0119 <100>: `100` is not a delay (write a number with its unit: `100ms`, `1.5s`)"],
    ),
    (
        "/StartTimeout(v, patience)",
        &[
            "E0119 <patience>: `patience` is not a delay (write a number with its unit: `100ms`, `1.5s`; names have no value here)",
        ],
    ),
    ("/StartTimeout(v, )", &["E0119 <>: a delay is missing (write a number with its unit: `100ms`, `1.5s`)"]),
    ("/StartTimeout(v, 100ms", &["E0109 <(>: `(` is not closed (add `)`)"]),
    ("/TimeoutAction.v", &["E0119 <>: a delay is expected, not the end (write `TimeoutAction.v.100`)"]),
    ("/TimeoutAction.v.100ms", &["E0119 <>: a delay is expected, not the end (write `TimeoutAction.v.100`)"]),
    (
        "/TimeoutAction.100",
        &[
            "E0115 <100>: a name is expected, not `100` (a name is letters, digits and `_`; put blanks around `lt`, `gt` and the like)",
        ],
    ),
    ("[a] b", &["E0120 <b>: unexpected `b` after the expression (the form is `trigger [guard] / actions`)"]),
    (
        "/a.b = 1 c.d = 2",
        &["E0120 <c>: `;` or the end is expected, not `c` (actions are separated by `;` or `,`)"],
    ),
    (
        "/A.get_x(3)",
        &[
            "E0121 <A.get_x>: `A.get_x` is not a setter (write `Message.set_field(value)` or `Message.field = value`)",
        ],
    ),
    (
        "/A.set_(3)",
        &[
            "E0121 <A.set_>: `A.set_` is not a setter (write `Message.set_field(value)` or `Message.field = value`)",
        ],
    ),
    (
        "/set_x(3)",
        &[
            "E0118 <set_x>: `set_x` is called for its effect, but functions have none (an action is `Message.field = value`, `publish.Message`, `StartTimeout(v, 100ms)`, `raise(event)`, `process_messages` or `publish_all`)",
        ],
    ),
    (
        "/publish.A.x(3)",
        &["E0121 <A.x>: `A.x` is not a setter (write `Message.set_field(value)` or `Message.field = value`)"],
    ),
    ("[a | b]", &["E0122 <|>: `|` is not an operator of conditions (write `||`)"]),
    ("[script(x)]", &["E0123 <x>: a text is expected, not `x` (write `script(\"text\")`)"]),
    ("[a & b]", &["E0122 <&>: `&` is not an operator of conditions (write `&&`)"]),
    ("/ x.y = #", &["E0101 <#>: `#` has no meaning here (names are letters, digits and `_`)"]),
    ("#", &["E0101 <#>: `#` has no meaning here (names are letters, digits and `_`)"]),
    (
        "[TimeoutCheck(3)]",
        &[
            "E0115 <3>: a name is expected, not `3` (a name is letters, digits and `_`; put blanks around `lt`, `gt` and the like)",
        ],
    ),
    (
        "/raise(3)",
        &[
            "E0115 <3>: a name is expected, not `3` (a name is letters, digits and `_`; put blanks around `lt`, `gt` and the like)",
        ],
    ),
    (
        "/raise(a b)",
        &[
            "E0107 <b>: an operator or `)` is expected, not `b` (names have no blanks, numbers no unit; operators are `&&`, `||`, `==`, `<` and the like)",
        ],
    ),
    ("[a]]", &["E0120 <]>: unexpected `]` after the expression (the form is `trigger [guard] / actions`)"]),
    (
        "/publish",
        &[
            "E0118 <publish>: `publish` is not an action (an action is `Message.field = value`, `publish.Message`, `StartTimeout(v, 100ms)`, `raise(event)`, `process_messages` or `publish_all`)",
        ],
    ),
];
