//! The frame order.
