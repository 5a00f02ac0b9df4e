//! Acceleration structures over anything with bounds.
