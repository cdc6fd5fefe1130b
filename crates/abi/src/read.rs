//! Reading tables that were compiled with another minor version.

use crate::table::{BlockTable, MAGIC, Message, PluginTable, Quantity};

/// A struct of the table: `repr(C)`, begins with its size, grows at its end.
///
/// # Safety
///
/// The first field is `size: u32`; all bytes zero is a legal value of the type.
pub unsafe trait Table: Copy {
    /// Size in version 1.0 of the contract, in bytes: it stays when the struct grows. Smaller ones are broken.
    const FIRST_SIZE: usize;
}

// SAFETY: `size` is first; numbers, pointers and optional functions may be zero.
unsafe impl Table for PluginTable {
    const FIRST_SIZE: usize = size_of::<PluginTable>();
}
// SAFETY: as above.
unsafe impl Table for BlockTable {
    const FIRST_SIZE: usize = size_of::<BlockTable>();
}
// SAFETY: as above.
unsafe impl Table for Quantity {
    const FIRST_SIZE: usize = size_of::<Quantity>();
}
// SAFETY: as above.
unsafe impl Table for Message {
    const FIRST_SIZE: usize = size_of::<Message>();
}

/// A copy of the table at `at`: as many bytes as both sides know, zeros for fields that its author did not
/// know. `None`: NULL, or a size that no version has.
///
/// # Safety
///
/// `at` is NULL or points to a struct of a plug-in that keeps the contract (4 bytes, then `size` bytes).
pub unsafe fn read<T: Table>(at: *const T) -> Option<T> {
    if at.is_null() || !at.is_aligned() {
        return None;
    }
    // SAFETY: every table begins with its size.
    let size = unsafe { *at.cast::<u32>() } as usize;
    if size < T::FIRST_SIZE || !size.is_multiple_of(align_of::<T>()) {
        return None;
    }
    let mut copy = core::mem::MaybeUninit::<T>::zeroed();
    // SAFETY: `size` bytes may be read, `size_of::<T>()` written; zeros are legal values of the rest.
    unsafe {
        let bytes = size.min(size_of::<T>());
        core::ptr::copy_nonoverlapping(at.cast::<u8>(), copy.as_mut_ptr().cast::<u8>(), bytes);
        Some(copy.assume_init())
    }
}

/// Copies of the `count` elements of an array; the size of the first is the distance between them.
/// An element is `None` where [`read`] says so; of a broken first one, nothing else can be found.
///
/// # Safety
///
/// `first` is NULL or points to `count` structs of a plug-in that keeps the contract.
pub unsafe fn elements<T: Table>(first: *const T, count: u32) -> impl Iterator<Item = Option<T>> {
    // SAFETY: the caller vouches for `first`.
    let readable = count > 0 && unsafe { read(first) }.is_some();
    // SAFETY: `read` accepted it.
    let distance = if readable { unsafe { *first.cast::<u32>() as usize } } else { 0 };
    (0..count as usize).map(move |i| {
        if !readable {
            return None;
        }
        // SAFETY: the caller vouches for `count` elements.
        unsafe { read(first.byte_add(i * distance)) }
    })
}

/// Is this the table of a plug-in, in whatever version?
pub fn is_plugin(table: &PluginTable) -> bool {
    table.magic == MAGIC
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A struct in its first version, and after a field was added.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    struct Old {
        size: u32,
        a: u32,
    }
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    struct New {
        size: u32,
        a: u32,
        b: u32,
    }
    // SAFETY: `size` is first, zeros are legal.
    unsafe impl Table for Old {
        const FIRST_SIZE: usize = size_of::<Old>();
    }
    // SAFETY: as above.
    unsafe impl Table for New {
        const FIRST_SIZE: usize = size_of::<Old>();
    }

    #[test]
    fn fields_unknown_to_an_old_author_are_zero() {
        let old = [Old { size: 8, a: 1 }, Old { size: 8, a: 2 }];
        // SAFETY: an array of two.
        let mut read = unsafe { elements(old.as_ptr().cast::<New>(), 2) };
        assert_eq!(read.next().unwrap(), Some(New { size: 8, a: 1, b: 0 }));
        assert_eq!(read.next().unwrap(), Some(New { size: 8, a: 2, b: 0 }));
        assert!(read.next().is_none());
    }

    #[test]
    fn fields_unknown_to_an_old_host_are_skipped() {
        let new = [New { size: 12, a: 1, b: 7 }, New { size: 12, a: 2, b: 8 }];
        // SAFETY: an array of two.
        let mut read = unsafe { elements(new.as_ptr().cast::<Old>(), 2) };
        assert_eq!(read.next().unwrap(), Some(Old { size: 12, a: 1 }));
        assert_eq!(read.next().unwrap(), Some(Old { size: 12, a: 2 }));
    }

    #[test]
    fn null_and_impossible_sizes_are_refused() {
        // SAFETY: NULL or a struct.
        unsafe {
            assert_eq!(read::<Old>(core::ptr::null()), None);
            assert_eq!(read(&Old { size: 4, a: 0 }), None, "too small");
            assert_eq!(read(&Old { size: 9, a: 0 }), None, "not a distance between elements");
            assert!(elements::<Old>(core::ptr::null(), 2).all(|e| e.is_none()));
            assert_eq!(elements::<Old>(core::ptr::null(), 0).count(), 0);
        }
    }
}
