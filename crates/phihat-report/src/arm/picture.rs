//! The arm on paper: a still picture, and one that moves.
