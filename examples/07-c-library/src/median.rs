//! A safe wrapper of the library: the only module with `unsafe` code.

#![allow(unsafe_code, reason = "calls of C are")]

/// Equals `MEDIAN_WINDOW` in `c/median.h`.
const WINDOW: usize = 5;

/// Layout of `struct median` in `c/median.h`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Median {
    values: [f64; WINDOW],
    count: std::ffi::c_uint,
}

unsafe extern "C" {
    fn median_next(filter: *mut Median, value: f64) -> f64;
}

impl Median {
    /// Adds a value and returns the median of the last five.
    pub(crate) fn next(&mut self, value: f64) -> f64 {
        // SAFETY: `self` is a valid, exclusively borrowed `struct median` with the layout of C, and
        // C does not keep the pointer after the call.
        unsafe { median_next(self, value) }
    }
}
