//! Behaviours of states, transitions, events, entering, exiting and final states.

use crate::admits;

#[test]
fn behavior_001_and_002() {
    let chart = "
        START
        wait
        S1 | entry=raise(n1) | exit=raise(x1)
        END
        c/START -> wait
        wait -> S1 : go
        S1 -> END : / raise(t2)
        ";
    admits(chart, "1 go; 9", "n1 x1 t2");
}

#[test]
fn behavior_003_a() {
    admits(
        "
        START
        wait
        S1 | run | for=5ms | entry=raise(n1)
        END
        c/START -> wait
        wait -> S1 : go
        S1 -> END : other / raise(t4)
        ",
        "1 go; 1 other; 9",
        "n1 t4
         n1 d1 t4",
    );
}

#[test]
fn behavior_003_b() {
    admits(
        "
        START
        wait
        S1 | run | for=5ms | entry=raise(n1)
        last
        END
        c/START -> wait
        wait -> S1 : go
        S1 -> last : / raise(t3)
        last -> END : / raise(t4)
        ",
        "1 go; 9",
        "n1 d1 t3 t4",
    );
}

#[test]
fn behavior_003_c() {
    admits(
        "
        START
        wait
        S1 | run | for=5ms
        END
        c/START -> wait
        wait -> S1 : go
        S1 -> END : / raise(t3)
        ",
        "1 go; 9",
        "d1 t3",
    );
}

#[test]
fn transition_001() {
    admits(
        "
        START
        wait
        S1
        END
        c/START -> wait
        wait -> S1 : go / raise(t2)
        S1 -> END : / raise(t3)
        ",
        "1 go; 9",
        "t2 t3",
    );
}

#[test]
fn transition_007() {
    admits(
        "
        START
        wait
        S1
        S2
        END
        c/START -> wait : / raise(t1)
        wait -> S1 : go / raise(t2)
        S1 -> S2 : continue / raise(t3)
        S2 -> END : continue / raise(t4)
        ",
        "1 go; 2 continue; 3 continue; 9",
        "t1 t2 t3 t4",
    );
}

#[test]
fn transition_010() {
    admits(
        "
        START
        wait | exit=raise(x0)
        S1 | entry=raise(n1) | exit=raise(x1)
        END
        c/START -> wait
        wait -> S1 : go
        S1 -> S1 {internal} : other / raise(t1)
        S1 -> END : continue / raise(t2)
        ",
        "1 go; 2 other; 3 other; 4 continue; 9",
        "x0 n1 t1 t1 x1 t2",
    );
}

#[test]
fn transition_011_a() {
    admits(
        "
        START
        wait
        S1 | exit=raise(x1)
          START
          S11 | entry=raise(n11) | exit=raise(x11)
          S12 | entry=raise(n12)
          END
        END
        c/START -> wait
        wait -> S1 : go
        S1/START -> S11
        S1 -> S12 {internal} : continue / raise(t13)
        S12 -> S1/END
        S1 -> c/END : / raise(t3)
        ",
        "1 go; 2 continue; 9",
        "n11 x11 t13 n12 x1 t3",
    );
}

#[test]
fn transition_011_c() {
    admits(
        "
        START
        wait
        S1 | entry=raise(n1) | exit=raise(x1)
          START
          S11 | entry=raise(n11) | exit=raise(x11)
          S12 | exit=raise(x12)
        END
        c/START -> wait
        wait -> S1 : go
        S1/START -> S11
        S11 -> S12 : continue
        S12 -> S1 : / raise(t13)
        S1 -> c/END
        ",
        "1 go; 2 continue; 9",
        "n1 n11 x11 x12 t13 x1",
    );
}

#[test]
fn transition_015() {
    admits(
        "
        START
        wait
        S1 | run | for=5ms | entry=raise(n1)
        END
        c/START -> wait
        wait -> S1 : go
        S1 -> END : / raise(t3)
        ",
        "1 go; 9",
        "n1 d1 t3",
    );
}

#[test]
fn transition_016() {
    admits(
        "
        START
        wait
        & S1
          one
            START
            S11
            END
          two
            START
            S21
            END
        END
        c/START -> wait
        wait -> S1 : go / raise(t2)
        one/START -> S11
        S11 -> one/END
        two/START -> S21
        S21 -> two/END
        S1 -> c/END : / raise(t3)
        ",
        "1 go; 9",
        "t2 t3",
    );
}

#[test]
fn transition_017() {
    admits(
        "
        START
        wait
        & S1 | entry=raise(n1)
          one
            START
            S21
            END
          two
            START
            S31 | run
              START
              S311
              END
            END
        END
        c/START -> wait
        wait -> S1 : go / raise(t2)
        one/START -> S21
        S21 -> one/END : / raise(t22)
        two/START -> S31
        S31/START -> S311
        S311 -> S31/END : / raise(t312)
        S31 -> two/END : / raise(t32)
        S1 -> c/END : / raise(t3)
        ",
        "1 go; 9",
        "t2 n1 d31 t22 t312 t32 t3
         t2 n1 t22 d31 t312 t32 t3
         t2 n1 t22 t312 d31 t32 t3
         t2 n1 t312 t22 d31 t32 t3",
    );
}

