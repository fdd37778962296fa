//! depc
