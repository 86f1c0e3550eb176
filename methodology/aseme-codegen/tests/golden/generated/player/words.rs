//! The names that guards and actions use: each a constant named as in the model.
