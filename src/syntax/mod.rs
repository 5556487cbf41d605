//! RON as a tree with spans: what graphs and scenes are read from.
