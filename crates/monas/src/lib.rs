//! Activities, agents, statechart agents, and Talws, which runs them
