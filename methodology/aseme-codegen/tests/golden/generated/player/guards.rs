//! The guards of transitions and the values of assignments.
