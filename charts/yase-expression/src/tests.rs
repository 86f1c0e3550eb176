//! Tests of transition expressions, through the public interface.

mod compile;
mod corpus;
mod evaluate;
mod parse;
mod print;
mod refusals;
mod test_context;
