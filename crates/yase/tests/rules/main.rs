#[path = "../kit/mod.rs"]
mod kit;

use kit::{chart, play};

#[test]
fn smoke() {
    let chart = chart(
        "
        START
        A | run | for=20ms
        & both
          one
            START
            B
            END
          two
            START
            D
            END
        END
        c/START -> A
        A -> both : e
        one/START -> B
        B -> one/END : f
        two/START -> D
        D -> two/END : f / raise(g)
        both -> c/END
        ",
    );
    println!("{}", play(&chart, "10 e; 30 f; 100").join("\n"));
    panic!();
}
