//! A chart with the functions of its guards and assignments.

use std::sync::Arc;

use yase::native::NativeProgram;
use yase::{CompiledChart, Diagnostic, Semantics, Statechart, TypeEnvironment};

/// A statechart whose guards and assigned values are functions, built by
/// [`TypedChartBuilder`](super::TypedChartBuilder).
#[derive(Clone, Debug)]
pub struct TypedChart {
    statechart: Statechart,
    program: Arc<NativeProgram>,
}

impl TypedChart {
    pub(crate) fn new(statechart: Statechart, program: NativeProgram) -> TypedChart {
        TypedChart { statechart, program: Arc::new(program) }
    }

    /// The chart as data, as if read from its model.
    pub fn statechart(&self) -> &Statechart {
        &self.statechart
    }

    /// Checks and compiles the chart against a type environment. The result reads the same
    /// messages, is triggered by the same events and has the same trace as the
    /// [statechart](TypedChart::statechart) compiled alone.
    ///
    /// # Errors
    /// All errors of its structure and texts, and functions made for another type environment.
    pub fn compile(
        &self,
        vocabulary: &TypeEnvironment,
        semantics: Semantics,
    ) -> Result<CompiledChart, Vec<Diagnostic>> {
        self.statechart.compile_with_functions(vocabulary, semantics, &self.program)
    }
}