#[test]
fn transition_020() {
    admits(
        "
        START
        wait
        S1 | entry=raise(n1)
        S2
        END
        c/START -> wait
        wait -> S1 : go
        S1 -> S2 : [false] / raise(t3)
        S1 -> S2 : continue / raise(t4)
        S2 -> END : / raise(t5)
        ",
        "1 go; 2 continue; 9",
        "n1 t4 t5",
    );
}

#[test]
fn event_001() {
    admits(
        "
        START
        wait | exit=raise(x0)
        END
        c/START -> wait
        wait -> END : go / raise(t2)
        ",
        "1 go; 9",
        "x0 t2",
    );
}

#[test]
fn event_002() {
    admits(
        "
        START
        wait
        S1 | entry=raise(n1) | exit=raise(x1)
          START
          S11 | entry=raise(n11)
        END
        c/START -> wait
        wait -> S1 : go
        S1/START -> S11
        S1 -> c/END : continue / raise(t3)
        ",
        "1 go; 2 continue; 9",
        "n1 n11 x1 t3",
    );
}

#[test]
fn event_008() {
    admits(
        "
        START
        wait
        S1
        S2
        END
        c/START -> wait
        wait -> S1 : go / raise(t2)
        S1 -> S2 : continue | other / raise(t3)
        S2 -> END : / raise(t4)
        ",
        "1 go; 2 continue; 9",
        "t2 t3 t4",
    );
}

#[test]
fn event_009() {
    admits(
        "
        START
        wait
        & S1
          one
            START
            S11
            END
          two
            START
            S21
            END
        END
        c/START -> wait
        wait -> S1 : go
        one/START -> S11
        S11 -> one/END : other / raise(t12)
        two/START -> S21
        S21 -> two/END : continue / raise(t22)
        S1 -> c/END : / raise(t5)
        ",
        "1 go; 2 other; 3 continue; 9",
        "t12 t22 t5",
    );
}

#[test]
fn event_010() {
    admits(
        "
        START
        wait
        S1 | entry=raise(n1)
          START
          S11 | entry=raise(n11)
          S12 | entry=raise(n12)
          END
        END
        c/START -> wait
        wait -> S1 : go / raise(t2)
        S1/START -> S11
        S11 -> S12 : continue / raise(t12)
        S12 -> S1/END
        S1 -> c/END : continue / raise(t3)
        S1 -> c/END : / raise(t4)
        ",
        "1 go; 2 continue; 9",
        "t2 n1 n11 t12 n12 t4",
    );
}

#[test]
fn event_015() {
    admits(
        "
        START
        wait
        S1
          START
          S11
          END
        END
        c/START -> wait
        wait -> S1 : go
        S1/START -> S11
        S11 -> S1/END : / raise(t12)
        S11 -> S1/END : / raise(t13)
        S1 -> c/END : / raise(t3)
        ",
        "1 go; 9",
        "t12 t3
         t13 t3",
    );
}

#[test]
fn event_016_a() {
    admits(
        "
        START
        wait
        S1
          START
          S11
          END
        S2
        END
        c/START -> wait
        wait -> S1 : go
        S1/START -> S11
        S11 -> S1/END : continue / raise(t12)
        S1 -> S2 : continue / raise(t3)
        S2 -> c/END : / raise(t4)
        ",
        "1 go; 2 continue; 3 continue; 9",
        "t12 t3 t4",
    );
}

#[test]
fn event_016_b() {
    admits(
        "
        START
        wait
        & S1 | exit=raise(x1)
          one
            START
            S11
            S12 | exit=raise(x12)
          two
            START
            & S21 | exit=raise(x21)
              three
                START
                S211
                END
              four
                START
                S221
                END
            S22
        END
        c/START -> wait
        wait -> S1 : go
        one/START -> S11
        S11 -> S12 : continue / raise(t12)
        two/START -> S21
        three/START -> S211
        S211 -> three/END : continue / raise(t212)
        four/START -> S221
        S221 -> four/END : continue / raise(t222)
        S21 -> S22 : continue / raise(t22)
        S1 -> c/END : continue / raise(t3)
        ",
        "1 go; 2 continue; 3 continue; 4 continue; 9",
        "t12 t212 t222 x21 t22 x12 x1 t3",
    );
}

#[test]
fn event_018() {
    admits(
        "
        START
        wait
        S1 | exit=raise(x1)
          START
          S11 | exit=raise(x11)
            START
            S111 | exit=raise(x111)
        S2 | entry=raise(n2)
          START
          S12 | entry=raise(n12)
          END
        END
        c/START -> wait
        wait -> S1 : go
        S1/START -> S11
        S11/START -> S111
        S111 -> S2 : / raise(t3)
        S2/START -> S12
        S12 -> S2/END
        S2 -> c/END : / raise(t4)
        ",
        "1 go; 9",
        "x111 x11 x1 t3 n2 n12 t4",
    );
}

