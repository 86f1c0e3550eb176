//! Values, conversions and refusals.

use super::*;

struct ActiveNames(&'static [&'static str]);

impl InPredicate for ActiveNames {
    fn is_in(&self, state: &str) -> bool {
        self.0.contains(&state)
    }
}

/// The value of an expression after a script has run, as JSON.
fn after(script: &str, expression: &str) -> Result<String, String> {
    let mut memory = ScriptMemory::new();
    let active = ActiveNames(&["a", "b"]);
    let mut evaluation = Evaluator::new(&mut memory, &active);
    let program = parse_program(script).map_err(|refused| refused.message)?;
    evaluation.run(&program).map_err(|fault| fault.message)?;
    let expression = parse_expression(expression).map_err(|refused| refused.message)?;
    let value = evaluation.value(&expression).map_err(|fault| fault.message)?;
    memory.export(&value).map(|data| data.to_string()).map_err(|fault| fault.message)
}

fn value(expression: &str) -> String {
    after("", expression).unwrap()
}

fn fault(script: &str, expression: &str) -> String {
    after(script, expression).unwrap_err()
}

#[test]
fn literals_are_what_they_say() {
    for (written, worth) in [
        ("1", "1"),
        ("0x1F", "31"),
        (".5e1", "5"),
        ("'it\\'s \\u0041\\x42\\n'", "\"it's AB\\n\""),
        ("[1, 'a', [true, null, undefined],]", "[1,\"a\",[true,null,undefined]]"),
        ("{a: 1, 'b c': [2], 3: {}}", "{\"a\":1,\"b c\":[2],\"3\":{}}"),
        ("1 /* one */ // and no more", "1"),
    ] {
        assert_eq!(value(written), worth, "{written}");
    }
}

#[test]
fn operators_bind_as_in_ecmascript() {
    for (written, worth) in [
        ("1 + 2 * 3 - 4 / 2", "5"),
        ("7 % 4 + -1", "2"),
        ("1 < 2 == true", "true"),
        ("!0 && 1 || 2", "1"),
        ("0 || '' || 'last'", "\"last\""),
        ("1 && 2 && 3", "3"),
        ("false ? 1 : true ? 2 : 3", "2"),
        ("typeof typeof 1", "\"string\""),
        ("- - 3", "3"),
        ("'b' in {b: 1} && !('c' in {b: 1})", "true"),
        ("1 in [5, 6] && !(2 in [5, 6])", "true"),
        ("In('a') && !In('c')", "true"),
    ] {
        assert_eq!(value(written), worth, "{written}");
    }
}

#[test]
fn values_are_converted_as_in_ecmascript() {
    for (written, worth) in [
        ("'1' + 2", "\"12\""),
        ("1 + true", "2"),
        ("'6' * '7'", "42"),
        ("'x' * 1", "NaN"),
        ("[1, 2] + ''", "\"1,2\""),
        ("{} + ''", "\"[object Object]\""),
        ("1 == '1.0'", "true"),
        ("1 === '1'", "false"),
        ("null == undefined", "true"),
        ("null == 0", "false"),
        ("true == '1'", "true"),
        ("NaN == NaN", "false"),
        ("[123] == 123", "true"),
        ("[1] == [1]", "false"),
        ("'' == 0", "true"),
        ("'10' < '9'", "true"),
        ("10 < '9'", "false"),
        ("undefined < 1 || undefined >= 1", "false"),
        ("String(null) + String(undefined) + String(false)", "\"nullundefinedfalse\""),
        ("typeof null + typeof [] + typeof function() {}", "\"objectobjectfunction\""),
    ] {
        assert_eq!(value(written), worth, "{written}");
    }
}

#[test]
fn numbers_are_written_as_in_ecmascript() {
    for (written, worth) in [
        ("1.0", "1"),
        ("0.1 + 0.2", "0.30000000000000004"),
        ("1e21", "1e+21"),
        ("123456789012345680000", "123456789012345680000"),
        ("0.000001", "0.000001"),
        ("0.0000001", "1e-7"),
        ("-1.5e-9", "-1.5e-9"),
        ("-0", "0"),
        ("1 / 0", "Infinity"),
        ("-1 / 0", "-Infinity"),
    ] {
        assert_eq!(value(written), worth, "{written}");
    }
}

#[test]
fn members_and_methods() {
    for (written, worth) in [
        ("{a: {b: [7]}}.a['b'][0]", "7"),
        ("[1, 2].length + 'abc'.length", "5"),
        ("'häuser'[1]", "\"ä\""),
        ("[].concat([1], 2, [[3]])", "[1,2,[3]]"),
        ("'abcdef'.slice(1, -1)", "\"bcde\""),
        ("[1, 2, 3, 4].slice(-2)", "[3,4]"),
        ("[1, null, 'x'].join('-')", "\"1--x\""),
        ("{}.nothing", "undefined"),
        ("[1][5]", "undefined"),
    ] {
        assert_eq!(value(written), worth, "{written}");
    }
    assert_eq!(fault("", "undefined.a"), "undefined has no member `a`");
    assert_eq!(fault("", "null.a"), "null has no member `a`");
    assert_eq!(fault("", "(5).slice()"), "the value has no method `slice`");
    assert_eq!(fault("", "'a'()"), "what is called is not a function");
}

