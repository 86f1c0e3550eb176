//! The library as Rust sees it: the only place with `unsafe` in it, and nothing outside can use it wrongly.

#![allow(unsafe_code, reason = "calls of C are")]

/// As `MEDIAN_WINDOW` in `c/median.h`.
const WINDOW: usize = 5;

/// As `struct median` in `c/median.h`.
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
    /// Takes a value, and answers the median of the last five.
    pub(crate) fn next(&mut self, value: f64) -> f64 {
        // SAFETY: the pointer is to a filter as C has it, which nobody else uses during the call, and C keeps no copy of it.
        unsafe { median_next(self, value) }
    }
}
