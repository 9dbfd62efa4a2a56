//! Claims about the continuous law of one joint: optimality, input-to-state stability, performance.