#[test]
fn entering_004() {
    admits(
        "
        START
        wait
        S1 | entry=raise(n1) | exit=raise(x1)
          S11
          END
        END
        c/START -> wait
        wait -> S11 : go
        S11 -> S1/END
        S1 -> c/END : / raise(t3)
        ",
        "1 go; 9",
        "n1 x1 t3",
    );
}

#[test]
fn entering_005() {
    admits(
        "
        START
        wait
        S1 | entry=raise(n1)
          START
          S11 | entry=raise(n11)
            START
            S111 | entry=raise(n111)
            END
        c/START -> wait
        wait -> S1 : go / raise(t2)
        S1/START -> S11
        S11/START -> S111
        S111 -> S11/END : / raise(t112)
        ",
        "1 go; 9",
        "t2 n1 n11 n111 t112",
    );
}

#[test]
fn entering_010() {
    admits(
        "
        START
        wait
        & S1 | entry=raise(n1)
          one
            START
            S11 | entry=raise(n11)
            END
          two
            START
            S21 | entry=raise(n21)
            END
        END
        c/START -> wait
        wait -> S11 : go
        one/START -> S11 : / raise(t11)
        S11 -> one/END
        two/START -> S21 : / raise(t21)
        S21 -> two/END
        S1 -> c/END : / raise(t3)
        ",
        "1 go; 9",
        "n1 t21 n21 n11 t3
         n1 t21 n11 n21 t3
         n1 n11 t21 n21 t3",
    );
}

#[test]
fn entering_011() {
    admits(
        "
        START
        wait
        & S1 | entry=raise(n1)
          one
            START
            S12 | entry=raise(n12)
            END
          two
            START
            S11 | entry=raise(n11)
            END
        END
        c/START -> wait
        wait -> S1 : go
        one/START -> S12 : / raise(t21)
        S12 -> one/END
        two/START -> S11 : / raise(t11)
        S11 -> two/END
        S1 -> c/END : continue / raise(t3)
        ",
        "1 go; 2 continue; 9",
        "n1 t21 n12 t11 n11 t3
         n1 t11 n11 t21 n12 t3
         n1 t21 t11 n12 n11 t3
         n1 t21 t11 n11 n12 t3
         n1 t11 t21 n11 n12 t3
         n1 t11 t21 n12 n11 t3",
    );
}

#[test]
fn exiting_001() {
    admits(
        "
        START
        wait
        & S1 | exit=raise(x1)
          one
            START
            S11 | exit=raise(x11)
              START
              S111 | exit=raise(x111)
          two
            START
            S21 | exit=raise(x21)
        END
        c/START -> wait
        wait -> S1 : go
        one/START -> S11
        S11/START -> S111
        two/START -> S21
        S1 -> c/END : continue / raise(t3)
        ",
        "1 go; 2 continue; 9",
        "x111 x11 x21 x1 t3
         x111 x21 x11 x1 t3
         x21 x111 x11 x1 t3",
    );
}

#[test]
fn exiting_002() {
    admits(
        "
        START
        wait
        S1 | run | for=5ms | exit=raise(x1)
        END
        c/START -> wait
        wait -> S1 : go
        S1 -> END : continue
        ",
        "1 go; 2 continue; 9",
        "d1 x1",
    );
}

#[test]
fn exiting_003() {
    admits(
        "
        START
        wait
        S1 | exit=raise(x1)
          START
          & S11 | exit=raise(x11)
            one
              START
              S111 | exit=raise(x111)
            two
              START
              S121 | exit=raise(x121)
        END
        c/START -> wait
        wait -> S1 : go
        S1/START -> S11
        one/START -> S111
        two/START -> S121
        S1 -> c/END : continue / raise(t3)
        ",
        "1 go; 2 continue; 9",
        "x111 x121 x11 x1 t3
         x121 x111 x11 x1 t3",
    );
}

#[test]
fn exiting_005() {
    admits(
        "
        START
        wait
        & S1 | exit=raise(x1)
          one
            START
            S11 | exit=raise(x11)
          two
            START
            S21 | exit=raise(x21)
        END
        c/START -> wait
        wait -> S1 : go
        one/START -> S11
        two/START -> S21
        S1 -> c/END : continue / raise(t3)
        ",
        "1 go; 2 continue; 9",
        "x11 x21 x1 t3
         x21 x11 x1 t3",
    );
}

#[test]
fn final_001() {
    admits(
        "
        START
        wait
        & S1
          one
            START
            S11 | exit=raise(x11)
              START
              S111 | exit=raise(x111)
              END
            END
          two
            START
            S21 | exit=raise(x21)
            END
        c/START -> wait
        wait -> S1 : go
        one/START -> S11
        S11/START -> S111
        S111 -> S11/END : continue / raise(t112)
        S11 -> one/END : / raise(t12)
        two/START -> S21
        S21 -> two/END : other / raise(t22)
        ",
        "1 go; 2 continue; 3 other; 9",
        "x111 t112 x11 t12 x21 t22",
    );
}
