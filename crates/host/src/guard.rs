//! A call with private buffers: the numbers of the engine are copied in and out, so that a plug-in which writes where it must
//! not is found out by words around its buffers, and does no harm to anybody else as long as it stays near them.
//!
//! [`call`] lays out buffers of any lengths for one call; [`room`] has those of one block ready for all calls of a run.

pub mod room;

use std::cell::{Cell, RefCell};

use blocksim_abi::{Message, OK, Status, message};

use crate::call::Failure;
use crate::environment::Environment;
use crate::finite::element;
use crate::kind::Quantity;

/// Words before, between and behind the buffers.
const GUARD: usize = 16;
/// What stands there: a number that no calculation gives.
pub const PATTERN: u64 = 0x7ff4_5afe_b10c_0001;
/// What stands in a result before the call.
const UNWRITTEN: u64 = 0x7ff4_5afe_b10c_0002;
/// Longer messages of plug-ins are cut.
pub const MESSAGE_BYTES: usize = 1024;
/// Bytes behind the buffer of the message, and what stands there.
const TAIL: usize = 64;
const TAIL_BYTE: u8 = 0xa5;
/// Both.
pub const TEXT_BYTES: usize = MESSAGE_BYTES + TAIL;

/// Numbers that a function may read.
#[derive(Debug, Clone, Copy)]
pub struct Given<'a> {
    /// What one of them is, in messages: `input`.
    pub what: &'static str,
    /// Their names.
    pub list: &'a [Quantity],
    /// The numbers.
    pub numbers: &'a [f64],
}

/// Numbers that a function writes.
#[derive(Debug)]
pub struct Wanted<'a> {
    /// What one of them is, in messages: `output`.
    pub what: &'static str,
    /// Their names.
    pub list: &'a [Quantity],
    /// Where they go; untouched if the call fails.
    pub numbers: &'a mut [f64],
    /// Whether the function finds the present numbers there, and may leave them; else it has to write each of them.
    pub is_kept: bool,
}

/// Where the copies are. Unused places are NULL.
#[derive(Debug, Clone, Copy)]
pub struct Places {
    /// Of what is given.
    pub given: [*const f64; 4],
    /// Of what is wanted.
    pub wanted: [*mut f64; 2],
}

/// What a function sees: buffers with guards around them, and room for a message.
#[derive(Debug)]
pub struct Frame<'a> {
    /// All buffers and guards, one after the other.
    pub words: &'a mut [u64],
    /// The message, and the guard behind it.
    pub text: &'a mut [u8; TEXT_BYTES],
    /// Where in `words` each buffer that is given begins.
    pub given: [Option<usize>; 4],
    /// Where each buffer that is wanted begins.
    pub wanted: [Option<usize>; 2],
}

impl Frame<'_> {
    /// Addresses of the buffers, for functions of this process; `words` must not be used in any other way meanwhile.
    fn places(&mut self) -> Places {
        let base = self.words.as_mut_ptr();
        let place =
            |at: Option<usize>| at.map_or(std::ptr::null_mut(), |at| base.wrapping_add(at).cast::<f64>());
        Places { given: self.given.map(|at| place(at).cast_const()), wanted: self.wanted.map(place) }
    }
}

struct Buffers {
    words: Vec<u64>,
    text: [u8; TEXT_BYTES],
}

thread_local! {
    static BUFFERS: RefCell<Buffers> =
        const { RefCell::new(Buffers { words: Vec::new(), text: [0; TEXT_BYTES] }) };
}

/// Buffers of earlier calls, where each call is to have others.
const RETIRED: usize = 16;
thread_local! {
    static IS_MOVING: Cell<bool> = const { Cell::new(false) };
    static RETIRED_BUFFERS: RefCell<Vec<Vec<u64>>> = const { RefCell::new(Vec::new()) };
}

/// From now on each call of this thread has buffers at other places, and those of earlier ones hold no numbers: whoever has kept
/// a pointer is found.
pub fn move_buffers() {
    IS_MOVING.set(true);
    RETIRED_BUFFERS.take();
}

