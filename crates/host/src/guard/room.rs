//! Buffers of one block with guards around them, for the calls of a run: what only depends on lengths is laid out once, and each
//! call copies and compares whole blocks of memory.

use blocksim_abi::{Message, OK, Status, message};

use super::{
    GUARD, Given, MESSAGE_BYTES, PATTERN, Places, TAIL_BYTE, TEXT_BYTES, UNWRITTEN, Wanted, broken,
    broken_rule, is_text_whole, lay_guard, take_one,
};
use crate::call::Failure;
use crate::environment::Environment;

/// Buffers of one block. Those that are given lie before the one that is wanted, each between guards.
pub struct Room {
    /// What functions see.
    words: Vec<u64>,
    /// What stands there before a call.
    image: Vec<u64>,
    text: [u8; TEXT_BYTES],
    /// Where the buffers begin that are given, and how many numbers each holds.
    given: [(usize, usize); 4],
    /// Where the buffer begins that is wanted, and the most numbers that it may hold.
    wanted: (usize, usize),
}

impl Room {
    /// Room for calls that are given buffers of these lengths, and want at most so many numbers.
    pub fn new(given: [usize; 4], most: usize) -> Self {
        let mut at = GUARD;
        let given = given.map(|length| {
            let place = (at, length);
            at += length + GUARD;
            place
        });
        let words = vec![PATTERN; at + most + GUARD];
        let mut text = [0; TEXT_BYTES];
        text[MESSAGE_BYTES..].fill(TAIL_BYTE);
        Self { image: words.clone(), words, text, given, wanted: (at, most) }
    }

    /// Calls a function of this process on copies, and gives its results if it has kept the rules. The lists are those of this room,
    /// `in_words` gives the same with names. Allocates only to report a failure.
    ///
    /// # Errors
    /// What the function reported, or which rule it broke.
    #[inline]
    pub fn call<'a>(
        &mut self,
        given: [&[f64]; 4],
        wanted: &mut Wanted,
        in_words: impl Fn() -> [Given<'a>; 4],
        function: impl FnOnce(&Places, *const Message) -> Status,
    ) -> Result<(), Failure> {
        for ((at, length), numbers) in self.given.into_iter().zip(given) {
            self.image[at..at + length].copy_from_slice(bits(numbers));
        }
        let (first, most) = self.wanted;
        let count = wanted.numbers.len();
        assert!(count <= most, "a function wants more numbers than there is room for");
        let (behind, end) = (first + count, first + count + GUARD);
        let own = &mut self.image[first..behind];
        if wanted.is_kept {
            own.copy_from_slice(bits(wanted.numbers))
        } else {
            own.fill(UNWRITTEN)
        }
        lay_guard(&mut self.image[behind..end]);
        self.words[..end].copy_from_slice(&self.image[..end]);
        self.text[0] = 0;

        let base = self.words.as_mut_ptr().cast::<f64>();
        let places = Places {
            given: self.given.map(|(at, _)| base.wrapping_add(at).cast_const()),
            wanted: [base.wrapping_add(first), std::ptr::null_mut()],
        };
        let message = Message::new(&mut self.text[..MESSAGE_BYTES]);
        let before = Environment::now();
        let status = function(&places, &message);
        if let Some(changed) = before.restore() {
            return Err(broken_rule(changed));
        }

        let is_whole =
            self.words[..first] == self.image[..first] && self.words[behind..end] == self.image[behind..end];
        if !(is_whole && is_text_whole(&self.text))
            && let Some(broken) =
                broken(&self.words[..end], &self.text, &in_words(), std::slice::from_ref(wanted))
        {
            self.text[MESSAGE_BYTES..].fill(TAIL_BYTE);
            return Err(broken_rule(&broken));
        }
        if status != OK {
            let text = message::written(&self.text[..MESSAGE_BYTES]).to_owned();
            return Err(Failure { status, text });
        }
        take_one(&self.words[first..behind], wanted)
    }
}

/// Numbers by their bits, which are copied and compared whatever they mean.
#[inline]
fn bits(numbers: &[f64]) -> &[u64] {
    const { assert!(size_of::<f64>() == size_of::<u64>() && align_of::<f64>() == align_of::<u64>()) }
    // SAFETY: both have the same size and alignment, and all bits are numbers of either kind.
    unsafe { std::slice::from_raw_parts(numbers.as_ptr().cast(), numbers.len()) }
}
