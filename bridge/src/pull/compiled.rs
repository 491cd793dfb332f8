//! libsumo's C++ functions, called directly: measured on SUMO 1.28, 0.25 to 0.29 µs for a vehicle's position, angle and
//! speed, against 0.68 to 0.71 through the same module's Python getters. Half of that is SUMO looking up the id anew for
//! each: where its own functions behind them are known, 0.15 µs with one look-up. Of a person, who may also be inside a
//! vehicle, 0.5 to 0.7 µs instead of 0.7 to 1.3: SUMO works out where it is on its lane. Where road users are then found
//! where they were, all that a step reads takes 0.09 to 0.14 µs a vehicle instead of 0.21 to 0.33 (SUMO's A10, a grid),
//! and among persons a third less (a grid with 1,500 of them).

#![allow(unsafe_code, reason = "calls compiled.cpp; halves what reading a road user costs, see above")]

use std::ffi::CString;
use std::os::raw::c_char;
use std::path::Path;
use std::ptr::null_mut;

use super::reading::{Domain, Reading};

/// A function pointer that only compiled.cpp calls; its real type stands there.
type Function = Option<unsafe extern "C" fn()>;

/// `ClosecallGetters` of compiled.cpp, filled by `closecall_find`, which found all that it needs.
#[repr(C)]
pub struct Compiled {
    position: Function,
    angle: Function,
    speed: Function,
    inside: Function,
    route: Function,
    direct: [Function; 7],
}

/// How the versions begin of the SUMO whose functions behind libsumo's getters are those that compiled.cpp declares: they
/// are not part of libsumo's interface.
const KNOWN: &str = "SUMO 1.28.";

/// `User` of compiled.cpp: where SUMO has a road user in memory; 0 is nowhere yet.
type Address = usize;

/// Where SUMO has a road user in memory, once that was asked for. Who holds it drops it when the road user has gone.
#[derive(Default)]
pub struct Kept(Address);

/// `ClosecallReading` of compiled.cpp.
#[repr(C)]
#[derive(Default)]
struct Read {
    x: f64,
    y: f64,
    z: f64,
    angle: f64,
    speed: f64,
    is_inside: bool,
}

unsafe extern "C" {
    fn closecall_find(
        file: *const c_char,
        domain: *const c_char,
        may_be_inside: bool,
        is_known: bool,
        getters: *mut Compiled,
    ) -> bool;
    fn closecall_has_route(
        getters: *const Compiled,
        id: *const c_char,
        length: usize,
        route: *const c_char,
        route_length: usize,
    ) -> bool;
    fn closecall_read(
        getters: *const Compiled,
        id: *const c_char,
        length: usize,
        kept: *mut Address,
        reading: *mut Read,
    ) -> bool;
}

impl Compiled {
    /// Those of the module of this SUMO that Python has loaded from this file; none where it has not, or a function is
    /// missing.
    pub fn of(file: &Path, version: &str, domain: Domain) -> Option<Self> {
        let path = CString::new(file.as_os_str().as_encoded_bytes()).ok()?;
        let (name, may_be_inside) = match domain {
            Domain::Vehicle => (c"7Vehicle", false),
            Domain::Person => (c"6Person", true),
        };
        let direct = [None; 7];
        let mut found = Self { position: None, angle: None, speed: None, inside: None, route: None, direct };
        let (file, name, is_known) = (path.as_ptr(), name.as_ptr(), version.starts_with(KNOWN));
        // SAFETY: both strings end with a zero and live until the call returns, and `found` has the layout of what is
        // written to it, in which a null pointer is `None`.
        let is_complete = unsafe { closecall_find(file, name, may_be_inside, is_known, &raw mut found) };
        is_complete.then_some(found)
    }

    /// What libsumo says of a road user; none where it knows none of this id.
    pub fn read(&self, id: &str, kept: Option<&mut Kept>) -> Option<Reading> {
        let mut read = Read::default();
        let kept = kept.map_or(null_mut(), |Kept(address)| &raw mut *address);
        // SAFETY: `self` is complete, since `of` gives no other, and its functions stay where they are: the module is
        // never unloaded. Those of `direct` are there only in a SUMO in which they are what compiled.cpp declares, and who
        // was looked up is asked right after that: before SUMO's next step it does not go. `id` is as long as said
        // and `read` has the layout of what is written to it; neither is kept. No exception comes out: the function is
        // `noexcept` and catches all. libsumo itself knows no threads; Python's lock is held by every caller, as for its
        // Python getters. `kept` is null or has what this function has written there for the same road user: where
        // nobody but closecall makes steps (`Source::set_exclusive`), SUMO deletes it in a step alone, and says then that it has
        // arrived (MSVehicleControl::removePending, MSTransportableControl::erase), so that `Domain::update` drops it
        // before anybody is read.
        let is_known = unsafe { closecall_read(&raw const *self, id.as_ptr().cast(), id.len(), kept, &raw mut read) };
        let Read { x, y, z, angle, speed, is_inside } = read;
        is_known.then_some(if is_inside { Reading::Inside } else { Reading::At { x, y, z, angle, speed } })
    }

    /// Whether a vehicle has the route of this id: 0.1 µs, Python's getter takes twice that and a string.
    pub fn has_route(&self, id: &str, route: &str) -> bool {
        // SAFETY: as in `read`; both strings are as long as said, and neither is kept.
        unsafe {
            closecall_has_route(&raw const *self, id.as_ptr().cast(), id.len(), route.as_ptr().cast(), route.len())
        }
    }
}
