//! The functions of the table: raw pointers in, trait calls out, panics caught.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::abi::{ERROR, Message, OK, PANICKED, Status};
use crate::context::Context;
use crate::controller::{Controller, Outcome};
use crate::describe::numbers;
use crate::values::Values;

/// Runs `body`; what goes wrong ends in `message`, never beyond the border.
///
/// # Safety
///
/// `message` is NULL or a message of the host.
#[inline]
unsafe fn guarded(message: *const Message, body: impl FnOnce() -> Outcome) -> Status {
    #[cfg(target_family = "wasm")]
    crate::panics::tell(message);
    match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => OK,
        Ok(Err(reason)) => {
            // SAFETY: the caller vouches for `message`.
            unsafe { Message::write(message, &reason) };
            ERROR
        }
        Err(payload) => {
            // SAFETY: as above.
            unsafe { Message::write(message, panic_text(&*payload)) };
            PANICKED
        }
    }
}

pub(crate) fn panic_text(payload: &(dyn Any + Send)) -> &str {
    match (payload.downcast_ref::<&str>(), payload.downcast_ref::<String>()) {
        (Some(text), _) => text,
        (_, Some(text)) => text,
        _ => "a panic without a text",
    }
}

/// # Safety
///
/// `at` is NULL or points to `length` numbers that nobody writes during `'a`.
#[inline]
unsafe fn numbers_at<'a>(at: *const f64, length: usize, what: &str) -> Result<&'a [f64], String> {
    match length {
        0 => Ok(&[]),
        _ if at.is_null() => Err(format!("the host gave no memory for {what}")),
        // SAFETY: not NULL, and the caller vouches for the rest.
        _ => Ok(unsafe { std::slice::from_raw_parts(at, length) }),
    }
}

/// # Safety
///
/// `at` is NULL or points to `length` numbers that nobody else uses during `'a`.
#[inline]
unsafe fn numbers_at_mut<'a>(at: *mut f64, length: usize, what: &str) -> Result<&'a mut [f64], String> {
    match length {
        0 => Ok(&mut []),
        _ if at.is_null() => Err(format!("the host gave no memory for {what}")),
        // SAFETY: not NULL, and the caller vouches for the rest.
        _ => Ok(unsafe { std::slice::from_raw_parts_mut(at, length) }),
    }
}

/// # Safety
///
/// The pointers are those of a host that keeps the contract of the table of `T`.
#[inline]
unsafe fn context<'a, T: Controller>(
    params: *const f64,
    t: f64,
    x: *const f64,
    xd: *const f64,
    u: *const f64,
) -> Result<Context<'a>, String> {
    // SAFETY: the caller vouches for the pointers; the lengths are those of the table.
    unsafe {
        Ok(Context {
            t,
            p: Values::of(numbers_at(params, const { numbers(T::PARAMETERS) }, "the parameters")?),
            x: Values::of(numbers_at(x, const { numbers(T::CONTINUOUS) }, "the continuous states")?),
            xd: Values::of(numbers_at(xd, const { numbers(T::DISCRETE) }, "the discrete states")?),
            u: Values::of(numbers_at(u, const { numbers(T::INPUTS) }, "the inputs")?),
        })
    }
}

/// See `CheckFn` of the table.
///
/// # Safety
///
/// As the table says; so for all functions here.
pub unsafe extern "C" fn check<T: Controller>(params: *const f64, message: *const Message) -> Status {
    // SAFETY: the host keeps the contract.
    unsafe {
        guarded(message, || {
            T::check(Values::of(numbers_at(params, const { numbers(T::PARAMETERS) }, "the parameters")?))
        })
    }
}

/// See `SampleTimeFn` of the table.
///
/// # Safety
///
/// As the table says.
pub unsafe extern "C" fn sample_time<T: Controller>(
    params: *const f64,
    period: *mut f64,
    message: *const Message,
) -> Status {
    // SAFETY: the host keeps the contract.
    unsafe {
        guarded(message, || {
            let params = numbers_at(params, const { numbers(T::PARAMETERS) }, "the parameters")?;
            numbers_at_mut(period, 1, "the period")?[0] = T::sample_time(Values::of(params));
            Ok(())
        })
    }
}

/// See `ResetFn` of the table.
///
/// # Safety
///
/// As the table says.
pub unsafe extern "C" fn reset<T: Controller>(
    params: *const f64,
    x: *mut f64,
    xd: *mut f64,
    message: *const Message,
) -> Status {
    // SAFETY: the host keeps the contract.
    unsafe {
        guarded(message, || {
            let params = numbers_at(params, const { numbers(T::PARAMETERS) }, "the parameters")?;
            let x = numbers_at_mut(x, const { numbers(T::CONTINUOUS) }, "the continuous states")?;
            let xd = numbers_at_mut(xd, const { numbers(T::DISCRETE) }, "the discrete states")?;
            T::reset(Values::of(params), Values::of_mut(x), Values::of_mut(xd))
        })
    }
}

/// See `OutputsFn` of the table.
///
/// # Safety
///
/// As the table says.
pub unsafe extern "C" fn outputs<T: Controller>(
    params: *const f64,
    t: f64,
    x: *const f64,
    xd: *const f64,
    u: *const f64,
    y: *mut f64,
    message: *const Message,
) -> Status {
    // SAFETY: the host keeps the contract.
    unsafe {
        guarded(message, || {
            let y = numbers_at_mut(y, const { numbers(T::OUTPUTS) }, "the outputs")?;
            T::outputs(&context::<T>(params, t, x, xd, u)?, Values::of_mut(y))
        })
    }
}

/// See `UpdateFn` of the table.
///
/// # Safety
///
/// As the table says.
pub unsafe extern "C" fn update<T: Controller>(
    params: *const f64,
    t: f64,
    x: *const f64,
    xd: *const f64,
    u: *const f64,
    xd_next: *mut f64,
    message: *const Message,
) -> Status {
    // SAFETY: the host keeps the contract.
    unsafe {
        guarded(message, || {
            let next = numbers_at_mut(xd_next, const { numbers(T::DISCRETE) }, "the next discrete states")?;
            T::update(&context::<T>(params, t, x, xd, u)?, Values::of_mut(next))
        })
    }
}

/// See `DerivativesFn` of the table.
///
/// # Safety
///
/// As the table says.
pub unsafe extern "C" fn derivatives<T: Controller>(
    params: *const f64,
    t: f64,
    x: *const f64,
    xd: *const f64,
    u: *const f64,
    dx: *mut f64,
    message: *const Message,
) -> Status {
    // SAFETY: the host keeps the contract.
    unsafe {
        guarded(message, || {
            let dx = numbers_at_mut(dx, const { numbers(T::CONTINUOUS) }, "the derivatives")?;
            T::derivatives(&context::<T>(params, t, x, xd, u)?, Values::of_mut(dx))
        })
    }
}