/// Whether each call of this thread has buffers at other places.
#[cfg(feature = "wasm")]
pub fn is_moving() -> bool {
    IS_MOVING.get()
}

/// Puts the buffers of the last call aside.
#[cold]
fn retire(words: &mut Vec<u64>) {
    RETIRED_BUFFERS.with_borrow_mut(|retired| {
        let mut old = std::mem::take(words);
        old.fill(PATTERN);
        retired.push(old);
        if retired.len() > RETIRED {
            retired.remove(0);
        }
    });
}

/// Whether a buffer of an earlier call was written.
#[cold]
fn is_old_written() -> bool {
    RETIRED_BUFFERS.with_borrow(|retired| retired.iter().any(|old| old.iter().any(|&word| word != PATTERN)))
}

/// Words that a call with so many buffers and numbers needs.
fn needed(buffers: usize, numbers: usize) -> usize {
    numbers + GUARD * (buffers + 1)
}

/// The most words that a call with so many numbers in all needs.
pub fn most_words(numbers: usize) -> usize {
    needed(6, numbers)
}

/// Makes room on this thread for calls with so many numbers in all, so that these allocate nothing.
pub fn reserve(numbers: usize) {
    BUFFERS.with_borrow_mut(|buffers| {
        let needed = most_words(numbers);
        if buffers.words.len() < needed {
            buffers.words.resize(needed, 0);
        }
    });
}

/// Calls a function of this process on copies, and gives its results if it has kept the rules. Allocates only to report a failure,
/// or where [`reserve`] has not made room.
///
/// # Errors
/// What the function reported, or which rule it broke.
pub fn call(
    given: &[Given],
    wanted: &mut [Wanted],
    function: impl FnOnce(&Places, *const Message) -> Status,
) -> Result<(), Failure> {
    framed(given, wanted, |frame| {
        let message = Message::new(&mut frame.text[..MESSAGE_BYTES]);
        let places = frame.places();
        let before = Environment::now();
        let status = function(&places, &message);
        match before.restore() {
            Some(changed) => Err(broken_rule(changed)),
            None => Ok(status),
        }
    })
}

/// The same for a function that is elsewhere: it gets all of the frame, and leaves in it what the function wrote. A function that
/// did not return gives the reason.
///
/// # Errors
/// What the function reported, that reason, or which rule it broke.
pub fn framed(
    given: &[Given],
    wanted: &mut [Wanted],
    function: impl FnOnce(&mut Frame) -> Result<Status, Failure>,
) -> Result<(), Failure> {
    BUFFERS.with_borrow_mut(|Buffers { words, text }| {
        let numbers = given.iter().map(|given| given.numbers.len());
        let numbers =
            numbers.sum::<usize>() + wanted.iter().map(|wanted| wanted.numbers.len()).sum::<usize>();
        let needed = needed(given.len() + wanted.len(), numbers);
        let is_moving = IS_MOVING.get();
        if is_moving {
            retire(words);
        }
        if words.len() < needed {
            words.resize(needed, 0);
        }
        let words = &mut words[..needed];
        text[0] = 0;
        text[MESSAGE_BYTES..].copy_from_slice(&[TAIL_BYTE; TAIL]);
        let (places_given, places_wanted) = lay_out(words, given, wanted);
        let mut frame = Frame { words, text, given: places_given, wanted: places_wanted };
        let status = function(&mut frame)?;
        let is_whole = is_whole(words, given, wanted) && is_text_whole(text);
        let broken = if is_whole { None } else { broken(words, text, given, wanted) }.or_else(|| {
            (is_moving && is_old_written()).then(|| "it wrote to a buffer of an earlier call".to_owned())
        });
        if let Some(broken) = broken {
            return Err(broken_rule(&broken));
        }
        if status != OK {
            return Err(Failure { status, text: message::written(&text[..MESSAGE_BYTES]).to_owned() });
        }
        take(words, given, wanted)
    })
}

/// A plug-in that did what it must not.
pub fn broken_rule(deed: &str) -> Failure {
    Failure { status: OK, text: format!("the plug-in broke a rule: {deed}") }
}

