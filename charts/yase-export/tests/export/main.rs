//! Charts exported and drawn: the folder `charts` contains a chart as text, with the expected
//! outputs beside it. `MONAS_BLESS=1` rewrites these files.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)] // the functions around the tests are tests too

mod compact;
mod drawing;
mod golden;
mod placed;
mod random;
mod text;

use yase::NodeKind;

/// Every kind of node.
const KINDS: [NodeKind; 15] = [
    NodeKind::Or,
    NodeKind::And,
    NodeKind::Basic,
    NodeKind::End,
    NodeKind::Start,
    NodeKind::Condition,
    NodeKind::Junction,
    NodeKind::Choice,
    NodeKind::Fork,
    NodeKind::Join,
    NodeKind::ShallowHistory,
    NodeKind::DeepHistory,
    NodeKind::Terminate,
    NodeKind::EntryPoint,
    NodeKind::ExitPoint,
];
