//! Panics in WebAssembly, where nothing is unwound: the text is written before the module stops.

use std::panic::set_hook;
use std::ptr;
use std::sync::Once;
use std::sync::atomic::{AtomicPtr, Ordering};

use crate::abi::Message;
use crate::border::panic_text;

/// The message of the call that is going on; a module has one thread.
static MESSAGE: AtomicPtr<Message> = AtomicPtr::new(ptr::null_mut());

/// From now on a panic writes its text into this message, which is NULL or valid until the function of the plug-in returns. The host
/// reads it when the module has stopped.
pub fn tell(message: *const Message) {
    static SET: Once = Once::new();
    MESSAGE.store(message.cast_mut(), Ordering::Relaxed);
    SET.call_once(|| {
        set_hook(Box::new(|info| {
            // SAFETY: NULL, or the message of the call that panics, as each call begins with `tell`.
            unsafe { Message::write(MESSAGE.load(Ordering::Relaxed), panic_text(info.payload())) };
        }));
    });
}
