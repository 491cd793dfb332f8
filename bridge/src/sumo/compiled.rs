//! libsumo's C++ functions, called directly. All times were measured with SUMO 1.28.
//!
//! A vehicle's position, angle and speed take 0.25 to 0.29 µs, against 0.68 to 0.71 µs through the Python getters of the same
//! module. Half of that is SUMO looking up the id for each value. With the functions behind the getters, where they are
//! known, one look-up is enough: 0.15 µs. A person (it may be inside a vehicle) takes 0.5 to 0.7 µs instead of 0.7 to
//! 1.3, because SUMO computes its position on the lane. With the addresses of road users kept between steps, all that a
//! step reads takes 0.09 to 0.14 µs per vehicle instead of 0.21 to 0.33 (SUMO's A10, a grid), and a third less with persons
//! (a grid with 1,500 of them).

#![allow(unsafe_code, reason = "calls compiled.cpp; halves the cost of reading a road user, see above")]

use std::ffi::CString;
use std::os::raw::c_char;
use std::path::Path;
use std::ptr::null_mut;

use super::reading::{Domain, Reading};

/// A function pointer that only compiled.cpp calls; its real type is declared there.
type Function = Option<unsafe extern "C" fn()>;

/// `ClosecallGetters` of compiled.cpp, filled by `closecall_find`.
#[repr(C)]
pub struct Compiled {
    position: Function,
    angle: Function,
    speed: Function,
    inside: Function,
    route: Function,
    direct: [Function; 7],
}

/// How much of a SUMO is what compiled.cpp declares.
#[derive(Clone, Copy, PartialEq)]
enum Verified {
    /// The functions of libsumo's interface.
    Interface,
    /// Those behind them too, which are not part of that interface.
    Behind,
}

/// The versions of SUMO that `make versions` compares with Python's getters. Of any other nothing is called: a function of
/// the same name may return something else.
/// The wheels before 1.26 have the strings of before C++11, so that other functions are meant by their names.
const VERIFIED: [(&str, Verified); 4] = [
    ("SUMO 1.26.0", Verified::Interface),
    ("SUMO 1.27.0", Verified::Interface),
    ("SUMO 1.27.1", Verified::Interface),
    ("SUMO 1.28.0", Verified::Behind),
];

/// `User` of compiled.cpp: the address of a road user in SUMO's memory; 0 if not known yet.
type Address = usize;

/// The address of a road user in SUMO's memory, known once it has been read. The holder drops it when the road user leaves.
#[derive(Default)]
pub struct KeptAddress(Address);

/// `ClosecallReading` of compiled.cpp.
#[repr(C)]
#[derive(Default)]
struct RawReading {
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
        reading: *mut RawReading,
    ) -> bool;
}

impl Compiled {
    /// Whether such functions are to be expected.
    pub const IS_BUILT: bool = true;

    /// The functions of the libsumo that Python has loaded from this file; none if it has not, if its version is not
    /// verified, or if one is missing.
    pub fn of(file: &Path, version: &str, domain: Domain) -> Option<Self> {
        let (_, verified) = VERIFIED.iter().find(|(known, _)| *known == version)?;
        let path = CString::new(file.as_os_str().as_encoded_bytes()).ok()?;
        let (name, may_be_inside) = match domain {
            Domain::Vehicle => (c"7Vehicle", false),
            Domain::Person => (c"6Person", true),
        };
        let direct = [None; 7];
        let mut found = Self { position: None, angle: None, speed: None, inside: None, route: None, direct };
        let (file, name, is_known) = (path.as_ptr(), name.as_ptr(), *verified == Verified::Behind);
        // SAFETY: both strings end with a zero and live until the call returns. `found` has the layout of what is written to
        // it, in which a null pointer is `None`.
        let is_complete = unsafe { closecall_find(file, name, may_be_inside, is_known, &raw mut found) };
        is_complete.then_some(found)
    }

    /// Whether the functions behind libsumo's interface are called.
    pub fn is_direct(&self) -> bool {
        self.direct.iter().any(Option::is_some)
    }

    /// The state of a road user; none if libsumo does not know this id.
    pub fn read(&self, id: &str, kept: Option<&mut KeptAddress>) -> Option<Reading> {
        let mut read = RawReading::default();
        let kept = kept.map_or(null_mut(), |KeptAddress(address)| &raw mut *address);
        // SAFETY: `self` is complete, since `of` returns nothing else, and its functions keep their addresses: the module is
        // never unloaded. The pointers of `direct` are set only for a SUMO that matches compiled.cpp's declarations. A road
        // user is read right after it is looked up, and stays until SUMO's next step. `id` has the given length and `read` has
        // the layout of what is written to it; neither is kept. No exception leaves the function: it is `noexcept` and catches
        // all. libsumo itself is not threaded, and every caller holds Python's lock, as for the Python getters. `kept` is null
        // or what this function has written there for the same road user. If only closecall makes steps
        // (`Source::set_exclusive`), SUMO deletes a road user only in a step, and then reports that it has arrived
        // (MSVehicleControl::removePending, MSTransportableControl::erase), so that `LibsumoDomain::update` drops the address
        // before any road user is read.
        let is_known = unsafe { closecall_read(&raw const *self, id.as_ptr().cast(), id.len(), kept, &raw mut read) };
        let RawReading { x, y, z, angle, speed, is_inside } = read;
        is_known.then_some(if is_inside { Reading::Inside } else { Reading::At { x, y, z, angle, speed } })
    }

    /// Whether a vehicle has the route with this id. Takes 0.1 µs; Python's getter takes twice that and makes a string.
    pub fn has_route(&self, id: &str, route: &str) -> bool {
        // SAFETY: as in `read`; both strings have the given lengths, and neither is kept.
        unsafe {
            closecall_has_route(&raw const *self, id.as_ptr().cast(), id.len(), route.as_ptr().cast(), route.len())
        }
    }
}
