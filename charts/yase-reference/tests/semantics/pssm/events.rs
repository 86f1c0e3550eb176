//! Events that are dispatched, lost and completed.

use crate::pssm::admits;

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
