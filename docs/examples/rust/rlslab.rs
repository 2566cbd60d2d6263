//! rlslab.h from Rust (1.63 and later), without unsafe code at the caller's.
#![allow(dead_code)] // a program uses some of it

use std::ffi::{CStr, CString};
use std::os::raw::{c_char, c_int, c_void};

#[repr(C)]
struct Opaque {
    _private: [u8; 0],
}
#[repr(C)]
#[derive(Default, Clone, Copy, Debug)]
pub struct Step {
    pub innovation: f64,
    pub residual: f64,
    pub gamma: f64,
    pub health: i32,
    pub signal: i32,
}
#[repr(C)]
struct RawOptions {
    bytes: usize,
    size: usize,
    forgetting: f64,
    prior_variance: f64,
    prior_theta: *const f64,
    prior_covariance: *const f64,
    window: usize,
    guard: *const c_char,
    control: *const c_char,
    control_numbers: *const f64,
    control_count: usize,
    largest_variance: f64,
    innovation: f64,
    least_noise: f64,
    asymmetry: f64,
    noise_memory: usize,
    rebuild_rows: usize,
}
#[repr(C)]
#[derive(Default, Clone, Copy, Debug)]
pub struct Counts {
    pub rows: i64,
    pub unusable: i64,
    pub outliers: i64,
    pub changes: i64,
    pub windups: i64,
    pub breakdowns: i64,
    pub refactored: i64,
    pub since: i64,
    pub handed_over: i64,
}

#[link(name = "rlslab")]
extern "C" {
    fn rlslab_message() -> *const c_char;
    fn rlslab_name(list: c_int, place: usize) -> *const c_char;
    fn rlslab_defaults(options: *mut RawOptions, bytes: usize) -> c_int;
    fn rlslab_new(v: *const c_char, a: *const c_char, options: *const RawOptions, out: *mut *mut Opaque) -> c_int;
    fn rlslab_free(filter: *mut Opaque);
    fn rlslab_update(filter: *mut Opaque, psi: *const f64, y: f64, step: *mut Step) -> c_int;
    fn rlslab_theta(filter: *const Opaque, out: *mut f64) -> c_int;
    fn rlslab_gain(filter: *const Opaque, out: *mut f64) -> c_int;
    fn rlslab_covariance(filter: *const Opaque, out: *mut f64) -> c_int;
    fn rlslab_information(filter: *const Opaque, out: *mut f64) -> c_int;
    fn rlslab_count(filter: *const Opaque, out: *mut Counts, bytes: usize) -> c_int;
    fn rlslab_state_size(filter: *const Opaque) -> usize;
    fn rlslab_save(filter: *const Opaque, to: *mut c_void, room: usize) -> c_int;
    fn rlslab_load(filter: *mut Opaque, from: *const c_void, bytes: usize) -> c_int;
}

/// The lists of rlslab_name.
#[derive(Clone, Copy)]
pub enum List {
    Variants = 0,
    Arithmetics = 1,
    Guards = 2,
    Controls = 3,
    Healths = 4,
    Signals = 5,
}
pub fn name(list: List, place: usize) -> Option<&'static str> {
    let text = unsafe { rlslab_name(list as c_int, place) };
    if text.is_null() {
        return None;
    }
    unsafe { CStr::from_ptr(text) }.to_str().ok()
}
pub fn names(list: List) -> Vec<&'static str> {
    (0..).map_while(|place| name(list, place)).collect()
}

fn check(status: c_int) -> Result<(), String> {
    if status == 0 {
        return Ok(());
    }
    Err(unsafe { CStr::from_ptr(rlslab_message()) }.to_string_lossy().into_owned())
}

pub struct Filter {
    filter: *mut Opaque,
    size: usize,
}
unsafe impl Send for Filter {}

impl Filter {
    /// guard: "" for none.
    pub fn new(variant: &str, arithmetic: &str, size: usize, forgetting: f64, guard: &str) -> Result<Filter, String> {
        let text = |s: &str| CString::new(s).map_err(|_| "a zero byte in a name".to_string());
        let (variant, arithmetic, policy) = (text(variant)?, text(arithmetic)?, text(guard)?);
        let mut filter = std::ptr::null_mut();
        unsafe {
            let mut options: RawOptions = std::mem::zeroed();
            check(rlslab_defaults(&mut options, std::mem::size_of::<RawOptions>()))?;
            options.size = size;
            options.forgetting = forgetting;
            if !guard.is_empty() {
                options.guard = policy.as_ptr();
            }
            check(rlslab_new(variant.as_ptr(), arithmetic.as_ptr(), &options, &mut filter))?;
        }
        Ok(Filter { filter, size })
    }
    pub fn update(&mut self, psi: &[f64], y: f64) -> Result<Step, String> {
        if psi.len() != self.size {
            return Err(format!("a row of {} numbers, not {}", psi.len(), self.size));
        }
        let mut step = Step::default();
        check(unsafe { rlslab_update(self.filter, psi.as_ptr(), y, &mut step) })?;
        Ok(step)
    }
    pub fn theta(&self) -> Result<Vec<f64>, String> {
        let mut out = vec![0.0; self.size];
        check(unsafe { rlslab_theta(self.filter, out.as_mut_ptr()) })?;
        Ok(out)
    }
    pub fn gain(&self) -> Result<Vec<f64>, String> {
        let mut out = vec![0.0; self.size];
        check(unsafe { rlslab_gain(self.filter, out.as_mut_ptr()) })?;
        Ok(out)
    }
    /// P by columns, or P^-1 where the variant reports that.
    pub fn matrix(&self) -> Result<Vec<f64>, String> {
        let mut out = vec![0.0; self.size * self.size];
        if unsafe { rlslab_covariance(self.filter, out.as_mut_ptr()) } != 0 {
            check(unsafe { rlslab_information(self.filter, out.as_mut_ptr()) })?;
        }
        Ok(out)
    }
    pub fn counts(&self) -> Result<Counts, String> {
        let mut out = Counts::default();
        check(unsafe { rlslab_count(self.filter, &mut out, std::mem::size_of::<Counts>()) })?;
        Ok(out)
    }
    pub fn save(&self) -> Result<Vec<u8>, String> {
        let mut out = vec![0; unsafe { rlslab_state_size(self.filter) }];
        check(unsafe { rlslab_save(self.filter, out.as_mut_ptr() as *mut c_void, out.len()) })?;
        Ok(out)
    }
    pub fn load(&mut self, state: &[u8]) -> Result<(), String> {
        check(unsafe { rlslab_load(self.filter, state.as_ptr() as *const c_void, state.len()) })
    }
}
impl Drop for Filter {
    fn drop(&mut self) {
        unsafe { rlslab_free(self.filter) }
    }
}
