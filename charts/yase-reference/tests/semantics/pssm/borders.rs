//! Entry points, exit points, forks, joins and TERMINATE.

use crate::pssm::admits;

#[test]
fn entering_009() {
    admits(
        "
        START
        wait
        S1 | entry=raise(n1)
          i in
          S11 | entry=raise(n11)
          END
        c/START -> wait
        wait -> in : go / raise(t2)
        in -> S11 : / raise(t11)
        S11 -> S1/END : / raise(t12)
        ",
        "1 go; 9",
        "t2 n1 t11 n11 t12",
    );
}

#[test]
fn entry_002_a() {
    admits(
        "
        START
        wait
        & S1
          i in
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
        wait -> in : go
        one/START -> S11
        S11 -> one/END
        two/START -> S21
        S21 -> two/END
        S1 -> c/END : / raise(t3)
        ",
        "1 go; 9",
        "n11 n21 t3
         n21 n11 t3",
    );
}

#[test]
fn entry_002_b() {
    admits(
        "
        START
        wait
        & S1
          i in
          one
            START
            S21 | entry=raise(n21)
            END
          two
            START
            S11 | entry=raise(n11)
            S12 | entry=raise(n12)
            END
        END
        c/START -> wait
        wait -> in : go
        in -> S12
        one/START -> S21
        S21 -> one/END
        two/START -> S11
        S11 -> S12
        S12 -> two/END
        S1 -> c/END : / raise(t3)
        ",
        "1 go; 9",
        "n21 n12 t3
         n12 n21 t3",
    );
}

#[test]
fn entry_002_c() {
    admits(
        "
        START
        wait
        S1 | entry=raise(n1)
          i in
          START
          S11
          END
        END
        c/START -> wait
        wait -> in : go / raise(t2)
        in -> S11 : / raise(t11)
        S1/START -> S11
        S11 -> S1/END
        S1 -> c/END : / raise(t3)
        ",
        "1 go; 9",
        "t2 n1 t11 t3",
    );
}

#[test]
fn entry_002_d() {
    admits(
        "
        START
        wait
        S1 | entry=raise(n1)
          i in
          START
          S11
          END
        END
        c/START -> wait
        wait -> in : go / raise(t2)
        S1/START -> S11 : / raise(t11)
        S11 -> S1/END : / raise(t12)
        S1 -> c/END : / raise(t3)
        ",
        "1 go; 9",
        "t2 n1 t11 t12 t3",
    );
}

#[test]
fn exit_001() {
    admits(
        "
        START
        wait
        S1 | exit=raise(x1)
          START
          o out
          S11 | exit=raise(x11)
            START
            S111 | exit=raise(x111)
        S2
        END
        c/START -> wait
        wait -> S1 : go
        S1/START -> S11
        S11/START -> S111
        S111 -> out : / raise(t12)
        out -> S2 : / raise(t3)
        S2 -> c/END : / raise(t4)
        ",
        "1 go; 9",
        "x111 x11 t12 x1 t3 t4",
    );
}

#[test]
fn exit_002() {
    admits(
        "
        START
        wait
        & S1 | exit=raise(x1)
          o out
          one
            START
            S11
          two
            START
            S21
        END
        c/START -> wait
        wait -> S1 : go
        one/START -> S11
        two/START -> S21
        S11 -> out : / raise(t12)
        S21 -> out : / raise(t22)
        out -> c/END : / raise(t3)
        ",
        "1 go; 9",
        "t12 t22 x1 t3
         t22 t12 x1 t3",
    );
}

#[test]
fn exiting_004() {
    admits(
        "
        START
        wait
        S1 | exit=raise(x1)
          START
          o out
          S11 | exit=raise(x11)
        END
        c/START -> wait
        wait -> S1 : go
        S1/START -> S11
        S11 -> out : / raise(t12)
        out -> c/END : / raise(t3)
        ",
        "1 go; 9",
        "x11 t12 x1 t3",
    );
}

