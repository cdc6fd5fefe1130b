//! What a call must leave as it was, and what it finds: how numbers are rounded, and the locale of the process.

use std::ffi::CStr;

/// Rounding, denormals and traps of this thread.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Environment {
    control: u64,
}

impl Environment {
    /// As it is now.
    #[inline]
    pub fn now() -> Environment {
        Environment { control: control() }
    }

    /// Makes it so again, with the locale of the start of the process; says what was changed, if anything was.
    #[inline]
    pub fn restore(self) -> Option<&'static str> {
        let now = control();
        if now != self.control {
            set_control(self.control);
            return Some("it changed how numbers are rounded (rounding mode, denormals or traps)");
        }
        if restore_locale() {
            return Some("it changed the locale of the process");
        }
        None
    }
}

/// The control words: of SSE without its flags, and of the x87 above it.
#[cfg(target_arch = "x86_64")]
#[inline]
fn control() -> u64 {
    let (mut sse, mut x87) = (0_u32, 0_u16);
    // SAFETY: both store a register at a place of its size.
    unsafe {
        std::arch::asm!("stmxcsr [{}]", "fnstcw [{}]", in(reg) &raw mut sse, in(reg) &raw mut x87, options(nostack));
    }
    const FLAGS: u32 = 0x3f;
    u64::from(sse & !FLAGS) | u64::from(x87) << 32
}

#[cfg(target_arch = "x86_64")]
fn set_control(control: u64) {
    let (sse, x87) = (control as u32, (control >> 32) as u16);
    // SAFETY: values that `control` has read.
    unsafe {
        std::arch::asm!("ldmxcsr [{}]", "fldcw [{}]", in(reg) &raw const sse, in(reg) &raw const x87, options(nostack))
    };
}

#[cfg(target_arch = "aarch64")]
#[inline]
fn control() -> u64 {
    let control: u64;
    // SAFETY: reads a register.
    unsafe { std::arch::asm!("mrs {}, fpcr", out(reg) control, options(nomem, nostack)) };
    control
}

#[cfg(target_arch = "aarch64")]
fn set_control(control: u64) {
    // SAFETY: a value that `control` has read.
    unsafe { std::arch::asm!("msr fpcr, {}", in(reg) control, options(nomem, nostack)) };
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
fn control() -> u64 {
    0
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
fn set_control(_control: u64) {}

/// Sets the locale `C`, which every program begins with and this one never leaves; whether it was another one.
#[cfg(unix)]
#[inline]
fn restore_locale() -> bool {
    // SAFETY: NULL asks; the text lives until the locale changes.
    let is_c = unsafe {
        let name = libc::setlocale(libc::LC_ALL, std::ptr::null());
        name.is_null() || CStr::from_ptr(name).to_bytes() == b"C"
    };
    if !is_c {
        // SAFETY: a constant name.
        unsafe { libc::setlocale(libc::LC_ALL, c"C".as_ptr()) };
    }
    !is_c
}

#[cfg(not(unix))]
fn restore_locale() -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_arch = "x86_64")]
    #[test]
    fn another_rounding_is_noticed_and_taken_back() {
        let before = Environment::now();
        assert_eq!(before.restore(), None);
        // Towards zero.
        set_control(before.control | 0x6000);
        assert_eq!(std::hint::black_box(1.0_f64) / 3.0 * 3.0, 1.0 - f64::EPSILON / 2.0);
        assert!(before.restore().is_some_and(|said| said.contains("rounded")));
        assert_eq!(std::hint::black_box(1.0_f64) / 3.0 * 3.0, 1.0);
    }
}