/// Fills guards and buffers; gives where the buffers begin.
fn lay_out(
    words: &mut [u64],
    given: &[Given],
    wanted: &[Wanted],
) -> ([Option<usize>; 4], [Option<usize>; 2]) {
    let mut places = ([None; 4], [None; 2]);
    let (mut at, mut rest) = (GUARD, lay_guard(words));
    for (place, given) in places.0.iter_mut().zip(given) {
        let (own, behind) = rest.split_at_mut(given.numbers.len());
        own.iter_mut().zip(given.numbers).for_each(|(word, number)| *word = number.to_bits());
        *place = Some(at);
        at += own.len() + GUARD;
        rest = lay_guard(behind);
    }
    for (place, wanted) in places.1.iter_mut().zip(wanted) {
        let (own, behind) = rest.split_at_mut(wanted.numbers.len());
        if wanted.is_kept {
            own.iter_mut().zip(&*wanted.numbers).for_each(|(word, number)| *word = number.to_bits());
        } else {
            own.fill(UNWRITTEN);
        }
        *place = Some(at);
        at += own.len() + GUARD;
        rest = lay_guard(behind);
    }
    places
}

/// Fills the guard that these words begin with; gives those behind it. Its length is a constant, which makes it eight stores.
#[inline(always)]
fn lay_guard(words: &mut [u64]) -> &mut [u64] {
    let (guard, rest) = words.split_at_mut(GUARD);
    guard.copy_from_slice(&[PATTERN; GUARD]);
    rest
}

/// Bits that differ from a guard.
#[derive(Clone, Copy)]
struct Odd([u64; GUARD]);

impl Odd {
    /// Takes the guard that these words begin with; gives those behind it. All words are looked at without a branch, several at once.
    #[inline(always)]
    fn guard<'a>(&mut self, words: &'a [u64]) -> &'a [u64] {
        let (guard, rest) = words.split_at(GUARD);
        self.0.iter_mut().zip(guard).for_each(|(odd, word)| *odd |= word ^ PATTERN);
        rest
    }
}

/// Whether all guards are whole, and so is what is given.
#[inline]
fn is_whole(words: &[u64], given: &[Given], wanted: &[Wanted]) -> bool {
    let (mut odd, mut changed) = (Odd([0; GUARD]), 0);
    let mut rest = odd.guard(words);
    for Given { numbers, .. } in given {
        let (copies, behind) = rest.split_at(numbers.len());
        changed |= copies.iter().zip(*numbers).fold(0, |all, (word, number)| all | (word ^ number.to_bits()));
        rest = odd.guard(behind);
    }
    for wanted in wanted {
        rest = odd.guard(&rest[wanted.numbers.len()..]);
    }
    odd.0.iter().fold(changed, |all, word| all | word) == 0
}

/// Whether nothing was written behind the message.
#[inline]
fn is_text_whole(text: &[u8; TEXT_BYTES]) -> bool {
    text[MESSAGE_BYTES..] == [TAIL_BYTE; TAIL]
}

/// What was written that must not be, where something was.
#[cold]
fn broken(words: &[u64], text: &[u8; TEXT_BYTES], given: &[Given], wanted: &[Wanted]) -> Option<String> {
    let of_given = given.iter().map(|given| (given.what, given.numbers.len()));
    let of_wanted = wanted.iter().map(|wanted| (wanted.what, wanted.numbers.len()));
    let mut last = None;
    let mut at = 0;
    let mut buffers = of_given.chain(of_wanted).peekable();
    loop {
        let guard = &words[at..at + GUARD];
        let next = buffers.next();
        if guard.iter().any(|word| *word != PATTERN) {
            let behind = last.filter(|_| guard[0] != PATTERN || guard[GUARD - 1] == PATTERN);
            return Some(match (behind, next, last) {
                (Some((what, n)), _, _) | (None, None, Some((what, n))) => {
                    format!("it wrote behind the end of its {what}s, which hold {}", count(n))
                }
                (None, Some((what, n)), _) => {
                    format!("it wrote before the beginning of its {what}s, which hold {}", count(n))
                }
                (None, None, None) => "it wrote where it has no buffer".to_owned(),
            });
        }
        let Some((what, n)) = next else { break };
        last = Some((what, n));
        at += GUARD + n;
    }
    let mut at = GUARD;
    for Given { what, list, numbers } in given {
        let copies = &words[at..at + numbers.len()];
        let mut pairs = copies.iter().zip(*numbers);
        if let Some(changed) = pairs.position(|(word, number)| *word != number.to_bits()) {
            return Some(format!("it changed its {what} {}, which it may only read", named(list, changed)));
        }
        at += numbers.len() + GUARD;
    }
    (!is_text_whole(text)).then(|| format!("it wrote behind the {MESSAGE_BYTES} bytes of its message"))
}

