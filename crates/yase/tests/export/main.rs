//! Charts for other tools, and drawn: a chart as text in `charts`, what becomes of it beside it. `MONAS_BLESS=1` writes these files anew.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)] // the functions around the tests are tests too

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
