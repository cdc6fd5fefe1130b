//! Texts that cross the border: constant ones of the plug-in, and the message buffer of the host.

use core::ffi::c_char;

use crate::table::{Message, Text};

impl Text {
    /// No text.
    pub const EMPTY: Text = Text::new("");

    /// The text `text`, which lives as long as the process.
    pub const fn new(text: &'static str) -> Self {
        Text { data: text.as_ptr().cast::<c_char>(), length: text.len() }
    }

    /// The text, or `None` if it is no UTF-8, longer than memory, or a NULL with a length.
    ///
    /// # Safety
    ///
    /// `data` is NULL or points to `length` constant bytes that live as long as the process.
    pub unsafe fn as_str(&self) -> Option<&'static str> {
        if self.length == 0 {
            return Some("");
        }
        if self.data.is_null() || self.length > isize::MAX as usize {
            return None;
        }
        // SAFETY: not NULL, and the caller vouches for the rest.
        let bytes = unsafe { core::slice::from_raw_parts(self.data.cast::<u8>(), self.length) };
        core::str::from_utf8(bytes).ok()
    }
}

impl Message {
    /// A message that ends up in `buffer`; the first byte becomes NUL, that is no text.
    ///
    /// The result points into `buffer`, which must outlive its use.
    pub fn new(buffer: &mut [u8]) -> Self {
        if let Some(first) = buffer.first_mut() {
            *first = 0;
        }
        Message {
            size: size_of::<Message>() as u32,
            capacity: u32::try_from(buffer.len()).unwrap_or(u32::MAX),
            text: buffer.as_mut_ptr().cast::<c_char>(),
        }
    }

    /// Writes `text` with a NUL behind it; what does not fit is cut between two characters. A NUL inside
    /// ends the text. Without room it does nothing.
    ///
    /// # Safety
    ///
    /// `message` is NULL or points to a message whose `text` is NULL or has `capacity` writable bytes.
    pub unsafe fn write(message: *const Message, text: &str) {
        if message.is_null() {
            return;
        }
        // SAFETY: not NULL; the caller vouches for the struct. Version 1 has all fields read here.
        let Message { capacity, text: to, .. } = unsafe { *message };
        if to.is_null() || capacity == 0 {
            return;
        }
        let mut end = text.len().min(capacity as usize - 1);
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        // SAFETY: `end + 1 <= capacity` bytes are writable, and a `&str` of the plug-in is not the
        // buffer of the host.
        unsafe {
            core::ptr::copy_nonoverlapping(text.as_ptr(), to.cast::<u8>(), end);
            *to.add(end) = 0;
        }
    }
}

/// What a plug-in wrote into `buffer`: the text up to the NUL, or as much of it as is UTF-8.
pub fn written(buffer: &[u8]) -> &str {
    let end = buffer.iter().position(|&b| b == 0).unwrap_or(buffer.len());
    match core::str::from_utf8(&buffer[..end]) {
        Ok(text) => text,
        Err(e) => core::str::from_utf8(&buffer[..e.valid_up_to()]).unwrap_or(""),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(buffer: &mut [u8], text: &str) {
        let message = Message::new(buffer);
        // SAFETY: `message` describes `buffer`.
        unsafe { Message::write(&message, text) };
    }

    #[test]
    fn a_message_that_fits_arrives_whole() {
        let mut buffer = [0xff; 16];
        write(&mut buffer, "k > 0");
        assert_eq!(written(&buffer), "k > 0");
        assert_eq!(buffer[6], 0xff, "nothing is written behind the NUL");
    }

    #[test]
    fn a_long_message_is_cut_between_characters() {
        // "aµb" is 61 C2 B5 62
        for (capacity, expected) in [(1, ""), (2, "a"), (3, "a"), (4, "aµ"), (5, "aµb"), (6, "aµb")] {
            let mut buffer = [0xff; 8];
            write(&mut buffer[..capacity], "aµb");
            assert_eq!(written(&buffer), expected, "capacity {capacity}");
            assert!(buffer[capacity..].iter().all(|&b| b == 0xff), "capacity {capacity} was kept");
        }
    }

    #[test]
    fn without_a_buffer_nothing_is_written() {
        write(&mut [], "lost");
        // SAFETY: NULL is allowed for both pointers.
        unsafe {
            Message::write(core::ptr::null(), "lost");
            let nowhere = Message { size: 16, capacity: 9, text: core::ptr::null_mut() };
            Message::write(&nowhere, "lost");
        }
    }

    #[test]
    fn texts_that_lie_are_not_read() {
        // SAFETY: the pointers are NULL or constant.
        unsafe {
            assert_eq!(Text::new("rad/s").as_str(), Some("rad/s"));
            assert_eq!(Text { data: core::ptr::null(), length: 0 }.as_str(), Some(""));
            assert_eq!(Text { data: core::ptr::null(), length: 3 }.as_str(), None);
            assert_eq!(Text { data: c"\xff".as_ptr(), length: 1 }.as_str(), None);
        }
    }

    #[test]
    fn bytes_that_are_no_text_are_shown_as_far_as_they_are() {
        assert_eq!(written(b"ab\xff\0"), "ab");
        assert_eq!(written(b"no end"), "no end");
    }
}
