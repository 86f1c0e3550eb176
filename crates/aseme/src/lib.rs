//! AMOLA models, liveness formulas, and the arrows from a formula to a statechart
