//! Spine curves and the frames that move along them.