/// Copies the results to the engine.
fn take(words: &[u64], given: &[Given], wanted: &mut [Wanted]) -> Result<(), Failure> {
    let mut at = GUARD + given.iter().map(|given| given.numbers.len() + GUARD).sum::<usize>();
    for wanted in wanted {
        take_one(&words[at..at + wanted.numbers.len()], wanted)?;
        at += wanted.numbers.len() + GUARD;
    }
    Ok(())
}

/// Copies the results of one buffer, if all of them have been written.
#[inline]
fn take_one(results: &[u64], wanted: &mut Wanted) -> Result<(), Failure> {
    let is_missing = || results.iter().fold(false, |found, word| found | (*word == UNWRITTEN));
    if !wanted.is_kept
        && is_missing()
        && let Some(missing) = results.iter().position(|&word| word == UNWRITTEN)
    {
        let (what, name) = (wanted.what, named(wanted.list, missing));
        return Err(broken_rule(&format!("it did not write its {what} {name}")));
    }
    wanted.numbers.iter_mut().zip(results).for_each(|(number, word)| *number = f64::from_bits(*word));
    Ok(())
}

fn count(n: usize) -> String {
    if n == 1 { "1 number".to_owned() } else { format!("{n} numbers") }
}

/// The name of a number of a list, in backticks.
fn named(list: &[Quantity], number: usize) -> String {
    let mut before = 0;
    for quantity in list {
        if number < before + quantity.length {
            return format!("`{}`", element(quantity, number - before));
        }
        before += quantity.length;
    }
    format!("number {number}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quantity(name: &'static str, length: usize) -> Quantity {
        Quantity { name, unit: "1", dimension: None, length, doc: "", default: None, reads: Vec::new() }
    }

    /// What a call says whose function does this with two inputs (one a vector) and two outputs: the same in buffers of the thread and
    /// in those of a block, which is called once more by a function that keeps the rules.
    fn outcome(function: impl Fn(*mut f64, *mut f64, *const Message) -> Status) -> (String, [f64; 2]) {
        let (u, y) = ([quantity("a", 1), quantity("v", 2)], [quantity("p", 1), quantity("q", 1)]);
        let none: &[f64] = &[];
        let numbers = [none, none, none, &[1.0, 2.0, 3.0]];
        let given = [("parameter", 0), ("continuous state", 1), ("discrete state", 2), ("input", 3)]
            .map(|(what, i)| Given { what, list: if i == 3 { &u[..] } else { &[] }, numbers: numbers[i] });
        let perform =
            |places: &Places, message| function(places.given[3].cast_mut(), places.wanted[0], message);
        let said = |answer: Result<(), Failure>| {
            answer.map_or_else(|failure| failure.to_string(), |()| "fine".to_owned())
        };

        let mut results = [7.0; 2];
        let mut wanted = Wanted { what: "output", list: &y, numbers: &mut results, is_kept: false };
        let in_thread = said(call(&given, std::slice::from_mut(&mut wanted), perform));
        let mut room = room::Room::new([0, 0, 0, 3], 4);
        let mut in_room = [7.0; 2];
        let mut wanted = Wanted { what: "output", list: &y, numbers: &mut in_room, is_kept: false };
        assert_eq!(said(room.call(numbers, &mut wanted, || given, perform)), in_thread);
        assert_eq!(in_room, results);

        // The next call finds whole guards, and whatever the length of its results, a guard behind them.
        let mut three = [1.0, f64::NAN, 3.0];
        let mut wanted = Wanted { what: "state", list: &y, numbers: &mut three, is_kept: true };
        assert_eq!(room.call(numbers, &mut wanted, || given, |_, _| OK), Ok(()));
        assert!(three[0] == 1.0 && three[1].is_nan() && three[2] == 3.0);
        (in_thread, results)
    }

    #[test]
    fn every_word_that_is_changed_is_seen_and_has_its_sentence() {
        let list = [quantity("a", 3)];
        let numbers = [1.0, -2.0, f64::NAN];
        let given = [(0, "parameter"), (3, "input")].map(|(n, what)| Given {
            what,
            list: &list,
            numbers: &numbers[..n],
        });
        let (mut kept, mut new) = ([4.0, 5.0], [0.0]);
        let wanted = [
            Wanted { what: "state", list: &list, numbers: &mut kept, is_kept: true },
            Wanted { what: "output", list: &list, numbers: &mut new, is_kept: false },
        ];
        let (mut words, mut text) = (vec![0; needed(4, 6)], [0; TEXT_BYTES]);
        text[MESSAGE_BYTES..].fill(TAIL_BYTE);
        let places = lay_out(&mut words, &given, &wanted);
        assert_eq!(places.0[..2], [Some(16), Some(32)]);
        assert_eq!(places.1, [Some(51), Some(69)]);
        assert!(is_whole(&words, &given, &wanted) && broken(&words, &text, &given, &wanted).is_none());
        for at in 0..words.len() {
            let before = std::mem::replace(&mut words[at], 0x55);
            let is_wanted = (51..53).contains(&at) || at == 69;
            assert_eq!(is_whole(&words, &given, &wanted), is_wanted, "word {at}");
            assert_eq!(broken(&words, &text, &given, &wanted).is_none(), is_wanted, "word {at}");
            words[at] = before;
        }
    }

    #[test]
    fn results_of_a_good_call_arrive_and_each_broken_rule_is_named() {
        type Function = fn(*mut f64, *mut f64, *const Message) -> Status;
        let both: Function = |u, y, _| {
            // SAFETY: three inputs, two outputs.
            unsafe { (*y, *y.add(1)) = (*u + *u.add(2), 5.0) };
            OK
        };
        assert_eq!(outcome(both), ("fine".to_owned(), [4.0, 5.0]));
        // SAFETY: all places lie in the buffers of this thread or in the guards around them.
        let cases: [(Function, &str); 8] = unsafe {
            [
                (
                    |_, y, _| {
                        *y = 1.0;
                        OK
                    },
                    "it did not write its output `q`",
                ),
                (
                    |_, y, _| {
                        *y.add(2) = 1.0;
                        OK
                    },
                    "it wrote behind the end of its outputs, which hold 2 numbers",
                ),
                (
                    |_, y, _| {
                        *y.sub(1) = 1.0;
                        OK
                    },
                    "it wrote before the beginning of its outputs, which hold 2 numbers",
                ),
                (
                    |u, _, _| {
                        *u.add(2) = 9.0;
                        OK
                    },
                    "it changed its input `v[1]`, which it may only read",
                ),
                (
                    |u, _, _| {
                        *u.add(3) = 0.0;
                        OK
                    },
                    "it wrote behind the end of its inputs, which hold 3 numbers",
                ),
                (
                    |u, _, _| {
                        *u.sub(16) = 0.0;
                        OK
                    },
                    "it wrote behind the end of its discrete states, which hold 0 numbers",
                ),
                (
                    |_, y, _| {
                        *y.add(17) = 0.0;
                        OK
                    },
                    "it wrote behind the end of its outputs, which hold 2 numbers",
                ),
                (
                    |_, _, m| {
                        *(*m).text.add(1030) = 1;
                        OK
                    },
                    "it wrote behind the 1024 bytes of its message",
                ),
            ]
        };
        for (function, expected) in cases {
            let (text, results) = outcome(function);
            assert_eq!(text, format!("the plug-in broke a rule: {expected}"));
            assert_eq!(results, [7.0; 2], "nothing of it is used");
        }
        assert_eq!(outcome(both).0, "fine", "the next call begins with whole guards");
    }
}
