//! Pointers of C, turned into references or refused; no panic leaves the library.

use core::mem::MaybeUninit;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::error::{RefusedCall, Status, phihat_error};

/// A structure that begins with its own size, or what is wrong with the pointer to it.
///
/// # Safety
///
/// `at` is null, or points to a `repr(C)` structure whose first member is `size: usize`, initialised as
/// far as that size says and not written to while the reference lives.
pub(crate) unsafe fn structure<'a, T>(at: *const T) -> Result<&'a T, RefusedCall> {
    if at.is_null() {
        return Err(RefusedCall::new(Status::NullPointer, "a structure's pointer is null"));
    }
    // SAFETY: not null, so it points to a structure that begins with its size.
    let size = unsafe { at.cast::<usize>().read() };
    if size != size_of::<T>() {
        return Err(wrong_size());
    }
    // SAFETY: it is as large as it should be.
    Ok(unsafe { &*at })
}

/// A copy of the `index`-th of an array of structures, each with its size: that of this header, or one of
/// `older`, those of headers in which the structure ended earlier. What is missing is zero then.
///
/// # Safety
///
/// As for [`structure`], for each of the array's elements; `index` is inside of the array. Zero is a value of every
/// member.
pub(crate) unsafe fn element<T: Copy>(
    first: *const T,
    index: usize,
    older: &[usize],
) -> Result<T, RefusedCall> {
    if first.is_null() {
        return Err(RefusedCall::new(Status::NullPointer, "an array's pointer is null"));
    }
    // SAFETY: one size, that of the first, is how far apart they all are; as much as that is read of each.
    unsafe {
        let size = first.cast::<usize>().read();
        if size != size_of::<T>() && !older.contains(&size) {
            return Err(wrong_size().at(index));
        }
        let at = first.byte_add(index * size);
        if at.cast::<usize>().read() != size {
            return Err(wrong_size().at(index));
        }
        let mut whole = MaybeUninit::<T>::zeroed();
        at.cast::<u8>().copy_to_nonoverlapping(whole.as_mut_ptr().cast(), size);
        Ok(whole.assume_init())
    }
}

fn wrong_size() -> RefusedCall {
    let why = "a structure's size is that of no header that this library reads";
    RefusedCall::new(Status::WrongSize, why)
}

/// Writes a structure whose size the caller has set.
///
/// # Safety
///
/// As for [`structure`], and it can be written to.
pub(crate) unsafe fn write_structure<T>(at: *mut T, value: T) -> Status {
    // SAFETY: the caller's.
    match unsafe { structure(at.cast_const()) } {
        Ok(_) => {
            // SAFETY: checked just now.
            unsafe { at.write(value) };
            Status::Ok
        }
        Err(refusal) => refusal.status,
    }
}

/// Refuses arrays that are missing.
pub(crate) fn present<const N: usize>(arrays: [*const f64; N]) -> Result<(), RefusedCall> {
    if arrays.iter().any(|at| at.is_null()) {
        return Err(RefusedCall::new(Status::NullPointer, "an array's pointer is null"));
    }
    Ok(())
}

/// Runs a call; refusals and panics become a status and, where there is room for it, a phihat_error.
///
/// # Safety
///
/// `error` is null or points to a phihat_error of which at least `size` is initialised.
pub(crate) unsafe fn answer(
    error: *mut phihat_error,
    call: impl FnOnce() -> Result<Status, RefusedCall>,
) -> Status {
    let refusal = match catch_unwind(AssertUnwindSafe(call)) {
        Ok(Ok(status)) => return status,
        Ok(Err(refusal)) => refusal,
        Err(_) => RefusedCall::new(Status::Internal, "a mistake of the library: please report it"),
    };
    if !error.is_null() {
        // SAFETY: not null, so its size can be read, and all of it be written if that is right.
        unsafe {
            if error.cast::<usize>().read() == size_of::<phihat_error>() {
                error.write(refusal.told());
            }
        }
    }
    refusal.status
}