#[test]
fn transition_execution_algorithm() {
    admits(
        "
        START
        wait
        S1 | exit=raise(x1)
          START
          o out
          S11 | exit=raise(x11)
        S2 | entry=raise(n2)
          S21 | entry=raise(n21)
            i in
            S211 | entry=raise(n211)
        c/START -> wait
        wait -> S1 : go
        S1/START -> S11
        S11 -> out : continue / raise(t12)
        out -> in : / raise(t2)
        in -> S211 : / raise(t21)
        ",
        "1 go; 2 continue; 9",
        "x11 t12 x1 t2 n2 n21 t21 n211",
    );
}

#[test]
fn fork_001() {
    admits(
        "
        START
        wait
        < f
        & S1 | entry=raise(n1)
          o out
          one
            START
            S12 | entry=raise(n12)
          two
            START
            S11 | entry=raise(n11)
          three
            START
            S13 | entry=raise(n13)
        END
        c/START -> wait
        wait -> f : go
        f -> S11 : / raise(t3)
        f -> S12 : / raise(t4)
        one/START -> S12 : / raise(t21)
        two/START -> S11 : / raise(t11)
        three/START -> S13 : / raise(t31)
        S11 -> out
        S12 -> out
        S13 -> out
        out -> c/END : / raise(t5)
        ",
        "1 go; 9",
        "t3 n1 n11 t4 n12 t31 n13 t5
         t3 n1 t31 n13 n11 t4 n12 t5",
    );
}

#[test]
fn fork_002() {
    admits(
        "
        START
        wait
        S1 | entry=raise(n1)
          < f
          & S11 | entry=raise(n11)
            one
              S111
              END
            two
              S121
              END
          END
        END
        c/START -> wait
        wait -> f : go / raise(t2)
        f -> S111 : / raise(t21)
        f -> S121 : / raise(t22)
        S111 -> one/END
        S121 -> two/END
        S11 -> S1/END
        S1 -> c/END : / raise(t3)
        ",
        "1 go; 9",
        "t2 n1 t21 n11 t22 t3
         t2 n1 t22 n11 t21 t3",
    );
}

#[test]
fn join_001() {
    admits(
        "
        START
        wait
        < f
        & S1 | exit=raise(x1)
          one
            S21 | exit=raise(x21)
          two
            S11 | exit=raise(x11)
        > j
        END
        c/START -> wait
        wait -> f : go
        f -> S11
        f -> S21
        S21 -> j : / raise(t24)
        S11 -> j : / raise(t23)
        j -> c/END : / raise(t3)
        ",
        "1 go; 9",
        "x11 t23 x21 x1 t24 t3
         x21 t24 x11 x1 t23 t3",
    );
}

#[test]
fn join_002() {
    admits(
        "
        START
        wait
        S1 | exit=raise(x1)
          & S11
            one
              START
              S121
            two
              START
              S111
          > j
        S2 | entry=raise(n2)
        END
        c/START -> wait
        wait -> S11 : go
        one/START -> S121
        two/START -> S111
        S121 -> j : / raise(t22)
        S111 -> j : / raise(t12)
        j -> S2 : / raise(t3)
        S2 -> c/END : / raise(t4)
        ",
        "1 go; 9",
        "t22 t12 x1 t3 n2 t4
         t12 t22 x1 t3 n2 t4",
    );
}

#[test]
fn terminate_001() {
    admits(
        "
        START
        wait
        & S1 | entry=raise(n1) | exit=raise(x1)
          one
            START
            S11 | entry=raise(n11) | exit=raise(x11)
            END
          two
            START
            S21 | entry=raise(n21) | exit=raise(x21)
            x stop
        c/START -> wait
        wait -> S1 : go
        one/START -> S11
        two/START -> S21
        S11 -> one/END : continue
        S21 -> stop : / raise(t22)
        ",
        "1 go; 9",
        "n1 n11 n21 x21 t22
         n1 n21 n11 x21 t22",
    );
}

