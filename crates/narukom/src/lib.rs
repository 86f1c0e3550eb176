//! Messages, topics and blackboards: publish and subscribe without threads, sockets or clocks
