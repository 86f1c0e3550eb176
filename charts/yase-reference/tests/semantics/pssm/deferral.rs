//! Deferred events.

use crate::pssm::admits;

#[test]
fn deferred_002() {
    admits(
        "
        START
        wait
        S1 | exit=raise(x1) | defer=continue
        S2 | entry=raise(n2)
        S3 | entry=raise(n3)
        END
        c/START -> wait
        wait -> S1 : go
        S1 -> S2 : other / raise(t3)
        S1 -> S2 : continue / raise(t4)
        S2 -> S3 : continue / raise(t5)
        S2 -> S3 : other / raise(t6)
        S3 -> c/END : / raise(t7)
        ",
        "1 go; 2 continue; 3 other; 9",
        "x1 t4 n2 t6 n3 t7",
    );
}

#[test]
fn deferred_003() {
    admits(
        "
        START
        wait
        S1
          START
          S11 | exit=raise(x11) | defer=continue,other
            START
            S111 | exit=raise(x111)
            END
          S12 | exit=raise(x12)
          END
        END
        c/START -> wait
        wait -> S1 : go
        S1/START -> S11
        S11/START -> S111
        S111 -> S11/END : continue / raise(t112)
        S11 -> S12 : pending / raise(t12)
        S12 -> S1/END : continue / raise(t13)
        S1 -> c/END : other / raise(t3)
        ",
        "1 go; 2 continue; 3 continue; 4 other; 5 pending; 9",
        "x111 t112 x11 t12 x12 t13 t3",
    );
}

#[test]
fn deferred_004_a() {
    admits(
        "
        START
        wait
        & S1 | exit=raise(x1)
          one
            START
            S11 | exit=raise(x11) | defer=continue
            END
          two
            START
            S21 | exit=raise(x21)
            END
        last
        END
        c/START -> wait
        wait -> S1 : go
        one/START -> S11
        S11 -> one/END : pending / raise(t12)
        two/START -> S21
        S21 -> two/END : continue / raise(t22)
        S1 -> last : continue / raise(t3)
        S1 -> last : other / raise(t4)
        last -> c/END : / raise(t5)
        ",
        "1 go; 2 continue; 3 pending; 4 other; 9",
        "x11 t12 x21 t22 x1 t4 t5",
    );
}

#[test]
fn deferred_004_b() {
    admits(
        "
        START
        wait
        & S1 | exit=raise(x1)
          one
            START
            S11 | exit=raise(x11)
              START
              S111 | exit=raise(x111) | defer=other
              END
            END
          two
            START
            S21 | exit=raise(x21)
            END
        END
        c/START -> wait
        wait -> S1 : go
        one/START -> S11
        S11/START -> S111
        S111 -> S11/END : continue / raise(t112)
        S11 -> one/END
        two/START -> S21
        S21 -> two/END : other / raise(t22)
        S21 -> two/END : pending / raise(t23)
        S1 -> c/END : / raise(t3)
        ",
        "1 go; 2 other; 3 continue; 4 pending; 9",
        "x111 t112 x11 x21 t22 x1 t3",
    );
}

#[test]
fn deferred_001() {
    admits(
        "
        START
        wait
        S1 | exit=raise(x1) | defer=continue
        S2 | entry=raise(n2)
        S3 | entry=raise(n3)
        END
        c/START -> wait
        wait -> S1 : go
        S1 -> S2 : other
        S2 -> S3 : continue / raise(t4)
        S2 -> S3 : pending / raise(t5)
        S3 -> END : / raise(t6)
        ",
        "1 go; 2 continue; 3 other; 3 pending; 9",
        "x1 n2 t4 n3 t6",
    );
}

#[test]
fn deferred_005() {
    admits(
        "
        START
        wait
        S1 | exit=raise(x1) | defer=first,second
        S2 | entry=raise(n2)
        c/START -> wait
        wait -> S1 : go
        S1 -> S2 : continue / raise(t3)
        S2 -> S2 : first / raise(t4)
        S2 -> S2 : second / raise(t5)
        ",
        "1 go; 2 first; 3 second; 4 continue; 9",
        "x1 t3 n2 t4 n2 t5 n2",
    );
}
