//! Behaviours of states, entering, exiting and final states.

use crate::pssm::admits;

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
