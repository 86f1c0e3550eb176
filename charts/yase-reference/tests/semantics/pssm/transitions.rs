//! Behaviours of transitions.

use crate::pssm::admits;

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