#[test]
fn terminate_003() {
    admits(
        "
        START
        wait | exit=raise(x0)
        S1 | entry=raise(n1)
          START
          S11 | entry=raise(n11)
          x stop
        c/START -> wait
        S1/START -> S11
        wait -> stop : go / raise(t2)
        ",
        "1 go; 9",
        "x0 t2 n1",
    );
}

#[test]
fn transition_011_b() {
    admits(
        "
        START
        wait
        S1 | entry=raise(n1) | exit=raise(x1)
          i in
          START
          S11 | entry=raise(n11)
          END
        END
        c/START -> wait
        wait -> in : go
        in -> S1 {internal} : / raise(t13)
        S1/START -> S11
        S11 -> S1/END : continue
        S1 -> c/END : / raise(t3)
        ",
        "1 go; 2 continue; 9",
        "n1 n11 t13 x1 t3",
    );
}

#[test]
fn transition_011_d() {
    admits(
        "
        START
        wait
        & S1 | exit=raise(x1)
          o out
          one
            START
            S11 | entry=raise(n11) | exit=raise(x11)
            END
          two
            START
            S21 | entry=raise(n21) | exit=raise(x21)
            END
        END
        c/START -> wait
        wait -> S1 : go
        one/START -> S11
        S11 -> one/END : pending
        two/START -> S21
        S21 -> two/END : pending
        S1 -> out {internal} : continue / raise(t3)
        out -> c/END : / raise(t4)
        ",
        "1 go; 2 continue; 9",
        "n11 n21 t3 x11 x21 x1 t4
         n11 n21 t3 x21 x11 x1 t4
         n21 n11 t3 x11 x21 x1 t4
         n21 n11 t3 x21 x11 x1 t4",
    );
}

#[test]
fn transition_011_e() {
    admits(
        "
        START
        wait
        S1 | entry=raise(n1) | exit=raise(x1)
          i in
          o out
          START
          S11 | entry=raise(n11) | exit=raise(x11)
          END
        END
        c/START -> wait
        wait -> in : go
        in -> out : / raise(t13)
        out -> c/END : / raise(t3)
        S1/START -> S11
        S11 -> S1/END : / raise(t12)
        ",
        "1 go; 9",
        "n1 n11 t13 x11 x1 t3",
    );
}

#[test]
fn transition_019() {
    admits(
        "
        START
        wait
        & S1
          one
            START
            S11 | exit=raise(x11)
            S12
          two
            START
            S21 | exit=raise(x21)
            S22
        > j
        END
        c/START -> wait
        wait -> S1 : go
        one/START -> S11
        S11 -> S12 : continue / raise(t12)
        S12 -> j : / raise(t13)
        two/START -> S21
        S21 -> S22 : continue / raise(t22)
        S22 -> j : / raise(t23)
        j -> c/END : / raise(t3)
        ",
        "1 go; 2 continue; 9",
        "x11 t12 x21 t22 t13 t23 t3
         x21 t22 x11 t12 t23 t13 t3
         x11 x21 t12 t22 t13 t23 t3
         x21 x11 t22 t12 t23 t13 t3
         x11 x21 t22 t12 t23 t13 t3
         x21 x11 t12 t22 t13 t23 t3",
    );
}

#[test]
fn terminate_002() {
    admits(
        "
        START
        wait
        & S1 | run=S1 | entry=raise(n1) | exit=raise(x1)
          one
            START
            S11 | run=S11 | entry=raise(n11) | exit=raise(x11)
            END
          two
            START
            S21 | entry=raise(n21)
            x stop
          three
            START
            S31 | entry=raise(n31)
            END
        c/START -> wait
        wait -> S1 : go
        one/START -> S11
        S11 -> one/END
        two/START -> S21
        S21 -> stop : / raise(t22)
        three/START -> S31
        S31 -> three/END : / raise(t32)
        ",
        "1 go; 9",
        "n1 n11 n21 n31 t22
         n1 d1 n11 n21 n31 t22
         n1 d1 n11 d11 n21 n31 t22
         n1 n11 n31 n21 t22",
    );
}
