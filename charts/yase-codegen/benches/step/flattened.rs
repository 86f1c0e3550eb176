//! The charts as generated code: see `yase_codegen::flatten`.
//!
//! The code is stored in `flattened/` and compared with the current output each time;
//! `MONAS_BLESS=1 cargo bench -p yase-codegen -- --test` rewrites it.

#![allow(unreachable_pub, reason = "what is written is for everybody")]

#[rustfmt::skip]
mod flat;
#[rustfmt::skip]
mod guarded;
#[rustfmt::skip]
mod hier;
#[rustfmt::skip]
mod nine;
#[rustfmt::skip]
mod ortho;

use std::path::Path;

use yase::{Semantics, Statechart};
use yase_codegen::flatten::flatten;

use crate::counts::{Counts, Event, Toggle};

/// The counters, and the data of conditions.
struct CountingHost {
    counts: Counts,
    board: [i64; 2],
}

/// A machine of a generated module, with the methods for the actions of its states.
macro_rules! machine {
    ($module:ident as $machine:ident { $($enter:ident $leave:ident $state:literal)* } $({ $($condition:ident: $holds:expr;)* })?) => {
        impl $module::Host for CountingHost {
            $(
                fn $enter(&mut self) {
                    self.counts.enter($state);
                }
                fn $leave(&mut self) {
                    self.counts.leave($state);
                }
            )*
            $($(
                fn $condition(&self) -> bool {
                    let holds: fn([i64; 2]) -> bool = $holds;
                    holds(self.board)
                }
            )*)?
        }

        pub(crate) struct $machine {
            state: $module::State,
            host: CountingHost,
        }

        impl $machine {
            pub(crate) fn new(chart: &Statechart) -> $machine {
                assert_is_current(chart, stringify!($module));
                let mut host = CountingHost { counts: Counts::default(), board: [0; 2] };
                let state = $module::State::start(&mut host);
                host.counts = Counts::default();
                $machine { state, host }
            }
        }

        impl Toggle for $machine {
            #[inline(never)]
            fn handle(&mut self, event: Event) {
                match event {
                    Event::Toggle => self.state.handle($module::Event::Toggle, &mut self.host),
                    Event::Other => {}
                }
            }

            fn counts(&self) -> Counts {
                self.host.counts.clone()
            }
        }
    };
}

machine!(flat as Flat { enter_0 leave_0 0 enter_1 leave_1 1 });
machine!(hier as Hier {
    enter_0 leave_0 0 enter_1 leave_1 1 enter_2 leave_2 2 enter_3 leave_3 3
    enter_4 leave_4 4 enter_5 leave_5 5 enter_6 leave_6 6 enter_7 leave_7 7
});
machine!(ortho as Ortho {
    enter_0 leave_0 0 enter_1 leave_1 1 enter_2 leave_2 2
    enter_3 leave_3 3 enter_4 leave_4 4 enter_5 leave_5 5
});
machine!(guarded as Guarded { enter_0 leave_0 0 enter_1 leave_1 1 } { m_n_equals_0: |[n, _]| n == 0; });
machine!(nine as Nine { enter_0 leave_0 0 enter_1 leave_1 1 } {
    m_n_equals_0: |[n, _]| n == 0;
    m_n_above_100: |[n, _]| n > 100;
    m_n_above_101: |[n, _]| n > 101;
    m_n_above_102: |[n, _]| n > 102;
    m_n_above_103: |[n, _]| n > 103;
    m_n_above_104: |[n, _]| n > 104;
    m_n_above_105: |[n, _]| n > 105;
    m_n_above_106: |[n, _]| n > 106;
    m_n_above_107: |[n, _]| n > 107;
    m_n_above_108: |[n, _]| n > 108;
});

/// Asserts that the stored code equals the current output.
fn assert_is_current(chart: &Statechart, module: &str) {
    let written = flatten(chart, Semantics::yase(), 100).expect("the chart is simple").to_rust();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/step/flattened");
    let file = folder.join(module).with_extension("rs");
    if std::env::var_os("MONAS_BLESS").is_some() {
        std::fs::write(&file, &written).expect("it can be written");
    }
    let known = std::fs::read_to_string(&file).expect("it is there");
    assert_eq!(known, written, "{} is not what is written now", file.display());
}