#[test]
fn scripts_assign() {
    for (script, expression, worth) in [
        ("var a = 1, b; a += 2; a *= a", "a", "9"),
        ("var i = 0; i++; ++i; i--", "i", "1"),
        ("var t = '5'; t++", "t", "6"),
        ("var o = {}; o.a = 1; o['b'] = [2]; o.b[2] = 3", "o", "{\"a\":1,\"b\":[2,undefined,3]}"),
        ("x = 1", "x", "1"),
        ("var a = []; var b = a; b.push(1, 2)", "a", "[1,2]"),
        ("var a = 1\nvar b = 2", "a + b", "3"),
        ("if (1 > 2) { x = 1 } else if (2 > 1) x = 2; else x = 3", "x", "2"),
        ("function f(a, b) { var c = a; if (b) { return c + b } return c }", "f(1) + f(1, 2)", "4"),
        ("x = f(); function f() { return 'early' }", "x", "\"early\""),
        ("var x = 1; function f(x) { x = 5; y = x; } f(2)", "[x, y]", "[1,5]"),
        ("function f(n) { return n < 2 ? 1 : n * f(n - 1) }", "f(10)", "3628800"),
    ] {
        assert_eq!(after(script, expression).as_deref(), Ok(worth), "{script}");
    }
}

#[test]
fn unassignable_values_are_errors() {
    assert_eq!(fault("_event = 1", "1"), "`_event` cannot be assigned");
    assert_eq!(fault("_name.x = 1", "1"), "`_name` cannot be assigned");
    assert_eq!(fault("var a = 1; a.b.c = 2", "1"), "`c` is assigned to what is not an object");
    assert_eq!(fault("nowhere.a = 1", "1"), "there is no variable `nowhere`");
    assert_eq!(fault("var a = []; a.x = 1", "1"), "`x` is not a place in an array");
    assert_eq!(fault("", "nothing + 1"), "there is no variable `nothing`");
    assert_eq!(value("typeof nothing"), "\"undefined\"");
}

#[test]
fn invalid_and_unsupported_ecmascript_are_distinguished() {
    let refusal = |text: &str| parse_program(text).unwrap_err();
    for text in
        ["return", "'open", "{p1: 'v1'", "1 +", "a b", "(1", "var 1", "1x", "\"foo", "#", "f(,)", "1 = 2"]
    {
        assert_eq!(refusal(text).refusal, ScriptErrorKind::Malformed, "{text}");
    }
    for (text, span) in [
        ("for (;;) {}", 0..3),
        ("x = new Date()", 4..7),
        ("x = Math.random()", 4..15),
        ("x = Math", 4..8),
        ("x = JSON.parse('1')", 4..14),
        ("x = y.toUpperCase()", 6..17),
        ("x = /a+/", 4..5),
        ("x = a => a", 6..8),
        ("x = `a`", 4..5),
        ("x = a & b", 6..7),
        ("throw 1", 0..5),
        ("function f() { return function() {} }", 22..30),
    ] {
        let refused = refusal(text);
        assert_eq!((refused.refusal, refused.span), (ScriptErrorKind::Unsupported, span.into()), "{text}");
    }
}

#[test]
fn numbers_are_computed_by_the_library() {
    for (written, worth) in [
        ("Math.pow(2, 10) + Math.abs(-1)", "1025"),
        ("[Math.max(), Math.max(1, '7', 3), Math.min(2, 1)]", "[-Infinity,7,1]"),
        ("[Math.round(2.5), Math.round(-2.5), Math.round(0.49999999999999994)]", "[3,-2,0]"),
        ("[Math.sign(-3), Math.trunc(-1.5), Math.hypot(3, 4), Math.sqrt(2) == Math.SQRT2]", "[-1,-1,5,true]"),
        (
            "[Math.pow(1, NaN), Math.max(1, NaN), Math.floor(), Math.atan2(0, -1) == Math.PI]",
            "[NaN,NaN,NaN,true]",
        ),
        ("Math.sin(1)", "0.8414709848078965"),
        ("[isNaN('a'), isNaN(1), isFinite(1 / 0), isFinite('3')]", "[true,false,false,true]"),
    ] {
        assert_eq!(value(written), worth, "{written}");
    }
}

#[test]
fn values_are_written_as_json() {
    for (written, json) in [
        (
            "JSON.stringify({a: [1, undefined, NaN, null], b: undefined, 'c d': 'e\\n\\u0001'})",
            r#"{"a":[1,null,null,null],"c d":"e\n\u0001"}"#,
        ),
        (
            "JSON.stringify({a: [1, {}], b: []}, null, 2)",
            "{\n  \"a\": [\n    1,\n    {}\n  ],\n  \"b\": []\n}",
        ),
        ("JSON.stringify('a')", "\"a\""),
    ] {
        let text = DataValue::Text(json.into()).to_string();
        assert_eq!(value(written), text, "{written}");
    }
    assert_eq!(value("JSON.stringify(undefined)"), "undefined");
    assert_eq!(value("typeof JSON.stringify(function () {})"), "\"undefined\"");
    let cycle = fault("a = {}; a.a = a", "JSON.stringify(a)");
    assert_eq!(cycle, "the value lies in itself, or is nested too deeply for JSON");
    assert!(fault("", "JSON.stringify({}, ['a'])").contains("no replacer"));
}

