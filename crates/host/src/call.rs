//! A call that did not succeed, in words, and numbers of a thread for in between.

use std::cell::RefCell;
use std::fmt;

use blocksim_abi::{ERROR, OK, PANICKED, Status};

thread_local!(static NUMBERS: RefCell<Vec<f64>> = const { RefCell::new(Vec::new()) });

/// A call that did not report success.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    /// What the function reported; `OK` if it was not called.
    pub status: Status,
    /// What it wrote.
    pub text: String,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let text = self.text.trim();
        match self.status {
            OK => f.write_str(text),
            ERROR if text.is_empty() => f.write_str("the plug-in failed and gave no reason"),
            ERROR => f.write_str(text),
            PANICKED if text.is_empty() => f.write_str("the plug-in panicked"),
            PANICKED => write!(f, "the plug-in panicked: {text}"),
            status if text.is_empty() => write!(f, "the plug-in reported the unknown status {status}"),
            status => write!(f, "the plug-in reported the unknown status {status}: {text}"),
        }
    }
}

/// A buffer of this thread with `length` numbers of arbitrary value; it allocates when it must grow.
pub fn with_numbers<R>(length: usize, body: impl FnOnce(&mut [f64]) -> R) -> R {
    NUMBERS.with_borrow_mut(|numbers| {
        if numbers.len() < length {
            numbers.resize(length, 0.0);
        }
        body(&mut numbers[..length])
    })
}

#[cfg(test)]
mod tests {
    use blocksim_abi::Message;

    use super::*;
    use crate::guard;

    fn report(status: Status, text: &str) -> String {
        guard::call(&[], &mut [], |_, m| {
            // SAFETY: the message of `call`.
            unsafe { Message::write(m, text) };
            status
        })
        .unwrap_err()
        .to_string()
    }

    #[test]
    fn every_status_but_ok_is_a_sentence() {
        assert_eq!(report(ERROR, "too hot"), "too hot");
        assert_eq!(report(ERROR, ""), "the plug-in failed and gave no reason");
        assert_eq!(report(PANICKED, "index 3"), "the plug-in panicked: index 3");
        assert_eq!(report(-7, ""), "the plug-in reported the unknown status -7");
        assert_eq!(guard::call(&[], &mut [], |_, _| OK), Ok(()));
    }

    #[test]
    fn a_message_does_not_outlive_its_call() {
        report(ERROR, "first");
        assert_eq!(report(ERROR, ""), "the plug-in failed and gave no reason");
    }

    #[test]
    fn the_buffer_of_numbers_keeps_its_size() {
        with_numbers(5, |numbers| numbers.fill(1.0));
        with_numbers(2, |numbers| assert_eq!(numbers.len(), 2));
        with_numbers(5, |numbers| assert_eq!(numbers, [1.0; 5]));
    }
}
