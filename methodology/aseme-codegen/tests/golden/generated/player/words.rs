//! What guards and actions speak of: each a constant with the model's own name.