#[test]
fn nesting_is_limited_and_chains_are_not() {
    let deep = format!("{}1{}", "(".repeat(10_000), ")".repeat(10_000));
    assert!(parse_expression(&deep).is_err());
    let negated = format!("{}1", "!".repeat(10_000));
    assert!(parse_expression(&negated).is_err());
    let long = vec!["1"; 20_000].join("+");
    assert_eq!(value(&long), "20000");
}

#[test]
fn work_and_memory_are_limited() {
    let forever = "function f(a) { return f(a) }";
    assert!(fault(forever, "f(1)").contains("nest deeper"), "recursion");
    let twice = "function f(n) { if (n > 0) { f(n - 1); f(n - 1) } }";
    assert!(fault(twice, "f(40)").contains("steps of evaluation"), "work");
    let doubling = vec!["s = s + s;"; 40].join("");
    assert!(fault(&format!("var s = 'xxxxxxxx'; {doubling}"), "1").contains("longer than"), "texts");
    let growing = vec!["a = a.concat(a);"; 40].join("");
    assert!(fault(&format!("var a = [1, 2]; {growing}"), "1").contains("bytes"), "arrays");
    assert!(fault("var a = []; a[1000000000] = 1", "1").contains("not a place"), "gaps");
    assert!(fault("var a = []; a.push(a)", "a").contains("lies in itself"), "circles");
    assert!(fault("var a = []; a.push(a)", "a + ''").contains("lies in itself"), "circles as texts");
    let sharing = vec!["a = [a, a];"; 60].join("");
    assert!(fault(&format!("var a = 1; {sharing}"), "a").contains("too large"), "shared parts");
}

/// The value of an expression if its evaluation takes at most 2,000 steps.
fn cheap(memory: &mut ScriptMemory, expression: &str) -> Result<ScriptValue, String> {
    memory.refresh();
    memory.charge_reading(64 * 1_998_000).unwrap();
    let expression = parse_expression(expression).unwrap();
    Evaluator::new(memory, &ActiveNames(&[])).value(&expression).map_err(|fault| fault.message)
}

#[test]
fn conversions_are_charged_by_their_length() {
    let mut memory = ScriptMemory::new();
    let doubling = "s = s + s;".repeat(18);
    let script = format!("var a = []; a[262143] = 1; var s = ' '; {doubling} var b = [s]");
    Evaluator::new(&mut memory, &ActiveNames(&[])).run(&parse_program(&script).unwrap()).unwrap();
    assert!(cheap(&mut memory, "a.length").is_ok());
    for long in ["a", "b"] {
        for expression in [
            "# == 'x'",
            "# == 1",
            "# < 1",
            "# + 1",
            "# - 1",
            "-#",
            "isNaN(#)",
            "Math.max(#)",
            "String(#)",
            "JSON.stringify(#)",
            "# in {}",
            "{}[#]",
            "[1, 2].join(#)",
            "'x'.concat(#)",
        ] {
            let said = cheap(&mut memory, &expression.replace('#', long)).unwrap_err();
            assert!(said.contains("steps of evaluation"), "{expression} of {long}: {said}");
        }
    }
    for expression in ["-s", "[].concat(a)", "a.join('')"] {
        let said = cheap(&mut memory, expression).unwrap_err();
        assert!(said.contains("steps of evaluation"), "{expression}: {said}");
    }
    memory.refresh();
    memory.charge_reading(64 * 1_998_000).unwrap();
    let copied = memory.get("a").cloned().unwrap();
    assert!(memory.export(&copied).unwrap_err().message.contains("steps of evaluation"));
}

#[test]
fn unreachable_objects_are_freed() {
    let mut memory = ScriptMemory::new();
    let program =
        parse_program("a = {self: 0, text: 'xxxxxxxx'.concat('y')}; a.self = a; b = [1, 2, 3]").unwrap();
    for _ in 0..30_000 {
        Evaluator::new(&mut memory, &ActiveNames(&[])).run(&program).unwrap();
        memory.collect_garbage().unwrap();
        memory.refresh();
    }
    let kept = parse_expression("a.self.self.text + b.join('')").unwrap();
    let worth = Evaluator::new(&mut memory, &ActiveNames(&[])).value(&kept).unwrap();
    assert_eq!(worth, ScriptValue::Text("xxxxxxxxy123".into()));
}

#[test]
fn json_is_json() {
    for json in ["[1, 2.5e3, -1]", "{\"a\": [true, null]}", "\"text\"", "12"] {
        assert!(is_json(json), "{json}");
    }
    for other in ["'text'", "{a: 1}", "some words", "1 + 1", "undefined", "[1", ""] {
        assert!(!is_json(other), "{other}");
    }
}
